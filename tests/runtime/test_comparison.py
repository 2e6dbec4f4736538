import json
import math

import numpy as np
import pytest
from ltcgear.runtime.comparison import compare, position_spectrum, published
from ltcgear.runtime.tables import Table
from rich.console import Console

from .synthetic import ALPHA, HSP, SPEEDS, STEADY, make_dataset


@pytest.fixture(scope="module")
def dataset():
    return make_dataset(pressure_angle=True)


@pytest.fixture(scope="module")
def tables(dataset):
    return compare(dataset)


def row_of(table, position):
    return dict(zip(table.columns, next(row for row in table.rows if row[0] == position), strict=True))


def test_print_is_kept_digit_for_digit():
    paper = published()
    assert [row["speed"] for row in paper["table7"]["rows"]] == [
        15, 36.87, 80.45, 189.84, 638.82, 638.82, 1794.75,
    ]  # fmt: skip
    assert [(row["mean"], row["amplitude"], row["load_factor"]) for row in paper["table9"]["rows"]] == [
        (3.34, 0.39, 1.118),
        (3.55, 0.47, 1.134),
        (0.97, 0.36, 1.373),
        (0.98, 0.34, 1.349),
        (1.09, 0.29, 1.268),
    ]
    assert [row["service_load"] for row in paper["table4"]["rows"]] == [3.55, 3.55, 1.04, 1.03, 1.17]
    assert paper["operating"]["output_torque"] == 1.06e4
    assert all(f"Table {key[5:]}" in paper[key]["citation"] for key in paper if key.startswith("table"))


def test_printed_load_factors_follow_from_printed_mean_and_amplitude():
    for row in published()["table9"]["rows"]:
        low = (row["mean"] + 0.005 + row["amplitude"] - 0.005) / (row["mean"] + 0.005)
        high = (row["mean"] - 0.005 + row["amplitude"] + 0.005) / (row["mean"] - 0.005)
        assert round(low, 3) <= row["load_factor"] <= round(high, 3)


def test_speeds_stand_beside_print(tables):
    ring = row_of(tables["table7"], "LSP: ring")
    assert ring["Speed simulated [r/min]"] == pytest.approx(1.6 * 30.0 / math.pi)
    assert ring["Speed difference [r/min]"] == pytest.approx(1.6 * 30.0 / math.pi - 15.0)
    planets = row_of(tables["table7"], "LSP: planet")
    assert planets["Speed simulated [r/min]"] == pytest.approx(3.8 * 30.0 / math.pi)


def test_the_hsp_planet_turns_relative_to_its_carrier(tables):
    planet = row_of(tables["table7"], "HSP: planet")
    relative = SPEEDS["hsp.planet.1"] - SPEEDS["hsp.carrier"]
    assert planet["Speed simulated [r/min]"] == pytest.approx(relative * 30.0 / math.pi)
    assert planet["Mesh frequency simulated [Hz]"] == pytest.approx(HSP)
    assert planet["Mesh frequency difference [Hz]"] == pytest.approx(HSP - 158.2)


def force_row(table, place, component):
    return next(
        row
        for row in (dict(zip(table.columns, cells, strict=True)) for cells in table.rows)
        if row["Position"] == published()["table9"]["rows"][place]["position"] and row["Component"] == component
    )


@pytest.mark.parametrize(("component", "scale"), [("normal", 1.0), ("tangential", np.cos(ALPHA))])
def test_mesh_forces_stand_beside_print(tables, component, scale):
    row = force_row(tables["table9"], 0, component)
    assert row["Mean simulated [1e5 N]"] == pytest.approx(3.5 * scale, rel=1e-4)
    assert row["Amplitude simulated [1e5 N]"] == pytest.approx(0.5 * scale, rel=1e-3)
    assert row["Load factor simulated"] == pytest.approx(4.0 / 3.5, rel=1e-3)
    assert (row["Mean printed [1e5 N]"], row["Amplitude printed [1e5 N]"]) == (3.34, 0.39)
    assert row["Load factor printed"] == 1.118
    assert row["Service load Table 4 [1e5 N]"] == 3.55


def test_each_row_says_which_component_is_nearer_to_print(tables):
    nearer = {
        place: [force_row(tables["table9"], place, word)["Nearer to print"] for word in ("normal", "tangential")]
        for place in (0, 1)
    }
    # 3.5 and 3.5 cos 20 = 3.29 beside 3.34; 3.6 and 3.38 beside 3.55.
    assert nearer == {0: ["no", "yes"], 1: ["yes", "no"]}


def test_the_other_flank_counts_by_magnitude(tables):
    row = force_row(tables["table9"], 4, "normal")
    assert row["Mean simulated [1e5 N]"] == pytest.approx(1.2, rel=1e-4)
    assert row["Load factor worst mesh"] == pytest.approx(1.25, rel=1e-3)


def test_without_a_pressure_angle_only_the_normal_force_is_given():
    table = compare(make_dataset())["table9"]
    assert table.column("Component") == ("normal",) * 5
    assert set(table.column("Nearer to print")) == {None}
    assert any("no pressure angle" in note for note in table.notes)


def test_lines_are_named_and_ordered_by_strength(tables):
    lines = row_of(tables["table8"], "Front chassis")["Our lines [Hz] (name) amplitude"].split("\n")
    assert lines == ["316.0 (2 x hsp) 1.3", "29.5 (1 x lsp) 0.5", "114.0 (?) 0.2"]
    ring_gear = row_of(tables["table8"], "HSP:ring gear")
    assert ring_gear["Our signal"] == "acceleration of hsp.carrier [m/s^2]"
    assert ring_gear["Our lines [Hz] (name) amplitude"].split("\n") == [
        "474.0 (3 x hsp) 2",
        "128.5 (hsp - 1 x lsp) 1",
    ]
    assert ring_gear["Measured [Hz]"] == "62.5, 312.5, 479.1, 625"


def test_lines_above_the_printed_range_stay_out(tables):
    output = row_of(tables["table8"], "Output shaft")["Our lines [Hz] (name) amplitude"]
    assert output.split("\n") == ["628.0 (1 x psh) 10", "470.0 (psh - 1 x hsp) 0.5"]


def test_every_member_of_a_position_has_a_row(tables):
    signals = tables["table8"].column("Our signal")
    assert [signal.split()[2] for signal in signals] == [
        "lsp.ring", "hsp.carrier", "psh.output", "psh.input", "hsp.sun", "psh.output",
    ]  # fmt: skip


def test_a_bearing_stands_in_for_a_member_without_acceleration(dataset):
    bare = dataset.drop_vars(["acceleration_x", "acceleration_y"])
    signal, unit, frequency, amplitude = position_spectrum(bare, "lsp.ring", STEADY)
    assert (signal, unit) == ("bearing force of lsp.ring", "N")
    assert frequency[0] == 0.0
    assert amplitude[0] == pytest.approx(5.0)
    assert position_spectrum(bare, "psh.output", STEADY) is None


def test_another_scene_keeps_the_printed_half(dataset):
    tables = compare(dataset[["time"]])
    assert set(tables["table7"].column("Speed simulated [r/min]")) == {None}
    assert tables["table9"].column("Mean printed [1e5 N]") == (3.34, 3.55, 0.97, 0.98, 1.09)
    assert "not simulated" in tables["table8"].rows[0][4]


def test_tables_convert_to_json_and_print(tables):
    for table in tables.values():
        assert json.loads(json.dumps(table.to_json(), allow_nan=False))["columns"] == list(table.columns)
        console = Console(width=240, record=True, file=open("/dev/null", "w"))  # noqa: SIM115, PTH123
        table.print(console)
        console.file.close()
        text = console.export_text()
        assert table.rows[0][0] in text
        assert "Hz]" in text or "1e5 N]" in text


def test_a_table_refuses_ragged_rows_and_hides_nan():
    with pytest.raises(ValueError, match="row 2 of 'T'"):
        Table("T", ("a", "b"), ((1, 2), (1,)))
    assert Table("T", ("a",), ((float("nan"),),)).to_json()["rows"] == [[None]]
    with pytest.raises(ValueError, match="no column 'c'"):
        Table("T", ("a", "b"), ()).column("c")
