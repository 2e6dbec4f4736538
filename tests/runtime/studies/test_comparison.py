import io
import json
import math

import numpy as np
import pytest
from ltcgear.runtime.analysis.lines import find_clues
from ltcgear.runtime.results.statistics import window
from ltcgear.runtime.results.table import Table
from ltcgear.runtime.studies.wu2021.comparison import compare, position_spectrum, published
from rich.console import Console

from ..synthetic import ALPHA, HSP, PSH, SPEEDS, STEADY, make_dataset


@pytest.fixture(scope="module")
def dataset():
    return make_dataset(pressure_angle=True)


@pytest.fixture(scope="module")
def tables(dataset):
    return compare(dataset)


def row_of(table, position):
    return dict(zip(table.columns, next(row for row in table.rows if row[0] == position), strict=True))


def lines_of(table, *position):
    return row_of(table, "\n".join(position))["ours: Hz (name) amplitude"].split("\n")


def printed(table, width):
    console = Console(width=width, record=True, file=io.StringIO())
    table.print(console)
    return console.export_text()


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
    assert ring["r/min"] == pytest.approx(1.6 * 30.0 / math.pi)
    assert (ring["Teeth"], ring["printed r/min"], ring["printed mesh Hz"]) == (118, 15.0, 29.5)
    planets = row_of(tables["table7"], "LSP: planet")
    assert planets["r/min"] == pytest.approx(3.8 * 30.0 / math.pi)
    assert planets["printed r/min"] == 36.87
    # The other signs: magnitudes stand in the table.
    assert row_of(tables["table7"], "LSP: sun")["r/min"] == pytest.approx(8.4 * 30.0 / math.pi)
    assert row_of(tables["table7"], "PSH: input")["mesh Hz"] == pytest.approx(PSH)


def test_the_hsp_planet_turns_relative_to_its_carrier(tables):
    planet = row_of(tables["table7"], "HSP: planet")
    relative = SPEEDS["hsp.planet.1"] - SPEEDS["hsp.carrier"]
    assert planet["r/min"] == pytest.approx(relative * 30.0 / math.pi)
    assert planet["mesh Hz"] == pytest.approx(HSP)
    assert (planet["printed r/min"], planet["printed mesh Hz"]) == (189.84, 158.2)


def force_row(table, place, component):
    return next(
        row
        for row in (dict(zip(table.columns, cells, strict=True)) for cells in table.rows)
        if row["Position"] == published()["table9"]["rows"][place]["position"] and row["force"].rstrip("*") == component
    )


@pytest.mark.parametrize(("component", "scale"), [("normal", 1.0), ("tangent", np.cos(ALPHA))])
def test_mesh_forces_stand_beside_print(tables, component, scale):
    row = force_row(tables["table9"], 0, component)
    assert row["mean"] == pytest.approx(3.5 * scale, rel=1e-4)
    assert row["ampl."] == pytest.approx(0.5 * scale, rel=1e-3)
    assert row["factor"] == pytest.approx(4.0 / 3.5, rel=1e-3)
    assert (row["mean pr."], row["ampl. pr."], row["factor pr."]) == (3.34, 0.39, 1.118)
    assert tables["table9"].title.endswith("forces in 1e5 N")


def test_service_loads_are_noted(tables):
    loads = "lsp.sun_planet 3.55; lsp.ring_planet 3.55; hsp.sun_planet 1.04; hsp.ring_planet 1.03; psh.mesh 1.17."
    assert tables["table9"].notes[-1] == f"Service loads of Table 4 [1e5 N]: {loads}"


def test_each_row_says_which_component_is_nearer_to_print(tables):
    # 3.5 and 3.5 cos 20 = 3.29 beside 3.34; 3.6 and 3.38 beside 3.55; 1.0 and 0.94 beside 0.97;
    # 1.1 and 1.03 beside 0.98; 1.2 and 1.13 beside 1.09.
    assert tables["table9"].column("force") == (
        "normal", "tangent*", "normal*", "tangent", "normal*", "tangent", "normal", "tangent*", "normal", "tangent*",
    )  # fmt: skip
    assert [note for note in tables["table9"].notes if "*: the component that print is nearer to" in note]


def test_the_other_flank_counts_by_magnitude(tables):
    row = force_row(tables["table9"], 4, "normal")
    assert row["mean"] == pytest.approx(1.2, rel=1e-4)
    assert row["factor"] == pytest.approx(1.25, rel=1e-3)


def test_without_a_pressure_angle_only_the_normal_force_is_given():
    table = compare(make_dataset())["table9"]
    assert table.column("force") == ("normal",) * 5  # and no star: there is nothing to choose from
    assert any("no pressure angle" in note for note in table.notes)


def test_lines_are_named_and_ordered_by_strength(tables):
    lines = lines_of(tables["table8"], "Front chassis", "LSP: bearing", "ours: lsp.planet.1")
    assert lines == ["316.0 (2 hsp) 1.3", "29.5 (1 lsp) 0.5", "45.0 (?) 0.2"]
    place = ("HSP:ring gear", "HSP: ring gear", "ours: hsp.carrier")
    assert lines_of(tables["table8"], *place) == ["474.0 (3 hsp) 2", "128.5 (hsp - 1 lsp) 1"]
    ring_gear = row_of(tables["table8"], "\n".join(place))
    assert ring_gear["measured"].split("\n") == ["62.5", "312.5", "479.1", "625"]
    assert ring_gear["printed"].split("\n") == ["59.2", "316.5", "474.4", "628"]
    assert "amplitude of the acceleration [m/s^2], root-sum-square" in tables["table8"].notes[0]
    assert tables["table8"].notes[-1] == "Resolution of our spectra: 0.5 Hz."


def test_a_turn_of_the_carrier_beside_its_mesh_is_named(dataset, tables):
    # 158 Hz - 8.4 / 2 pi Hz = 156.66 Hz, on the grid of 0.5 Hz at 156.5 Hz.
    carriers = find_clues(window(dataset, STEADY)).carriers
    assert carriers == pytest.approx({"hsp.carrier": 8.4 / (2.0 * math.pi)})
    place = ("Back chassis", "PSH: input bearing &", "HSP: output bearing", "ours: hsp.sun")
    assert lines_of(tables["table8"], *place) == ["628.0 (1 psh) 5", "156.5 (hsp - 1 hsp.carrier) 1"]
    assert find_clues(window(dataset.drop_vars("speed"), STEADY)).carriers == {}
    still = compare(dataset.assign(speed=0.0 * dataset["speed"]))["table8"]
    assert lines_of(still, *place)[1] == "156.5 (?) 1"


def test_lines_above_the_printed_range_stay_out(tables):
    lines = lines_of(tables["table8"], "Output shaft", "ours: psh.output")
    assert lines == ["628.0 (1 psh) 10", "470.0 (psh - 1 hsp) 0.5"]


def test_rounding_makes_no_lines(dataset):
    """Accelerations of one member are weighed against those of all: 1e-9 of the largest is nothing."""
    faint = dataset.copy(deep=True)
    for axis in ("acceleration_x", "acceleration_y"):
        faint[axis].loc[{"member": "lsp.planet.1"}] *= 1e-12
    found = compare(faint)["table8"].column("ours: Hz (name) amplitude")
    assert found.count("none above rounding") == 1
    assert len(found) == 6


def test_every_member_of_a_position_has_a_row(tables):
    positions = [position.split("\n") for position in tables["table8"].column("Position")]
    assert [position[-1] for position in positions] == [
        f"ours: {member}"
        for member in ("lsp.planet.1", "hsp.carrier", "psh.output", "psh.input", "hsp.sun", "psh.output")
    ]
    assert [position[0] for position in positions] == [
        "Front chassis", "HSP:ring gear", "Output shaft", "Back chassis", "Back chassis", "Input of generator",
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
    assert set(tables["table7"].column("r/min")) == {None}
    assert tables["table7"].column("printed r/min") == (15, 36.87, 80.45, 189.84, 638.82, 638.82, 1794.75)
    assert tables["table9"].column("mean pr.") == (3.34, 3.55, 0.97, 0.98, 1.09)
    assert set(tables["table9"].column("mean")) == {None}
    assert set(tables["table9"].column("force")) == {"not simulated"}
    assert set(tables["table8"].column("ours: Hz (name) amplitude")) == {"not simulated"}
    assert tables["table8"].rows[0][1].split("\n") == ["62.5", "114.4", "156.3", "312.5", "625"]


def test_tables_convert_to_json_and_print(tables):
    for table in tables.values():
        assert json.loads(json.dumps(table.to_json(), allow_nan=False))["columns"] == list(table.columns)
        text = printed(table, 240)
        assert all(line in text for row in table.rows for line in row[0].split("\n"))
        assert all(heading in text for heading in table.columns)
        assert "Hz" in table.columns[-1] + table.columns[-2] or "1e5 N" in table.title
        assert "[Hz]" not in table.title + "".join(table.columns)  # nothing that rich could take for markup


def test_brackets_are_no_markup():
    text = printed(Table("Title [m/s^2]", ("a [bold]",), (("[red]a cell as wide as the title",),), ("note [Hz]",)), 80)
    assert all(part in text for part in ("Title [m/s^2]", "a [bold]", "[red]a cell", "note [Hz]"))


@pytest.mark.parametrize("width", [80, 240])
def test_no_line_and_no_number_is_broken(tables, width):
    lines = printed(tables["table8"], width).split("\n")
    assert max(len(line.rstrip()) for line in lines) <= width
    for row in tables["table8"].rows:
        assert all(any(line.rstrip().endswith(own) for line in lines) for own in row[-1].split("\n"))
    words = printed(tables["table9"], width).split()
    for number in ("tangent*", "3.289", "3.383", "1.034", "0.376", "1.143", "1.118", "1.349", "0.34"):
        assert number in words


def test_a_table_refuses_ragged_rows_and_hides_nan():
    with pytest.raises(ValueError, match="row 2 of 'T'"):
        Table("T", ("a", "b"), ((1, 2), (1,)))
    assert Table("T", ("a",), ((float("nan"),),)).to_json()["rows"] == [[None]]
    with pytest.raises(ValueError, match="no column 'c'"):
        Table("T", ("a", "b"), ()).column("c")


def test_a_table_stands_in_markdown_as_it_is_given():
    table = Table("T", ("a", "b [Hz]"), (("one", 0.5), ("two", None)), ("note",))
    assert table.to_markdown() == "| a | b [Hz] |\n|---|---|\n| one | 0.5 |\n| two | - |\n"
    assert table.numeric == (False, True)


def test_numbers_stand_on_the_right_also_where_they_are_written_out():
    rows = (("sun", "1.50", "+3 %", "-", "1.2e+09 given"), ("ring", "-12", "", None, "1e-3"))
    assert Table("t", tuple("abcde"), rows).numeric == (False, True, True, True, False)
    assert Table("t", ("a",), ()).numeric == (False,)
