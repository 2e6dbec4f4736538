"""The commands campbell and response: their data, their files, and what they refuse."""

import csv
import json

import pytest

CAMPBELL = ("campbell", "psh", "--speed", "300:900:4", "--harmonics", "2")
RESPONSE = ("response", "psh", "--excite", "psh.mesh", "--from", "100", "--to", "3000")


def test_campbell_tells_modes_orders_and_crossings(data):
    found = data(*CAMPBELL)
    assert found["scene"] == "psh"
    assert (found["axis"], found["unit"]) == ("speed", "rpm")
    assert found["home"] == pytest.approx(638.9, abs=0.01)
    assert len(found["values"]) == 5
    assert found["home"] in found["values"]
    assert [order["name"] for order in found["orders"]] == ["psh", "2 psh"]
    assert [mode["mode"] for mode in found["modes"]] == [1, 2, 3, 4, 5]
    assert all(len(mode["frequency_hz"]) == 5 for mode in found["modes"])
    listed = {item["crossing"]: item for item in found["crossings"]}
    first = listed["psh with mode 1"]
    assert first["at"] * 59 / 60 == pytest.approx(first["frequency_hz"], rel=1e-6)
    assert first["margin"] == pytest.approx(first["at"] / found["home"] - 1)
    assert first["force"] > 0
    assert first["mesh"] == "psh.mesh"


def test_campbell_over_load_and_with_sidebands(data):
    found = data("campbell", "psh", "--load", "0.5:2:3", "--sidebands")
    assert found["values"] == [0.5, 1.0, 1.25, 2.0]
    assert {order["side"] for order in found["orders"]} == {""}  # a pair has neither carrier nor planets
    planets = data("campbell", "hsp", "--speed", "70:90:2", "--sidebands", "--harmonics", "1")
    assert {order["side"] for order in planets["orders"]} == {"", "carrier", "ring pass", "sun pass"}
    assert all(item["force"] is None for item in planets["crossings"] if " pass" in item["order"])


def test_response_tells_amplitudes_phases_and_peaks(data):
    found = data(*RESPONSE)
    assert (found["excited"], found["unit"]) == ("psh.mesh", "m")
    assert (found["frequency_hz"][0], found["frequency_hz"][-1]) == (100, 3000)
    own = next(o for o in found["outputs"] if (o["quantity"], o["item"]) == ("mesh_force", "psh.mesh"))
    assert len(own["amplitude"]) == len(own["phase_deg"]) == len(found["frequency_hz"])
    assert own["unit"] == "N/m"
    top = own["peaks"][0]
    assert top["amplitude"] == pytest.approx(max(own["amplitude"]))
    assert found["modes"][top["mode"] - 1]["frequency_hz"] == pytest.approx(top["frequency_hz"], rel=0.05)
    ripple = data("response", "psh", "--excite", "output")
    assert ripple["unit"] == "N*m"
    assert {o["unit"] for o in ripple["outputs"] if o["quantity"] == "mesh_force"} == {"N/(N*m)"}


@pytest.mark.parametrize("command", [CAMPBELL, RESPONSE])
def test_files(run, command, tmp_path):
    for name in ("a.png", "a.csv", "a.json"):
        code, out, err = run(*command, "-o", tmp_path / name)
        assert (code, err) == (0, "")
        assert f"wrote {tmp_path / name}" in out
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    with (tmp_path / "a.csv").open(newline="") as file:
        rows = list(csv.reader(file))
    told = json.loads((tmp_path / "a.json").read_text())
    axis = told["values" if command is CAMPBELL else "frequency_hz"]
    assert [float(row[0]) for row in rows[1:]] == axis
    assert {len(row) for row in rows} == {len(rows[0])}
    assert all("[" in name or "ratio" in name for name in rows[0])


def test_tables_name_what_they_show(run, monkeypatch):
    monkeypatch.setenv("COLUMNS", "150")
    _, out, _ = run(*CAMPBELL)
    assert "psh with mode 1" in out
    assert "the scene's own is 638.9" in out
    _, out, _ = run(*RESPONSE)
    assert "1 um of transmission error of psh.mesh" in out


def test_what_has_no_end_is_told_so(data, run, monkeypatch):
    found = data("response", "lin-parker-3", "--excite", "gear.sun_planet.1")
    peaks = [peak for output in found["outputs"] for peak in output["peaks"]]
    assert peaks
    assert {peak["amplitude"] for peak in peaks} == {None}
    monkeypatch.setenv("COLUMNS", "150")
    _, out, _ = run("response", "lin-parker-3", "--excite", "gear.sun_planet.1")
    assert "undamped" in out


def test_teeth_are_asked_for_where_there_is_no_order(run, data):
    scene = ("campbell", "lin-parker-3", "--speed", "0:100:2", "--set", "loads.sun.member=gear.sun")
    scene += ("--set", "loads.sun.speed=80 rpm")
    assert data(*scene)["orders"] == []
    assert "give teeth" in run(*scene)[1].replace("\n", " ")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("campbell", "psh", "--speed", "1:2:3", "--load", "1:2:3"), "give one of them"),
        (("campbell", "psh", "--speed", "1:2"), "FIRST:LAST:NUMBER"),
        (("campbell", "psh", "--load", "-1:2:3"), "FIRST:LAST:NUMBER"),
        (("campbell", "lin-parker-3"), "the train stands"),
        (("campbell", "lin-parker-3", "--load", "1:2:3"), "no load of the scene has a torque"),
        (("campbell", "psh", "-o", "a.txt"), ".png"),
        (("response", "psh", "--excite", "psh.mash"), "did you mean psh.mesh"),
        (("response", "psh", "--excite", "input"), "loads with a torque: output"),
        (("response", "psh", "--excite", "psh.mesh", "--from", "5", "--to", "1"), "0 < from < to"),
        (("response", "psh", "--excite", "psh.mesh", "-o", "nowhere/a.png"), "does not exist"),
    ],
)
def test_what_cannot_be_is_refused(refused, arguments, words):
    assert words in refused(*arguments)
