"""The command line: exit codes, JSON and nothing else on stdout, one message and no traceback on stderr."""

import json
import os
import signal
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path
from time import sleep

import pytest
from ltcgear.generated import store as generated_store
from ltcgear.generated import writing
from ltcgear.runtime.cli import commands
from ltcgear.runtime.model import building, cstruct
from ltcgear.runtime.simulation import integration
from ltcgear.runtime.view.tables import printed
from ltcgear.symbolic.scene.load import shipped_scenes

SHORT = ("--t-end", "0.01")


# --- exit code 0


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


def test_cost(data, run, tmp_path):
    shown = data("cost", "psh", "--t-end", "0.02", "--set", "effects.gravity=on", "-o", tmp_path / "cost.png")
    rows = {row["effect"]: row for row in shown["variants"]}
    assert {"mesh_stiffness", "mesh_damping", "damping", "gravity"} < set(rows)
    assert shown["variants"][0]["effect"] == "all"
    expected = {"value", "without", "states", "ops", "ns_call", "seconds_per_simulated_second", "counts", "changes"}
    assert all(expected <= set(row) and row["reason"] == "" for row in rows.values())
    assert set(rows["all"]["changes"]) == {"force_rms", "force_peak", "load_share", "spectrum"}
    assert rows["gravity"]["ops"]["rhs"] < rows["all"]["ops"]["rhs"]
    assert rows["mesh_stiffness"]["counts"]["events"] == 0 < rows["all"]["counts"]["events"]
    assert abs(rows["gravity"]["changes"]["force_rms"]) < 0.1 < abs(rows["mesh_stiffness"]["changes"]["force_rms"])
    assert (tmp_path / "cost.png").stat().st_size > 10_000
    out = run("cost", "psh", "--t-end", "0.02")[1]
    assert "two-level > mean" in out
    assert max(len(line) for line in out.splitlines()) <= 80


def test_cost_tells_what_cannot_be_run(data, monkeypatch):
    from ltcgear.symbolic.scene import load

    whole = load.load_scene

    def refusing(name, changes=None):
        if "effects.damping" in (changes or {}):
            raise load.SceneError("psh: 1 defect\n  effects.damping: contradicts")
        return whole(name, changes)

    monkeypatch.setattr(load, "load_scene", refusing)
    rows = {row["effect"]: row for row in data("cost", "psh", "--t-end", "0.005")["variants"]}
    assert "contradicts" in rows["damping"]["reason"]
    assert rows["damping"]["states"] is None
    assert rows["mesh_damping"]["reason"] == ""


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


@contextmanager
def piped(text):
    """Give the path of a pipe that holds a text, as ``<(...)`` does."""
    read, write = os.pipe()
    os.write(write, text.encode())
    os.close(write)
    try:
        yield f"/dev/fd/{read}"
    finally:
        os.close(read)


def test_a_scene_from_a_pipe_is_kept_and_varied(data, tmp_path):
    """Results keep its text, and variants are made of it, though a pipe can be read once only."""
    import xarray as xr
    from ltcgear.symbolic.scene.load import SHIPPED

    text = (SHIPPED / "psh.toml").read_text("utf-8")
    with piped(text) as path:
        assert data("info", path)["title"] == data("info", "psh")["title"]
    with piped(text) as path:
        data("simulate", path, "--t-end", "0.01", "-o", tmp_path / "a.nc")
    assert xr.open_dataset(tmp_path / "a.nc").attrs["scene_text"] == text
    with piped(text) as path:
        variants = data("cost", path, "--t-end", "0.005")["variants"]
    assert len(variants) > 3
    assert not any(row["reason"] for row in variants)


@pytest.mark.parametrize("command", ["info", "simulate", "check", "cost", "modes", "sweep"])
def test_a_path_that_cannot_be_one_is_exit_code_2(refused, command, tmp_path):
    more = ["--vary", "x=1,2", "-o", tmp_path / "a.nc"] if command == "sweep" else []
    if command == "simulate":
        (tmp_path / "a.nc").touch()
        more = ["-o", tmp_path / "a.nc"]
    assert "File name too long" in refused(command, tmp_path / ("x" * 300), *more)
    assert "File name too long" in refused(command, "x/" * 5000, *more)
    assert "is a device" in refused(command, "/dev/zero", *more)


@pytest.mark.parametrize("name", [b"gear\xff\x1b[31m.toml", b"x" * 245 + b".toml"], ids=["not UTF-8", "long"])
def test_odd_names_of_files_work_and_are_not_obeyed(run, name, tmp_path):
    from ltcgear.symbolic.scene.load import SHIPPED

    path = Path(os.fsdecode(os.fsencode(tmp_path) + b"/" + name))
    path.write_text(
        (SHIPPED / "psh.toml").read_text("utf-8") + "\n[effects]\ngravity = 'on'\nmesh_friction = 'sliding'\n"
    )
    for arguments in (["info", path], ["simulate", path, "--t-end", "0.005", "-o", tmp_path / "a.nc"]):
        code, out, err = run(*arguments)
        assert code == 0, err
        assert "warning: " in err
        assert "\x1b" not in out + err
        assert (out + err).encode()


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


def test_simulate(data, tmp_path):
    target = tmp_path / "result.nc"
    shown = data("simulate", "lsp", *SHORT, "-o", target)
    expected = {"status", "method", "rtol", "simulated_s", "seconds", "real_time_factor", "counts", "energy_residual"}
    assert expected | {"forces"} <= set(shown)
    assert {"steps", "rhs", "jacobian", "events"} <= set(shown["counts"])
    assert shown["status"] == "done"
    assert abs(shown["energy_residual"]) < 1e-5
    force = shown["forces"]["lsp.sun_planet.1"]
    assert {"mean", "min", "max", "load_factor"} <= set(force)
    assert force["min"] < force["mean"] < force["max"]
    assert target.read_bytes()[1:4] == b"HDF"
    assert [path.name for path in tmp_path.iterdir()] == ["result.nc"]


def test_an_interrupted_run_goes_on_or_is_begun_anew(run, refused, tmp_path, monkeypatch):
    @contextmanager
    def stopping(title, end):
        yield lambda now: os.kill(os.getpid(), signal.SIGINT)

    command = ("simulate", "psh", *SHORT, "-o", tmp_path / "result.nc")
    for last in ("--resume", "--force"):
        with monkeypatch.context() as patch:
            patch.setattr(commands.running, "progress", stopping)
            patch.setattr(integration, "SLICE", 0.0)
            code, _, err = run(*command)
        assert code == 130
        assert err.startswith("ltcgear: interrupted at t = ")
        assert err.endswith("result.part.nc, --resume goes on\n")
        assert sorted(path.suffixes[0] for path in tmp_path.iterdir()) == [".checkpoint", ".part"]
        assert "--resume goes on with it; to begin anew, delete it or give --force" in refused(*command)
        assert run(*command, last)[0] == 0
        assert [path.name for path in tmp_path.iterdir()] == ["result.nc"]
        (tmp_path / "result.nc").unlink()


@pytest.mark.parametrize("method", ["erk", "cvodes", "adams", "idas", "rosenbrock", "sundae"])
def test_simulate_by_every_method(data, method):
    shown = data("simulate", "psh", "--t-end", "0.002", "--method", method, "--rtol", "1e-5")
    assert (shown["status"], shown["method"], shown["rtol"]) == ("done", method, 1e-5)


def test_modes(data, run):
    modes = data("modes", "lin-parker-3")["modes"]
    frequencies = [mode["frequency_hz"] for mode in modes]
    assert frequencies == sorted(frequencies)
    assert frequencies[0] == pytest.approx(0.0, abs=1e-2)  # the rigid-body mode is listed
    assert {"frequency_hz", "damping_ratio", "class"} <= set(modes[0])
    assert "Hz" in run("modes", "lin-parker-3")[1]


def test_set_replaces_values(data):
    shown = data("info", "lsp", "--set", "effects.mesh_law=paper", "--set", "loads.ring.speed=7.5 rpm")
    assert shown["effects"]["mesh_law"] == "paper"
    assert data("info", "lsp", "--set", "title=a = b")["title"] == "a = b"


def test_help_and_no_command(run):
    assert run("--help")[0] == 0
    for command in ("scenes", "effects", "info", "check", "generate", "simulate", "modes", "cost"):
        code, out, _ = run(command, "--help")
        assert code == 0
        assert "--json" in out
    out = " ".join(run("simulate", "--help")[1].split())
    for text in ("Time to simulate [s].", "default: auto", "default: 1e-06", "simulation.t_end of the scene"):
        assert text in out


@pytest.mark.parametrize(
    ("factor", "text"),
    [(2.37, "2.4 times faster than real time"), (0.38, "2.6 times slower than real time"), (0.0, "stopped")],
)
def test_pace(factor, text):
    assert printed.pace(factor).startswith(text)


# --- exit code 1


def test_a_failed_check_is_exit_code_1(data, monkeypatch):
    from ltcgear.symbolic.checks import all_checks as checks
    from ltcgear.symbolic.checks.check import judged

    monkeypatch.setattr(checks, "check_model", lambda model: [judged("broken on purpose", 1.0, 1e-9, "test")])
    shown = data("check", "psh", code=1)
    assert shown["passed"] is False
    assert shown["checks"][0]["name"] == "broken on purpose"


# --- exit code 2


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["nosuch"], "No such command"),
        (["info"], "Missing argument"),
        (["info", "lsp", "hsp"], "unexpected extra argument"),
        (["info", "lsp", "--nosuch"], "No such option"),
        (["scenes", "lsp"], "unexpected extra argument"),
        (["simulate", "lsp", "--t-end", "soon"], "--t-end"),
        (["simulate", "lsp", "--rtol"], "requires an argument"),
        (["check"], "give a SCENE, or --paper"),
        (["check", "lsp", "--paper"], "both lsp and --paper were given"),
        (["paper", "--t-end", "0.0005"], "need 0.2 s at least"),
        (["paper", "--t-end", "nan"], "need 0.2 s at least"),
        (["check", "nosuch"], "nosuch: no such file"),
        (["info", "rig2mw"], 'did you mean "rig-2mw"?'),
        (["modes", "nosuch"], "shipped scenes: "),
        (["generate", "nosuch"], "no such file"),
        (["simulate", "nosuch"], "no such file"),
        (["simulate", "lsp", "--method", "rk4"], 'did you mean "erk"?'),
        (["simulate", "lsp", "--method", "ode45"], "method 'ode45': unknown"),
        (["simulate", "lsp", "--method", ""], "method '': unknown"),
        (["simulate", "lsp", "--rtol", "0"], "must lie between"),
        (["simulate", "lsp", "--rtol", "1"], "must lie between"),
        (["simulate", "lsp", "--rtol", "-1e-6"], "must lie between"),
        (["simulate", "lsp", "--rtol", "nan"], "must lie between"),
        (["simulate", "lsp", "--t-end", "0"], "t_end 0: must"),
        (["simulate", "lsp", "--t-end", "-1"], "t_end -1: must"),
        (["simulate", "lsp", "--t-end", "nan"], "t_end nan: must"),
        (["simulate", "lsp", "--t-end", "inf"], "t_end inf: must"),
        (["simulate", "lsp", "--resume"], "say which result is to go on, -o FILE.nc"),
        (["cost", "lsp", "--t-end", "0"], "t_end 0: must"),
        (["cost", "lsp", "--rtol", "1"], "must lie between"),
        (["cost", "lsp", "-o", "cost.jpg"], "name it cost.png"),
        (["cost", "nosuch"], "no such file"),
        (["info", "lsp", "--set"], "requires an argument"),
        (["info", "lsp", "--set", "foo"], "write KEY=VALUE"),
        (["info", "lsp", "--set", "=3"], "write KEY=VALUE"),
        (["info", "lsp", "--set", "effects.mesh_law=papre"], 'did you mean "paper"?'),
        (["info", "lsp", "--set", "stages.lsp.modul=16 mm"], 'did you mean "module"?'),
        (["info", "lsp", "--set", "stages.lsp.module=16"], 'write it like "16 mm"'),
        (["info", "lsp", "--set", "title.x=1"], "is a value, not a table"),
        (["info", "lsp", "--set", "x=" + "[" * 50_000], "unknown key"),
        (["modes", "lsp", "--set", "a" + ".a" * 3000 + "=1"], "nested too deeply"),
        (["check", "lsp", "--set", "x=" + "9" * 6000], "unknown key"),
    ],
    ids=lambda value: " ".join(value)[:60] if isinstance(value, list) else "",
)
@pytest.mark.parametrize("more", [[], ["--json"]], ids=["", "json"])
def test_bad_input_is_exit_code_2(refused, arguments, reason, more):
    if more and arguments[-1] in ("--set", "--rtol"):
        pytest.skip("the option would take --json for its value")
    assert reason in " ".join(refused(*arguments, *more).split())


def test_a_bad_scene_file_is_exit_code_2(refused, tmp_path):
    path = tmp_path / "bad.toml"
    path.write_text('title = "x"\n[rotors.a]\nintertia = "1 kg"\n[effects]\ngravity = "of"\n', encoding="utf-8")
    for command in ("info", "check", "generate", "simulate", "modes"):
        text = refused(command, path, "--json")
        assert text.startswith(f"ltcgear: {path}: 2 defects\n")
        assert 'rotors.a.intertia: unknown key; did you mean "inertia"?' in text
        assert "effects.gravity: 'of'" in text


@pytest.fixture
def nothing_computed(monkeypatch):
    """Let any computing fail the test."""

    def computed(*arguments, **keys):
        pytest.fail("computed before the target was refused")

    monkeypatch.setattr(commands.running, "open_scene", computed)


@pytest.mark.usefixtures("nothing_computed")
def test_an_unwritable_result_is_refused_before_computing(refused, tmp_path):
    assert "does not exist" in refused("simulate", "lsp", "-o", tmp_path / "no" / "x.nc")
    assert "is a folder" in refused("simulate", "lsp", "-o", tmp_path)
    assert f"name it {tmp_path / 'x.nc'}" in refused("simulate", "lsp", "-o", tmp_path / "x.csv")
    unstarted = refused("simulate", "lsp", "--resume", "-o", tmp_path / "x.nc")
    assert f"{tmp_path / 'x.checkpoint.npz'}: not there, so there is nothing to go on from" in unstarted
    (tmp_path / "file").write_text("", encoding="utf-8")
    assert "does not exist" in refused("simulate", "lsp", "-o", tmp_path / "file" / "x.nc")


@pytest.mark.usefixtures("nothing_computed")
def test_a_folder_without_the_right_to_write_is_refused_before_computing(refused, tmp_path, monkeypatch):
    def refuse(*arguments, **keys):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(writing, "make_draft", refuse)
    assert "cannot be written" in refused("simulate", "lsp", "-o", tmp_path / "x.nc")


def test_a_target_for_c_that_is_a_file_is_refused(refused, tmp_path):
    (tmp_path / "file").write_text("kept", encoding="utf-8")
    assert "is a file; give a folder" in refused("generate", "psh", "-o", tmp_path / "file")
    assert "is a file; give a folder" in refused("generate", "psh", "-o", tmp_path / "file" / "below")
    assert (tmp_path / "file").read_text("utf-8") == "kept"


def test_a_store_others_may_write_is_refused(refused, tmp_path, monkeypatch):
    tmp_path.chmod(0o777)
    monkeypatch.setenv("LTCGEAR_CACHE", str(tmp_path))
    assert "set LTCGEAR_CACHE" in refused("info", "lsp")


# --- exit code 3


def test_a_scene_without_equilibrium_is_exit_code_3(refused):
    text = refused("modes", "lsp", "--set", "loads.ring={member='lsp.ring', torque='1 N*m'}", code=3)
    assert text.startswith("ltcgear: ")


def test_a_run_that_stops_is_exit_code_3(run, monkeypatch, tmp_path):
    summary = {"status": "erk stopped at t = 0.1 s"}
    monkeypatch.setattr(commands.running, "run", lambda *arguments, **keys: summary)
    monkeypatch.setattr(printed, "simulated", lambda data: None)
    for command in (("simulate", "lsp"), ("paper", "-o", tmp_path)):
        code, _, err = run(*command)
        assert (code, err) == (3, "ltcgear: erk stopped at t = 0.1 s\n")


def test_a_compiler_that_is_not_there_is_exit_code_3(refused, monkeypatch):
    monkeypatch.setenv("CC", "/nonexistent/cc")
    generated_store.compiler.cache_clear()
    try:
        assert "no such compiler" in refused("generate", "psh", code=3)
    finally:
        generated_store.compiler.cache_clear()


def test_without_a_compiler_the_virtual_machine_serves_all_but_simulations(run, monkeypatch):
    monkeypatch.setattr(building.store, "compiler", lambda: None)
    cstruct.engine.cache_clear()
    code, out, err = run("modes", "psh", "--json")
    assert code == 0
    assert json.loads(out)["modes"]
    assert "no C compiler found" in err
    code, out, err = run("simulate", "psh", "--t-end", "0.002", "--json")
    assert (code, out) == (3, "")
    assert err.splitlines()[-1] == f"ltcgear: {cstruct.NEEDED}"


# --- the program itself


@pytest.mark.parametrize(
    ("arguments", "code"), [(["scenes", "--json"], 0), (["info", "nosuch", "--json"], 2), (["nosuch"], 2)]
)
def test_the_installed_program(arguments, code):
    program = Path(sys.executable).with_name("ltcgear")
    done = subprocess.run([program, *arguments], capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == code
    assert "Traceback" not in done.stdout + done.stderr
    assert bool(done.stdout) is (code == 0)
    assert bool(done.stderr) is (code != 0)


STARTED = """
import sys
from ltcgear.runtime.cli import commands
sys.argv = ["ltcgear", *sys.argv[1:]]
module = sys.modules["ltcgear.runtime.cli.app"]
app = module.app
def started(**options):  # what comes before is the interpreter's own
    print("ready", flush=True)
    return app(**options)
module.app = started
commands.main()
"""


@pytest.mark.parametrize("delay", [0.0, 3.0], ids=["while it starts", "while it integrates"])
def test_control_c_is_exit_code_130(delay):
    command = [sys.executable, "-c", STARTED, "simulate", "lsp", "--t-end", "1000", "--set", "simulation.rate=100 Hz"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as program:
        assert program.stdout is not None
        assert program.stdout.readline() == "ready\n"
        sleep(delay)
        os.kill(program.pid, signal.SIGINT)
        _, err = program.communicate(timeout=60)
    assert program.returncode == 130
    assert len(err.splitlines()) == 1
    assert err.startswith("ltcgear: ")
