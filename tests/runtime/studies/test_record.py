"""Records of what accuracy costs: written and read, the cheapest setting, settings chosen, tables and figures."""

import csv
import json

import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.studies.accuracy.cheapest import find_cheapest
from ltcgear.runtime.studies.accuracy.phases import sum_phases
from ltcgear.runtime.studies.accuracy.record import digest_numbers, keep, kept_path, read_record, write_record
from ltcgear.runtime.studies.accuracy.selection import read_percentage, select_setting
from ltcgear.runtime.view.figures.accuracy_figures import PANELS, draw_all
from ltcgear.runtime.view.tables.accuracy_tables import make_tables
from ltcgear.symbolic.scene.load import load_scene

from records import gap, make_record


def setting_of(record, limit):
    found = find_cheapest(record, limit)
    return None if found is None else (found["method"], found["rtol"])


def test_the_cheapest_is_the_fastest_that_meets_the_error():
    record = make_record()
    assert [(entry["method"], entry["rtol"]) for entry in record["best"]] == [
        ("erk", 1e-3), ("cvodes", 1e-5), ("cvodes", 1e-5), ("erk", 1e-7),
    ]  # fmt: skip
    assert [entry["seconds"] for entry in record["best"]] == [1.0, 1.5, 1.5, 4.0]
    assert record["best"][1]["found"] == 2e-4
    assert record["best"][1]["real_time_factor"] == pytest.approx(1 / 3)


def test_an_error_counts_with_the_references_own():
    record = make_record()
    assert setting_of(record, 1.2e-8) == ("erk", 1e-9)
    assert setting_of(record, 1.05e-8) is None
    assert setting_of(record, 1e-4) == ("erk", 1e-7)  # cvodes has 1e-4 itself
    assert setting_of(record, 1.001e-4) == ("cvodes", 1e-7)


def test_without_reference_nothing_is_the_cheapest():
    record = make_record()
    record["reference"] |= {"reason": "the runs part"}
    assert setting_of(record, 0.1) is None


# --- files


def test_a_record_comes_back_as_it_was(tmp_path):
    record = make_record()
    files = write_record(record, tmp_path)
    assert [file.name for file in files] == ["accuracy.json", "accuracy.csv"]
    assert read_record(files[0]) == record
    rows = list(csv.DictReader(files[1].read_text("utf-8").splitlines()))
    assert len(rows) == len(record["points"])
    for row, wanted in zip(rows, record["points"], strict=True):
        assert (row["method"], float(row["rtol"]), row["reason"]) == (
            wanted["method"], wanted["rtol"], wanted["reason"] or "",
        )  # fmt: skip
    assert float(rows[1]["mesh_force"]) == 5e-4
    assert [float(rows[1][name]) for name in ("seconds", "median", "user", "rhs")] == [2.0, 2.2, 4.0, 60]
    assert rows[1]["load_share"] == rows[-1]["seconds"] == ""


def test_the_store_keeps_a_record_by_model_and_numbers(tmp_path, monkeypatch):
    monkeypatch.setenv("LTCGEAR_CACHE", str(tmp_path))
    record = make_record(model="model of this test")
    path = kept_path(record["model"], record["numbers"])
    assert not path.exists()
    assert keep(record) == path
    assert read_record(path) == record
    assert kept_path(record["model"], "others") != path != kept_path("another", record["numbers"])


def test_numbers_are_told_by_what_a_scene_gives():
    def key(*changes):
        return digest_numbers(load_scene("psh", dict(changes)).model_dump_json(exclude_none=True))

    stiffness = "stages.psh.input.bearing.stiffness"
    assert key() == key(("title", "another"), ("simulation.t_end", "3 s"))
    assert key((stiffness, "1e9 N/m")) == key((stiffness, "1 kN/um")) == key((stiffness, "1000 N/mm^2*m"))
    assert len({key(), key((stiffness, "1e9 N/m")), key((stiffness, "1.000000000000001e9 N/m"))}) == 3


def without(*path):
    """Change a record in one place."""
    *inner, last, value = path

    def change(record):
        place = record
        for key in inner:
            place = place[key]
        place[last] = value
        return record

    return change


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda record: [], '"format" is not 1'),
        (without("format", 2), '"format" is not 1'),
        (without("model", 3), '"model" is not text'),
        (without("t_end", "long"), '"t_end" is not a number'),
        (without("points", {}), '"reference" or "points" is missing'),
        (without("reference", None), '"reference" or "points" is missing'),
        (without("reference", "reason", "the runs part"), "it has no reference: the runs part"),
        (without("reference", "measure", "luck"), "no measure"),
        (without("reference", "floor", True), "no floor"),
        (without("reference", "floor", -1.0), "no floor"),
        (without("points", 1, "erk"), "number 2: not a table"),
        (without("points", 1, "method", "__import__('os')"), 'number 2: "method" is not known'),
        (without("points", 2, "rtol", "1e-3"), "number 3"),
        (without("points", 2, "seconds", 0), "not a number above zero"),
        (without("points", 2, "seconds", float("nan")), "not a number above zero"),
        (without("points", 2, "errors", []), "has no value of mesh_force"),
        (without("points", 2, "errors", {"mesh_force": {"value": None}}), "has no value of mesh_force"),
        (without("points", 2, "errors", {}), "has no value of mesh_force"),
        (without("points", 2, "reason", 7), '"reason" is neither'),
    ],
)
def test_a_file_that_is_no_record_is_refused(tmp_path, change, reason):
    path = tmp_path / "accuracy.json"
    path.write_text(json.dumps(change(json.loads(json.dumps(make_record())))), "utf-8")
    with pytest.raises(LtcgearError) as refused:
        read_record(path)
    assert reason in str(refused.value)
    assert str(path) in str(refused.value)
    assert "`ltcgear accuracy" in str(refused.value)


@pytest.mark.parametrize(
    ("data", "reason"),
    [(b"{", "not a record"), (b"\xff\xfe", "not a record"), (b"[" * 100_000, "not a record"), (None, "no such record")],
)
def test_a_file_that_cannot_be_read_is_refused(tmp_path, data, reason):
    path = tmp_path / "accuracy.json"
    if data is not None:
        path.write_bytes(data)
    with pytest.raises(LtcgearError, match=reason):
        read_record(path)
    with pytest.raises(LtcgearError, match="cannot be read"):
        read_record(tmp_path)


# --- settings


@pytest.mark.parametrize(("text", "value"), [("0.1%", 1e-3), (" 10 % ", 0.1), ("1e-2%", 1e-4), (".5%", 5e-3)])
def test_percentages(text, value):
    assert read_percentage(text) == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("0%", "above 0 %"), ("100%", "below 100 %"), ("200%", "below 100 %"), ("abc", "write a percentage"),
        ("0.1", "write a percentage"), ("-1%", "write a percentage"), ("nan%", "write a percentage"), ("", "write a"),
        ("1e999%", "below 100 %"), ("1e-999%", "above 0 %"), ("0.1%%", "write a percentage"),
    ],
)  # fmt: skip
def test_what_is_no_percentage_is_refused(text, reason):
    with pytest.raises(LtcgearError, match=reason):
        read_percentage(text)


def test_a_setting_tells_where_it_comes_from():
    setting = select_setting(make_record(), "accuracy.json", 1e-3, "m", "n")
    assert (setting.method, setting.rtol, setting.expected, setting.warning) == ("cvodes", 1e-5, 2e-4, None)
    assert "2.0e-04 over 0.5 s" in setting.why
    assert "accuracy.json" in setting.why
    assert setting.to_json()["asked"] == 1e-3


def test_a_record_of_another_model_is_refused():
    with pytest.raises(LtcgearError, match="of another model"):
        select_setting(make_record(), "accuracy.json", 1e-3, "another", "n")
    other = select_setting(make_record(), "accuracy.json", 1e-3, "m", "others")
    assert "other numbers" in other.warning


def test_an_error_that_no_setting_meets_is_refused():
    told = r"smallest error there is 1.1e-08; ask for --accuracy 1.11e-06%, or run .*--preset full"
    with pytest.raises(LtcgearError, match=told):
        select_setting(make_record(), "accuracy.json", 1e-9, "m", "n")
    empty = make_record(points=[gap("erk", 1e-3, "no")])
    with pytest.raises(LtcgearError, match="no setting"):
        select_setting(empty, "accuracy.json", 0.1, "m", "n")


# --- tables and figures


def test_tables_tell_all(capsys):
    record = make_record()
    for table in make_tables(record):
        table.print()
    shown = " ".join(capsys.readouterr().out.split())
    for text in (
        "Accuracy of made over 0.5 s", "1.0e-9 *", "cvodes at rtol 1.0e-9: more than 3 s", "uncertain by 1.0e-9",
        "Least of 7 runs.", "0.01 % erk 1.0e-7 1.0e-5", "from nothing", "takes 100 ns",
    ):  # fmt: skip
        assert text in shown
    record["reference"] |= {"reason": "the runs part", "failures": ["idas at rtol 1e-13: too slow"]}
    notes = make_tables(record)[0].notes
    assert "No errors: the runs part" in notes
    assert "idas at rtol 1e-13: too slow" in notes


def test_figures_are_drawn(tmp_path):
    paths = draw_all(make_record(), tmp_path)
    assert [path.stem for path in paths] == [*PANELS, "overview"]
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in paths)
    bare = make_record(points=[gap("erk", 1e-3, "no")], phases=None, measure=None)
    bare["reference"] |= {"reason": "nothing moves", "measure": None, "floor": None}
    assert len(draw_all(bare, tmp_path, ".svg")) == len(paths)


def test_phases_add_up():
    seconds = {"load": 1.0, "derive": 2.0, "compile": 4.0, "prepare": 8.0, "integrate": 16.0, "write": 32.0, "x": 5.0}
    found = sum_phases(seconds, 100.0)
    assert (found["derive"], found["compile"], found["integrate"], found["write"]) == (3.0, 12.0, 16.0, 32.0)
    assert found["check"] == 0.0
    assert found["start"] == 100.0 - 63.0
    assert found["total"] == 100.0
