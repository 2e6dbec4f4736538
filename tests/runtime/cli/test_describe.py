"""`ltcgear scenes`, `effects`, `info`, `check` and `generate`: what they print, write and refuse."""

from pathlib import Path

import pytest
from ltcgear.symbolic.scene.load import shipped_scenes


def test_scenes(data, run):
    listed = data("scenes")["scenes"]
    assert [item["name"] for item in listed] == shipped_scenes()
    assert all(item["title"] for item in listed)
    assert run("scenes")[1].count("rig-2mw ") == 1


def test_effects(data, run):
    listed = {item["name"]: item for item in data("effects")["effects"]}
    assert listed["mesh_law"]["default"] == listed["mesh_law"]["values"][0] == "involute"
    assert all(item["help"] and item["source"] for item in listed.values())
    assert listed["gravity"]["needs"]["on"].startswith("a member that can move sideways")
    assert all({"without", "excludes"} <= set(item) for item in listed.values())
    text = " ".join(run("effects")[1].split())
    assert "bearing_friction" in text
    assert "on: needs" in text


def test_info(data, run):
    shown = data("info", "rig-2mw")
    assert {"scene", "dof", "states", "parameters", "effects", "ops", "jacobian_nnz"} <= set(shown)
    assert set(shown["ops"]) == {"rhs", "jacobian"}
    assert shown["dof"] == 41
    assert shown["static_mesh_forces_n"]["lsp.sun_planet"] == pytest.approx(3.575e5, rel=5e-3)
    assert shown["speed_ratios"]["generator"] == pytest.approx(119.668, abs=1e-3)
    assert "sources" not in shown
    assert "degrees of freedom" in run("info", "rig-2mw")[1]


def test_info_tells_geometry_motion_and_loads(data, run):
    shown = data("info", "rig-2mw")
    stage, member, load = shown["stages"]["hsp"], shown["members"]["hsp.planet"], shown["loads"]
    assert stage["center_distance_mm"] == pytest.approx(408)
    assert stage["base_radii_mm"]["sun"] == pytest.approx(17 * 6 * 0.9396926, rel=1e-6)
    assert stage["mesh_frequency_hz"] == pytest.approx(158.227, abs=1e-3)
    assert stage["meshes"]["sun_planet"]["pressure_angle_deg"] == pytest.approx(22.2, abs=0.01)
    assert stage["meshes"]["ring_planet"]["pressure_angle_deg"] == pytest.approx(20.0)
    assert stage["meshes"]["ring_planet"]["stiffness_double_n_per_m"] is None
    mesh = stage["meshes"]["sun_planet"]
    assert mesh["stiffness_double_n_per_m"] == pytest.approx(1.4 * mesh["stiffness_single_n_per_m"])
    assert 1.5 < mesh["contact_ratio"] < 1.6
    assert not mesh["contact_ratio_given"]
    assert shown["stages"]["lsp"]["planet_tip_clearance_mm"] == pytest.approx(560 * 2**0.5 - 800)
    assert shown["stages"]["psh"]["planet_tip_clearance_mm"] is None
    assert member["count"] == 3
    assert member["mass_kg"] == pytest.approx(7850 * 3.14159265 * (0.3**2 - 0.15**2) * 0.25)
    assert shown["members"]["generator"]["speed_rpm"] == pytest.approx(15 * 119.668, rel=1e-5)
    assert (load["motor"]["action"], load["generator"]["action"]) == ("drives", "brakes")
    assert load["motor"]["power_kw"] == pytest.approx(-load["generator"]["power_kw"]) == pytest.approx(1992.5, abs=0.1)
    assert load["motor"]["torque_n_m"] == pytest.approx(1.06e4 * 119.668, rel=1e-5)
    out = run("info", "rig-2mw")[1]
    assert max(len(line) for line in out.splitlines()) <= 80
    assert all(word in out for word in ("tip clearance of planets", "drives", "brakes", "158.227 Hz"))


def test_info_tells_what_effects_do_and_why_there_are_freedoms(data, run):
    shown = data("info", "rig-2mw", "--set", "effects.gravity=on")
    acting = {item["effect"]: item["here"] for item in shown["acting"]}
    assert {"mesh_stiffness", "mesh_damping", "damping", "gravity"} <= set(acting)
    assert not {"mesh_law", "mesh_friction", "bearing_friction"} & set(acting)
    assert acting["gravity"].startswith("gravity: 13 more")
    freedoms = {row["body"]: row for row in shown["freedoms"]}
    assert freedoms["lsp.planet.1-4"]["axes"] == ["x", "y", "u"]
    assert "its pin is flexible" in freedoms["lsp.planet.1-4"]["reason"]
    assert "support = floating" in freedoms["lsp.sun"]["reason"]
    assert "shaft flange is flexible" in freedoms["generator"]["reason"]
    assert "motor" not in freedoms
    counts = {"lsp.planet.1-4": 4, "hsp.planet.1-3": 3, "reference": 0}
    assert sum(len(row["axes"]) * counts.get(body, 1) for body, row in freedoms.items()) == shown["dof"]
    out = run("info", "rig-2mw")[1]
    assert "Effects that act" in out
    assert "Freedoms" in out


def test_info_of_a_scene_at_rest(data):
    shown = data("info", "lin-parker-3")
    stage = shown["stages"]["gear"]
    assert (stage["mesh_frequency_hz"], stage["planet_tip_clearance_mm"]) == (None, None)
    assert stage["meshes"]["sun_planet"]["contact_ratio"] is None
    assert (shown["loads"], shown["members"]["gear.sun"]["speed_rpm"]) == ({}, 0)


@pytest.mark.parametrize("scene", shipped_scenes())
def test_shipped_scenes_are_without_warnings(run, scene):
    assert run("info", scene)[2] == ""


def test_a_mesh_without_load_is_warned_about(run):
    _, _, err = run("info", "psh", "--set", "loads.output.torque=0 N*m")
    assert "warning: psh: stages.psh.mesh: no load reaches this mesh" in err


def test_info_with_sources(data, run):
    sources = data("info", "lsp", "--sources")["sources"]
    assert sources["stages.lsp.module"] == "printed: Table 2"
    assert all(text.startswith(("printed:", "derived:", "assumed:")) for text in sources.values())
    assert "Where the numbers come from" in run("info", "lsp", "--sources")[1]
    assert "\u2026" not in run("info", "lin-parker-3", "--sources")[1]


def test_info_without_sources_says_so(run, tmp_path):
    path = tmp_path / "bare.toml"
    path.write_text('title = "x"\n[rotors.a]\ninertia = "1 kg*m^2"\n', encoding="utf-8")
    out = run("info", path, "--sources")[1]
    assert "no sources given" in out
    assert "Where the numbers" not in out


def test_info_of_a_file(data, tmp_path):
    from ltcgear.symbolic.scene.load import SHIPPED

    path = tmp_path / "mine [1].toml"
    path.write_text((SHIPPED / "psh.toml").read_text("utf-8"), encoding="utf-8")
    assert data("info", path)["scene"] == "mine [1]"


def test_check(data, run):
    shown = data("check", "psh")
    assert shown["passed"] is True
    assert all({"name", "passed", "value", "tolerance", "note"} <= set(check) for check in shown["checks"])
    assert run("check", "psh")[0] == 0


def test_check_paper(data):
    rows = data("check", "--paper")["equations"]
    assert {row["verdict"] for row in rows} <= {"agrees", "first-order", "misprint"}
    assert all({"equation", "row", "why", "printed", "derived"} <= set(row) for row in rows)
    assert {31, 38} <= {row["equation"] for row in rows}


def test_generate(data, tmp_path):
    target = tmp_path / "new" / "folder"
    shown = data("generate", "psh", "-o", target)
    assert {"files", "ops", "seconds", "key"} <= set(shown)
    assert {"derive", "check", "emit", "compile"} <= set(shown["seconds"])
    expected = ["SHA256SUMS", "data.c", "ltcgear.c", "ltcgear.h", "main.c", "manifest.json", "model.c"]
    assert sorted(path.name for path in target.iterdir()) == expected
    assert all(Path(file).is_file() for file in shown["files"])
    assert (target / "model.c").read_text("utf-8").count("{") > 10
    assert all(Path(file).is_file() for file in data("generate", "psh")["files"])


def test_a_failed_check_is_exit_code_1(data, monkeypatch):
    from ltcgear.symbolic.checks import all_checks as checks
    from ltcgear.symbolic.checks.check import judged

    monkeypatch.setattr(checks, "check_model", lambda model: [judged("broken on purpose", 1.0, 1e-9, "test")])
    shown = data("check", "psh", code=1)
    assert shown["passed"] is False
    assert shown["checks"][0]["name"] == "broken on purpose"


def test_a_target_for_c_that_is_a_file_is_refused(refused, tmp_path):
    (tmp_path / "file").write_text("kept", encoding="utf-8")
    assert "is a file; give a folder" in refused("generate", "psh", "-o", tmp_path / "file")
    assert "is a file; give a folder" in refused("generate", "psh", "-o", tmp_path / "file" / "below")
    assert (tmp_path / "file").read_text("utf-8") == "kept"
