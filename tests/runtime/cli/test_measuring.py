"""`ltcgear accuracy`, and `ltcgear simulate --accuracy`: what they print, write, keep and refuse."""

import json

import pytest
from ltcgear.runtime.cli import commands
from ltcgear.runtime.studies.accuracy import phases, reference
from ltcgear.runtime.studies.accuracy.phases import PHASES, measure_phases

TIME = ("--t-end", "0.01")
FEW = ("--method", "erk", "--method", "cvodes", "--rtol", "1e-3", "--rtol", "1e-6")


@pytest.fixture
def no_phases(monkeypatch):
    """Leave out the phases: each takes two processes."""
    monkeypatch.setattr(phases, "measure_phases", lambda *arguments: {"cold": None, "warm": None, "reason": "left out"})


@pytest.mark.usefixtures("no_phases")
def test_accuracy(run, tmp_path):
    code, out, err = run("accuracy", "psh", *TIME, *FEW, "-o", tmp_path / "made", "--json")
    assert (code, len(out.splitlines())) == (0, 1), err
    shown = json.loads(out)
    assert {"reference", "points", "best", "machine", "phases"} <= shown.keys()
    assert [(point["method"], point["rtol"]) for point in shown["points"]] == [
        (method, rtol) for method in ("erk", "cvodes") for rtol in (1e-3, 1e-6)
    ]
    assert all({"errors", "seconds", "counts"} <= point.keys() for point in shown["points"])
    assert all({"error", "method", "rtol", "seconds"} <= entry.keys() for entry in shown["best"])
    assert shown["reference"]["reason"] is None
    assert json.loads((tmp_path / "made" / "accuracy.json").read_text("utf-8")) == shown
    names = {path.name for path in (tmp_path / "made").iterdir()}
    assert {"accuracy.csv", "error-time.png", "error-calls.png", "tolerance.png", "overview.png"} <= names

    # The record serves a run of the same model.
    asked = ("simulate", "psh", *TIME, "--accuracy", "0.1%", "--record", tmp_path / "made" / "accuracy.json")
    code, out, err = run(*asked, "--json")
    assert code == 0, err
    summary = json.loads(out)
    best = next(entry for entry in shown["best"] if entry["error"] == 1e-3)
    assert (summary["method"], summary["rtol"]) == (best["method"], best["rtol"])
    assert summary["setting"]["expected"] == best["found"] <= 1e-3
    assert summary["setting"]["warning"] is None
    assert str(tmp_path) in summary["setting"]["record"]
    said = " ".join(run(*asked)[1].split())
    assert "it was the fastest for 0.1 %" in said

    # Other numbers of the model are warned about, another model is refused.
    code, out, err = run(*asked, "--set", "loads.output.torque=-2e4 N*m", "--json")
    assert code == 0
    assert "other numbers" in err
    assert "other numbers" in json.loads(out)["setting"]["warning"]
    code, out, err = run(*asked, "--set", "effects.mesh_stiffness=mean")
    assert (code, out) == (2, "")
    assert "of another model" in err
    assert run("simulate", "psh", "--accuracy", "1e-12%", *asked[-2:])[0] == 2


@pytest.mark.usefixtures("no_phases")
def test_without_reference_the_reason_is_told(run, monkeypatch):
    monkeypatch.setattr(reference, "LARGEST", 1e-15)
    code, out, err = run("accuracy", "psh", *TIME, *FEW, "--json")
    shown = json.loads(out)
    assert code == 3
    assert "psh: no reference for errors: erk at rtol 1e-13 and rosenbrock at rtol 1e-13" in err
    assert shown["reference"]["reason"]
    assert all(point["errors"] == {} and point["seconds"] > 0 for point in shown["points"])
    assert {entry["method"] for entry in shown["best"]} == {None}
    out = " ".join(run("accuracy", "psh", *TIME, *FEW)[1].split())
    assert "No errors: erk at rtol 1e-13" in out


def test_a_record_is_made_once_and_kept(run, monkeypatch):
    """Only erk and two tolerances, to be quick; the second run finds the record."""
    from ltcgear.runtime.studies.accuracy import presets, study

    few = presets.Preset((1e-3, 1e-5), 1.1, 64, 60.0, 0.0)
    monkeypatch.setitem(presets.PRESETS, "quick", few)
    monkeypatch.setattr(study, "installed_methods", lambda: ["erk"])
    asked = ("simulate", "psh", *TIME, "--accuracy", "1%", "--set", "stages.psh.mesh.damping_ratio=0.06", "--json")
    code, out, err = run(*asked)
    assert code == 0, err
    assert "no record of its accuracy yet; measuring one" in err
    first = json.loads(out)
    code, out, err = run(*asked)
    assert code == 0
    assert "measuring" not in err
    second = json.loads(out)
    assert second["setting"] == first["setting"]
    assert second["method"] == "erk"
    assert second["setting"]["expected"] <= 0.01
    monkeypatch.setattr(reference, "LARGEST", 1e-15)
    code, out, err = run(*asked[:-2], "stages.psh.mesh.damping_ratio=0.07")
    assert (code, out) == (3, "")
    assert "no accuracy can be told" in err


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["accuracy"], "Missing argument"),
        (["accuracy", "nosuch"], "no such file"),
        (["accuracy", "psh", "--preset", "slow"], "--preset 'slow': unknown; there are quick, full"),
        (["accuracy", "psh", "--method", "rk4"], "--method 'rk4': unknown"),
        (["accuracy", "psh", "--rtol", "1"], "must lie between"),
        (["accuracy", "psh", "--rtol", "1e-3", "--rtol", "nan"], "must lie between"),
        (["accuracy", "psh", "--t-end", "0"], "t_end 0: must"),
        (["accuracy", "psh", "-o", "/dev/null/x"], "is a file; give a folder"),
        (["simulate", "psh", "--accuracy", "0%"], "above 0 %"),
        (["simulate", "psh", "--accuracy", "200%"], "below 100 %"),
        (["simulate", "psh", "--accuracy", "abc"], "write a percentage, for example 0.1%"),
        (["simulate", "psh", "--accuracy", ""], "write a percentage"),
        (["simulate", "psh", "--accuracy", "1%", "--method", "auto"], "leave out --method"),
        (["simulate", "psh", "--accuracy", "1%", "--rtol", "1e-6", "--method", "erk"], "leave out --method and --rtol"),
        (["simulate", "psh", "--record", "x.json"], "say which error is wanted"),
        (["simulate", "psh", "--accuracy", "1%", "--record", "nosuch.json"], "no such record"),
        (["simulate", "psh", "--accuracy", "1%", "--record", __file__], "not a record"),
    ],
)
def test_bad_input_is_exit_code_2(run, monkeypatch, arguments, reason):
    def computed(*args, **keys):
        pytest.fail("computed before the input was refused")

    if "nosuch" not in arguments:
        monkeypatch.setattr(commands.measuring, "open_scene", computed)
        monkeypatch.setattr(commands.running, "open_scene", computed)
    for more in ([], ["--json"]):
        code, out, err = run(*arguments, *more)
        assert (code, out) == (2, "")
        assert reason in " ".join(err.split())


def test_help_tells_the_options(run):
    out = " ".join(run("accuracy", "--help")[1].split())
    for text in ("--preset", "--method", "--rtol", "--t-end", "--set", "--json", "some pitches of the slowest mesh"):
        assert text in out
    assert "--accuracy" in run("simulate", "--help")[1]


def test_phases_are_those_of_a_process_of_its_own():
    found = measure_phases(["hard-bounce"], 0.005, "erk", 1e-5)
    assert found["reason"] is None
    cold, warm = found["cold"], found["warm"]
    assert set(cold) == set(warm) == {"start", *PHASES, "total"}
    assert cold["check"] > 0.0 == warm["check"]  # what the store holds is not derived again
    assert cold["emit"] > 0.0 == warm["emit"]
    for run_ in (cold, warm):
        assert run_["start"] > 0
        assert sum(run_.values()) == pytest.approx(2 * run_["total"])
    failed = measure_phases(["nosuch"], 0.005, "erk", 1e-5)
    assert failed["cold"] is None
    assert "no such file" in failed["reason"]
