"""The command `ltcgear stability`: what it prints, writes and refuses."""

import csv
import json

import pytest

UNDAMPED = ["--set", "effects.damping=off", "--set", "effects.mesh_damping=off"]


def test_multipliers(run, tmp_path):
    file = tmp_path / "multipliers.csv"
    code, out, _ = run("stability", "lsp", "--json", "-o", str(file))
    data = json.loads(out)
    assert code == 0
    assert data["stable"] is True
    assert data["mesh_frequencies_hz"]["lsp"] == pytest.approx(29.5)
    assert len(data["meshes"]) == 8
    assert data["largest"] == data["multipliers"][0]["modulus"] < 1
    with file.open() as opened:
        rows = list(csv.DictReader(opened))
    assert [float(row["growth [1/s]"]) for row in rows] == [item["growth_rate"] for item in data["multipliers"]]
    code, out, _ = run("stability", "lsp")
    assert code == 0
    assert "stable: every small motion" in out
    assert "UNSTABLE" not in out


def test_a_growing_motion_is_named(run, tmp_path):
    figure = tmp_path / "circle.svg"
    options = ["--speed", "557.7", "--variation", "2", *UNDAMPED]
    code, out, _ = run("stability", "lsp", *options, "-o", str(figure))
    assert code == 0
    assert "UNSTABLE" in out
    assert "2 w11 = W" in out
    assert figure.stat().st_size > 1000


def test_chart(run, tmp_path):
    options = ["--speed", "520:600:5", "--variation", "0:2:3", *UNDAMPED]
    data = json.loads(run("stability", "lsp", *options, "--json", "-o", str(tmp_path / "chart.csv"))[1])
    assert data["points"] == 15
    assert data["unstable"] == sum(value > 1 + 1e-6 for row in data["largest"] for value in row) > 0
    assert data["largest"][2][0] == pytest.approx(1.0)
    assert data["tongues"][0]["name"] == "2 w11 = W"
    assert 520 <= data["tongues"][0]["speed_rpm"] <= 600
    with (tmp_path / "chart.csv").open() as opened:
        rows = list(csv.DictReader(opened))
    assert [float(row["largest multiplier"]) for row in rows] == [value for line in data["largest"] for value in line]
    code, out, _ = run("stability", "lsp", *options, "-o", str(tmp_path / "chart.png"))
    assert code == 0
    assert f"{data['unstable']} of 15 points unstable" in out.replace("\n", " ")
    assert (tmp_path / "chart.png").stat().st_size > 10_000


@pytest.mark.parametrize("options", [["--speed", "540:580:3"], ["--variation", "0:2:3"]])
def test_a_chart_may_be_a_line(run, tmp_path, options):
    data = json.loads(run("stability", "lsp", *options, "--json", "-o", str(tmp_path / "line.png"))[1])
    assert data["points"] == 3
    assert (tmp_path / "line.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["lsp", "--mesh", "lsp.sun_plant"], "did you mean lsp.sun_planet?"),
        (["lsp", "--speed", "3:2:5"], "--speed 3:2:5: write FIRST:LAST:NUMBER"),
        (["lsp", "--speed", "x"], "for example --speed 100:600:60"),
        (["lsp", "--variation", "0:1:2:3"], "write FIRST:LAST:NUMBER"),
        (["lsp", "--variation=-1"], "write FIRST:LAST:NUMBER"),
        (["lsp", "--variation", "0:1:9999"], "9999 values, 1000 at most"),
        (["lsp", "--speed", "0:10:5"], "at rest no stiffness varies; begin above 0"),
        (["lsp", "--speed", "0"], "no stiffness varies"),
        (["lsp", "-o", "chart.txt"], "name it chart.png"),
        (["lin-parker-3"], "stands still"),
        (["start-up"], "nothing is periodic"),
        (["lsp", "--set", "effects.mesh_stiffness=mean"], "no stiffness varies; set effects.mesh_stiffness"),
        (["rig-2mw", "--speed", "5:20:31", "--variation", "0:1:21"], "--mesh lsp"),
    ],
)
def test_what_cannot_be_done_is_refused_with_the_cure(run, arguments, told):
    code, out, err = run("stability", *arguments)
    assert code == 2
    assert out == ""
    assert told in err
    assert "Traceback" not in err
