"""Tables of pairs: inline and from CSV, in SI, there and back, and everything that is no such table."""

import json
import math
from typing import Annotated

import pytest
from ltcgear.symbolic.schema.quantities import SceneTable
from ltcgear.symbolic.schema.series import LARGEST_FILE, MOST_ROWS, MOST_TOLD, Pairs, Series
from pydantic import ValidationError


class Gust(SceneTable):
    torque: Annotated[Pairs, Series("s", "N*m")]


class Curve(SceneTable):
    share: Annotated[Pairs, Series("", "m")]


def read(torque, folder=None):
    return Gust.model_validate({"torque": torque}, context=None if folder is None else {"folder": folder}).torque


def refusal(value, folder=None, table=Gust, key="torque"):
    with pytest.raises(ValidationError) as caught:
        table.model_validate({key: value}, context={"folder": folder})
    (error,) = caught.value.errors()
    assert error["type"] == "value_error"
    return str(error["ctx"]["error"])


@pytest.fixture
def written(tmp_path):
    def write(text, name="gust.csv"):
        (tmp_path / name).write_bytes(text if isinstance(text, bytes) else text.encode())
        return tmp_path

    return write


# --- what is read


def test_pairs_are_kept_in_si():
    assert read([["-0.5 s", "0 N*m"], ["1 min", "1.5 MN*m"]]) == ((-0.5, 0.0), (60.0, 1.5e6))


def test_a_file_is_read_in_the_units_of_its_header(written):
    folder = written("time [min],torque at the rotor [kN*m]\n0,-1\n0.5,2.5e1\n1,.5\n")
    assert read("gust.csv", folder) == ((0.0, -1000.0), (30.0, 25000.0), (60.0, 500.0))


def test_a_file_as_other_programs_write_it(written):
    text = b'\xef\xbb\xbf"time [s]" , "torque [N*m]"\r\n\r\n 0 ,"1"\r\n2,3\r\n\r\n'
    folder = written(text.replace(b'" , "', b'","'))
    assert read("gust.csv", folder) == ((0.0, 1.0), (2.0, 3.0))


def test_a_file_is_looked_up_beside_the_scene_or_where_it_says(written, tmp_path, monkeypatch):
    folder = written("t [s],T [N*m]\n0,0\n1,1\n")
    assert read(str(folder / "gust.csv"), tmp_path / "elsewhere") == ((0.0, 0.0), (1.0, 1.0))
    monkeypatch.chdir(folder)
    assert read("gust.csv") == ((0.0, 0.0), (1.0, 1.0))
    assert "no such file" in refusal("gust.csv", tmp_path / "elsewhere")


@pytest.mark.parametrize("unit", ["", "1", "-", " "])
def test_a_plain_number_needs_no_unit(written, unit):
    wanted = ((0.0, 0.001), (1.0, 0.002))
    assert Curve.model_validate({"share": [[0, "1 mm"], ["1", "2 mm"]]}).share == wanted
    context = {"folder": written(f"share [{unit}],height [mm]\n0,1\n1,2\n")}
    assert Curve.model_validate({"share": "gust.csv"}, context=context).share == wanted


def test_a_share_in_percent_is_a_plain_number(written):
    context = {"folder": written("share [%],height [mm]\n0,1\n50,2\n")}
    assert Curve.model_validate({"share": "gust.csv"}, context=context).share[1] == (0.5, 0.002)


@pytest.mark.parametrize("table", [Gust(torque=[["0.1 s", "7 N*m"], ["33 ms", "0 N*m"]][::-1]), None])
def test_it_comes_back_bit_for_bit(table):
    numbers = [(math.pi * 0.1**k, (-1) ** k * math.e * 10.0 ** (k - 11)) for k in range(20, -1, -1)]
    table = table or Gust(torque=[[f"{a!r} s", f"{b!r} N*m"] for a, b in numbers])
    assert Gust.model_validate_json(table.model_dump_json()) == table
    assert json.loads(table.model_dump_json())["torque"][0][0].endswith(" s")
    curve = Curve(share=[[0.1, "1 m"], [1 / 3, "2 m"]])
    assert Curve.model_validate_json(curve.model_dump_json()) == curve


def test_the_longest_table_is_read(written):
    lines = "\n".join(f"{i},{i % 7}" for i in range(MOST_ROWS))
    assert len(read("gust.csv", written(f"t [s],T [N*m]\n{lines}\n"))) == MOST_ROWS


# --- what is refused


@pytest.mark.parametrize(
    ("value", "parts"),
    [
        (3.0, ("must be a list of pairs or the name of a CSV file, not 3.0", '["0 s", "0 N*m"]')),
        ({"a": 1}, ("must be a list of pairs",)),
        ([], ("has 0 rows, must have 2",)),
        ([["0 s", "0 N*m"]], ("has 1 row, must have 2",)),
        ([["0 s", "0 N*m"], "1 s"], ("row 2: must have two columns, not '1 s'",)),
        ([["0 s", "0 N*m"], ["1 s"]], ("row 2: must have two columns, not ['1 s']",)),
        ([["0 s", "0 N*m", "1"], ["1 s", "1 N*m"]], ("row 1: must have two columns",)),
        ([["0 s", "0 N*m"], ["1 s", 1.0]], ("row 2: 1.0 has no unit", "write it like")),
        ([["0 s", "0 N*m"], ["1 m", "1 N*m"]], ("row 2: '1 m' has the wrong dimension",)),
        ([["0 s", "0 N*m"], ["1 s", "1 N*m/rad"]], ("row 2:", "wrong dimension")),
        ([["0 s", "0 N*m"], ["1 s", "nan N*m"]], ("row 2: 'nan N*m' is not a number",)),
        ([["0 s", "0 N*m"], ["inf s", "1 N*m"]], ("row 2: 'inf s' is not a number",)),
        ([["0 s", "0 N*m"], ["1e999 s", "1 N*m"]], ("row 2:", "out of all bounds")),
        ([["0 s", "0 N*m"], ["0 s", "1 N*m"]], ("row 2: the first column must ascend, but 0 follows 0", "sort")),
        ([["0 s", "0 N*m"], ["2 s", "1 N*m"], ["1 s", "1 N*m"]], ("row 3: the first column must ascend",)),
        ([["0 s", "__import__('os') N*m"], ["1 s", "0 N*m"]], ("row 1:", "is not a number with a unit")),
        ([["0 s", "0 N*m"]] * (MOST_ROWS + 1), (f"has {MOST_ROWS + 1} rows", str(MOST_ROWS))),
    ],
    ids=lambda value: repr(value)[:40],
)
def test_a_table_that_is_none_is_refused(value, parts):
    told = refusal(value)
    assert all(part in told for part in parts), told
    assert len(told) < 300


HEADER = "time [s],torque [N*m]\n"


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("", ("'gust.csv': the header must name two columns", 'like "first [s],second [N*m]"')),
        ("0,0\n1,1\n", ("the header must name two columns with their units in brackets",)),
        ("time,torque\n0,0\n1,1\n", ("the header must name",)),
        ("[s],[N*m]\n0,0\n1,1\n", ("the header must name",)),
        ("time [s];torque [N*m]\n0;0\n1;1\n", ("the header must name",)),
        ("time [s],torque [N*m],rest [m]\n0,0,0\n1,1,1\n", ("the header must name",)),
        ("time [s],torque [kg]\n0,0\n1,1\n", ("a column is in [kg], where a unit of N*m is due",)),
        ("time [Hz],torque [N*m]\n0,0\n1,1\n", ("a column is in [Hz], where a unit of s is due",)),
        ("time [],torque [N*m]\n0,0\n1,1\n", ("a column is in [], where a unit of s is due",)),
        (HEADER, ("has 0 rows, must have 2",)),
        (HEADER + "0,0\n", ("has 1 row, must have 2",)),
        (HEADER + "0,0\n\n1\n", ("'gust.csv' line 4: must have two columns",)),
        (HEADER + "0,0\n1,2,3\n", ("'gust.csv' line 3: must have two columns",)),
        (HEADER + "0,0\n1,5\n2,\n", ("'gust.csv' line 4: '' is not a plain number",)),
        (HEADER + "0,0\n1,5 kN*m\n", ("line 3: '5 kN*m' is not a plain number",)),
        (HEADER + "0,0\n1,nan\n", ("line 3: 'nan' is not a plain number",)),
        (HEADER + "0,0\ninf,1\n", ("line 3: 'inf' is not a plain number",)),
        (HEADER + "0,0\n1,1e999\n", ("line 3:", "out of all bounds")),
        (HEADER + "0,0\n1,2**3\n", ("line 3: '2**3' is not a plain number",)),
        (HEADER + "0,0\n1,1_000\n", ("line 3: '1_000' is not a plain number",)),
        (HEADER + "0,0\n1,1\n1,2\n", ("line 4: the first column must ascend, but 1 follows 1",)),
        (HEADER + '0,0\n1,"1\n', ("is not CSV",)),
        (HEADER.encode() + b"0,\xff\n", ("is not text in UTF-8",)),
        (HEADER + "0,0\n" * (MOST_ROWS + 1), (f"has {MOST_ROWS + 1} rows",)),
        (HEADER + " " * LARGEST_FILE, ("above 10 MB",)),
    ],
    ids=lambda value: repr(value)[:40],
)
def test_a_file_that_is_no_table_is_refused(written, text, parts):
    told = refusal("gust.csv", written(text))
    assert all(part in told for part in parts), told
    assert len(told) < 300


def test_a_file_that_cannot_be_read_is_refused(tmp_path):
    (tmp_path / "folder.csv").mkdir()
    assert "'folder.csv': is a folder" in refusal("folder.csv", tmp_path)
    assert "'gone.csv': no such file; give the name of a CSV file" in refusal("gone.csv", tmp_path)
    assert "cannot be read" in refusal("x" * 5000, tmp_path)
    assert "no such file" in refusal("nul\0byte", tmp_path)
    assert "no such file" in refusal("1.5 kN*m", tmp_path)
    assert "'/dev/zero': is a device" in refusal("/dev/zero", tmp_path)


def test_the_faults_of_many_rows_are_counted(written):
    told = refusal("gust.csv", written(HEADER + "x,0\n" * 30)).split("\n")
    assert len(told) == MOST_TOLD + 1
    assert told[-1] == "and 25 rows more with faults"


@pytest.mark.parametrize("value", [True, None, "half", "0.5 m", math.nan, math.inf, "1e31"])
def test_no_plain_number(value):
    told = refusal([["0", "0 m"], [value, "1 m"]], table=Curve, key="share")
    assert told.startswith("row 2: ")
