"""`ltcgear sensitivity`: what it prints, writes and refuses."""

import csv
import json

import pytest

OUTPUT = ("--output", "mesh_force:psh.mesh", "--t-end", "0.01")


def test_modes(run):
    code, out, err = run("sensitivity", "psh", "--json")
    assert (code, len(out.splitlines())) == (0, 1), err
    shown = json.loads(out)
    assert [item["mode"] for item in shown["items"]] == [1, 2, 3, 4, 5]
    row = shown["items"][0]["influences"][0]
    assert row.keys() == {"parameter", "value", "unit", "kind", "derivative", "relative", "beside"}
    assert row["relative"] == pytest.approx(row["derivative"] * row["value"] / shown["items"][0]["value"])


def test_tables_tell_the_strongest(run):
    code, out, _ = run("sensitivity", "psh", "--mode", 1, "--top", 2)
    assert code == 0
    assert out.index("psh.input.bearing.stiffness") < out.index("psh.input.mass")
    assert "psh.output.mass" not in out
    code, out, _ = run("sensitivity", "psh", *OUTPUT, "--measure", "vibration")
    assert code == 0
    assert "begins on a border of its mesh" in out
    assert out.index("psh.mesh.stiffness_single") < out.index("reference.speed")


def test_files(run, tmp_path):
    assert run("sensitivity", "psh", *OUTPUT, "-o", tmp_path / "all.csv")[0] == 0
    rows = list(csv.DictReader((tmp_path / "all.csv").read_text("utf-8").splitlines()))
    shown = json.loads(run("sensitivity", "psh", *OUTPUT, "--json")[1])["items"][0]["influences"]
    assert [(row["parameter"], float(row["derivative"])) for row in rows] == [
        (row["parameter"], row["derivative"]) for row in shown
    ]
    for name in ("bars.png", "bars.svg", "bars.pdf"):
        assert run("sensitivity", "lin-parker-3", "-o", tmp_path / name)[0] == 0
        assert (tmp_path / name).stat().st_size > 10_000


def test_extremes_and_their_order(run):
    """A largest value lies above the mean and a smallest below; of a steady load, both follow the load most."""
    value = {}
    for measure in ("min", "mean", "max"):
        code, out, err = run("sensitivity", "psh", *OUTPUT, "--measure", measure, "--json")
        assert code == 0, err
        item = json.loads(out)["items"][0]
        value[measure] = item["value"]
        torque = next(row for row in item["influences"] if row["parameter"] == "loads.output.torque")
        assert torque["relative"] == pytest.approx(1.0, abs=0.05)
    assert value["min"] < value["mean"] < value["max"]


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("psh", "--mode", 99), "--mode 99: there are 5 modes; `ltcgear modes` lists them"),
        (("lin-parker-3", "--mode", 1), "--mode 1: a rigid-body mode"),
        (("psh", "--mode", 1, *OUTPUT), "both --mode and --output were given; give one"),
        (("psh", "--output", "mesh_force:psh"), "nearest: psh.mesh"),
        (("psh", "--output", "force:psh.mesh"), "no such quantity; write QUANTITY:ITEM with one of"),
        (("psh", "--output", "mesh_phase:psh.mesh"), "grows with time"),
        (("psh", *OUTPUT, "--measure", "peak"), "--measure peak: must be one of mean, rms, vibration, max, min"),
        (("psh", *OUTPUT, "--from", "0.02"), "--from 0.02: must be a time between 0 and the end of the run"),
        (("psh", *OUTPUT, "--rtol", "1"), "rtol 1: must lie between"),
        (("psh", *OUTPUT, "--method", "euler"), "euler"),
        (("psh", "-o", "x.txt"), "x.txt: sensitivities are written as .csv, .png, .svg, .pdf; name it x.csv"),
    ],
)
def test_bad_input_is_refused(run, arguments, reason):
    code, out, err = run("sensitivity", *arguments)
    assert (code, out) == (2, "")
    assert reason in err


def test_a_window_in_which_nothing_moves_has_no_vibration(run):
    code, _, err = run(
        "sensitivity", "hard-bounce", "--output", "mesh_force:pair.mesh", "--t-end", "0.001", "--measure", "vibration"
    )
    assert code == 2
    assert "stays as it is" in err
