"""Gearbox: one object from the scene to its results, the same numbers as by the functions behind it."""

import subprocess
import sys

import ltcgear as lg
import numpy as np
import pytest
from ltcgear.generated.errors import CheckError, SceneError, SolverError
from ltcgear.runtime import simulate

from ..models import case

BAD = "<script>alert(1)</script>"


@pytest.fixture(scope="module")
def psh():
    return lg.load("psh")


def make_discs(title="two discs on a shaft"):
    return (
        lg.SceneBuilder(title)
        .rotor("rotor", inertia="4 kg*m^2")
        .rotor("generator", inertia="2 kg*m^2")
        .coupling("shaft", "rotor", "generator", stiffness="1e5 N*m/rad")
        .load("motor", member="rotor", torque="10 N*m")
        .load("brake", member="generator", torque="-10 N*m")
        .build("discs")
    )


def test_it_simulates_as_the_functions_do(psh, tmp_path):
    c = case("psh")
    wished = simulate(c.library, c.model.values(), t_end=0.02, tables=c.model.tables)
    found = psh.simulate(t_end=0.02)
    kept = psh.simulate(tmp_path / "a.nc", t_end=0.02)
    for one in (found, kept, lg.read_result(tmp_path / "a.nc")):
        assert isinstance(one, lg.SimulationResult)
        assert np.array_equal(one.dataset["mesh_force"].values, wished.dataset["mesh_force"].values)
        assert one.dataset.attrs["scene"] == "psh"
    assert psh.scene.simulation.t_end == pytest.approx(psh.simulate().summary["simulated_s"], rel=1e-3)


def test_a_scene_of_the_builder_and_changes(psh, tmp_path):
    gear = lg.load(make_discs())
    # Two discs on a spring: omega^2 = k (1 / J1 + 1 / J2).
    assert max(gear.modes().frequencies_hz) == pytest.approx(np.sqrt(1e5 * (1 / 4 + 1 / 2)) / (2 * np.pi))
    with pytest.raises(lg.LtcgearError, match="change the builder's"):
        gear.changed({"rotors.rotor.inertia": "8 kg*m^2"})
    with pytest.raises(lg.LtcgearError, match="scenes that are read"):
        gear.sweep("rotors.rotor.inertia=1 kg*m^2:2 kg*m^2:2", tmp_path / "a.nc")
    stiffer = psh.changed({"effects.damping": "off"}).changed({"effects.contact": "backlash"})
    assert (stiffer.scene.effects["damping"], stiffer.scene.effects["contact"]) == ("off", "backlash")
    assert psh.scene.effects["damping"] == "on"


def test_modes_list_and_draw_themselves(psh, tmp_path):
    modes = psh.modes()
    assert len(modes) == len(modes.frequencies_hz) == len(modes.table().rows)
    assert [mode.frequency_hz for mode in modes[:2]] == modes.frequencies_hz[:2]
    assert "the lowest 2 of" in str(psh.modes(2).table())
    assert modes.draw(tmp_path / "a.svg", [1]).read_text("utf-8").startswith("<?xml")
    assert "<html" in modes.draw(tmp_path / "a.html").read_text("utf-8")


def test_results_draw_themselves_and_write_their_report(psh, tmp_path):
    result = psh.simulate(t_end=0.05)
    mesh = next(iter(result.mesh))
    assert result.table().column("mesh") == tuple(result.mesh)
    assert mesh in result.plot(mesh).axes[0].get_title(loc="left") == result.plot().axes[0].get_title(loc="left")
    page = result.report(tmp_path / "a.html", modes=False)
    assert "Mesh forces" in page.read_text("utf-8")
    with pytest.raises(lg.LtcgearError, match=r"no meshes 'nothing'; there are "):
        result.plot("nothing")
    bare = lg.load(make_discs()).simulate(t_end=0.05, rate=1000.0)
    for lacking in (bare.plot, bare.table):
        with pytest.raises(lg.LtcgearError, match=r"has no mesh|no statistics"):
            lacking()


def test_a_sweep_goes_on_and_gives_its_rows(psh, tmp_path):
    options = {"t_end": 0.01, "rate": 8192.0, "workers": 1}
    rows = psh.sweep("effects.contact=bilateral,backlash", tmp_path / "a.nc", **options)
    assert rows.sizes["point"] == 2
    assert set(rows["status"].values) == {"done"}
    again = psh.sweep(["effects.contact=bilateral,backlash"], tmp_path / "a.nc", **options)
    assert again.identical(rows)


def test_checks_and_information_are_tables(psh, monkeypatch):
    assert "0 failed" in psh.check().notes[0]
    assert psh.info()[0].title == psh.title
    from ltcgear.symbolic.checks import all_checks, check

    monkeypatch.setattr(all_checks, "physics", lambda model: [check.judged("a law", 1.0, 0.0, "")])
    with pytest.raises(CheckError, match="a law"):
        psh.check()


def test_what_is_wrong_is_told(tmp_path):
    with pytest.raises(SceneError, match=r"nowhere\.toml"):
        lg.load(tmp_path / "nowhere.toml")
    with pytest.raises(lg.LtcgearError, match=r"read_result reads it"):
        lg.load("lsp.nc")
    with pytest.raises(SceneError, match="did you mean"):
        lg.load("psh", {"effects.dampin": "off"})
    with pytest.raises(TypeError, match="tend"):
        lg.load("psh").simulate(tend=1.0)
    assert issubclass(SolverError, lg.LtcgearError)


def test_a_notebook_shows_text_as_text(psh):
    gear = lg.load(make_discs(BAD))
    result = gear.simulate(t_end=0.05, rate=1000.0)
    result.dataset.attrs["scene"] = BAD
    for shown in (gear, result, gear.modes(), psh, psh.modes(), psh.simulate(t_end=0.01)):
        html = shown._repr_html_()
        assert BAD not in html
        assert "<table" in html or shown is result
        assert repr(shown).startswith(f"<{type(shown).__name__} ")


def test_the_package_has_its_names_a_version_and_a_command():
    assert {"Gearbox", "SceneBuilder", "load", "read_result", "shipped_scenes"} <= set(dir(lg))
    assert all(getattr(lg, name) is not None for name in dir(lg))
    with pytest.raises(AttributeError, match="nonsense"):
        _ = lg.nonsense
    told = subprocess.run([sys.executable, "-m", "ltcgear", "--version"], capture_output=True, text=True, check=True)
    assert told.stdout == f"ltcgear {lg.__version__}\n"
    code = "import sys, ltcgear; print(*sorted({'numpy', 'casadi', 'sympy', 'pydantic', 'xarray'} & set(sys.modules)))"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout == "\n"


def test_types_are_those_that_a_checker_sees(tmp_path):
    lines = {
        "gear": "Gearbox", "gear.simulate(t_end=0.1)": "SimulationResult", "gear.simulate().plot()": "Figure",
        "gear.modes()[0]": "Mode", "gear.modes()": "ModeList", "gear.modes().table()": "Table", "lg.__version__": "str",
    }  # fmt: skip
    program = ["import ltcgear as lg", 'gear = lg.load("lsp")', *(f"reveal_type({line})" for line in lines)]
    (tmp_path / "program.py").write_text("\n".join([*program, 'gear.simulate(t_end="long")', ""]), "utf-8")
    checked = [sys.executable, "-m", "mypy", "--strict", "program.py"]
    told = subprocess.run(checked, capture_output=True, text=True, check=False, cwd=tmp_path).stdout
    revealed = [line.split('"')[1].rpartition(".")[2] for line in told.splitlines() if "Revealed type" in line]
    assert revealed == list(lines.values())
    assert told.count("error:") == 1
    assert 'has incompatible type "str"' in told
