"""What runs of a sweep are warned about reaches its file, its summary, its tables and its figures."""

import numpy as np
import pytest
import xarray as xr
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime import build, load_sweep, simulate, sweep
from ltcgear.runtime.results.row_file import part_of
from ltcgear.runtime.studies.sweep import sweep_file
from ltcgear.runtime.studies.sweep.design import draw_design
from ltcgear.runtime.studies.sweep.summary import gather_warnings, summarise
from ltcgear.runtime.studies.sweep.sweep_axes import read_axes
from ltcgear.runtime.view.figures.sweep_figures import draw_sweep
from ltcgear.runtime.view.tables.sweep_tables import list_tables
from ltcgear.symbolic import Template

from ..sweeps import as_sweep

ERRORS = "stages.lsp.position_errors"
MISPLACED = {
    "effects.planet_position_error": "on",
    ERRORS: "[{planet=1}]",
    f"{ERRORS}.0.tangential": "200 um",
}
"""A pin so far out of place that half of the planets pull where there is little load."""
LOADS = ["loads.sun.torque=100 N*m,2e4 N*m,2e5 N*m"]


@pytest.fixture(scope="module")
def pulling(tmp_path_factory):
    """A sweep two of whose runs are warned about."""
    target = tmp_path_factory.mktemp("pulling") / "a.nc"
    return sweep(Template("lsp", MISPLACED), LOADS, target, t_end=0.02, workers=2), target


def test_warnings_of_runs_are_in_the_file(pulling):
    summary, target = pulling
    template, found = Template("lsp", MISPLACED), load_sweep(target)
    assert found["status"].values.tolist() == ["done"] * 3
    for point, torque in enumerate(LOADS[0].split("=")[1].split(",")):
        changes = {"loads.sun.torque": torque}
        _, values, tables = template.make(changes)
        options = {"t_end": 0.02, "rate": float(found.attrs["rate"]), "tables": tables}
        told = simulate(build(template.obtain(changes)), values, **options).summary["warnings"]
        assert str(found["warnings"].values[point]).splitlines() == told
    assert "lsp.sun_planet.1: pulls with up to" in str(found["warnings"].values[0])
    assert summary["warned"] == 2
    assert [number for text, number in summary["warnings"].items() if "pulls with up to" in text] == [2, 2]


def test_tables_and_figures_mark_what_is_warned_about(pulling):
    found = load_sweep(pulling[1])
    table = next(table for table in list_tables(found) if table.title.startswith("load_factor"))
    assert [row[-1] for row in table.rows] == ["!", "!", ""]
    assert "2 of 3 runs are warned about: see `warnings`" in table.notes
    figure = draw_sweep(found)["load_factor"]
    marked = [line for axes in figure.axes for line in axes.lines if line.get_gid() == "warnings"]
    assert marked
    assert {len(line.get_xdata()) for line in marked} == {2}
    assert "2 of 3 runs are warned about" in figure._supxlabel.get_text()


def test_a_balance_that_is_open_is_told_by_the_command(tmp_path, run, data):
    command = ("sweep", "lsp", "--vary", "loads.ring.speed=10 rpm,30 rpm", "--rtol", "0.1", "--t-end", "0.02")
    command += ("--workers", "1", "-o", tmp_path / "a.nc")
    code, out, err = run(*command)
    assert (code, err) == (0, "")
    assert "warned, 1 of 2: the energy balance is open by" in out
    assert f"2 points computed; 0 failed, 1 warned; {tmp_path / 'a.nc'}" in out
    shown = data(*command)
    assert shown["warned"] == 1
    assert list(shown["warnings"].values()) == [1]


def test_a_stopped_sweep_keeps_the_warnings_it_has(tmp_path, pulling):
    def stop(stage, done, total, failed):
        if done == 2:
            raise KeyboardInterrupt

    target = tmp_path / "a.nc"
    with pytest.raises(KeyboardInterrupt):
        sweep(Template("lsp", MISPLACED), LOADS, target, t_end=0.02, workers=1, told=stop)
    kept = load_sweep(part_of(target))
    assert summarise(kept)["warned"] == 2
    sweep(Template("lsp", MISPLACED), LOADS, target, t_end=0.02, workers=1)
    xr.testing.assert_identical(load_sweep(target), load_sweep(pulling[1]))


def design(text="stages.lsp.sun.mass=1 kg:4 kg:4"):
    return draw_design(read_axes([text]))


def test_warnings_that_differ_in_numbers_are_counted_together():
    told = [
        "lsp.1: pulls with up to 3e+04 N\nlsp.2: pulls with up to 5 N\nopen by 1.2e-02",
        "",
        "lsp.2: pulls with up to -7.5 N",
        "odd",
    ]
    found = as_sweep(design(), force=np.ones(4)).assign(warnings=("point", np.array(told, dtype=object)))
    assert gather_warnings(found) == {"lsp.1: pulls with up to 3e+04 N": 2, "open by 1.2e-02": 1, "odd": 1}


def test_maps_mark_the_cells_of_runs_that_are_warned_about():
    crossed = draw_design(read_axes(["b=1:2:2", "c=5 rpm", "a=10,20,30"]))
    told = ["", "", "odd", "", "odd", ""]
    found = as_sweep(crossed, force=np.arange(6.0)).assign(warnings=("point", np.array(told, dtype=object)))
    figure = draw_sweep(found)["force"]
    [line] = [line for axes in figure.axes for line in axes.lines if line.get_gid() == "warnings"]
    assert line.get_xydata().tolist() == [[1.0, 2.0], [2.0, 1.0]]  # a list stands at its places


def test_what_has_no_room_is_counted():
    lines = sweep_file._join([f"mesh {k}: {'x' * 90}" for k in range(20)]).decode().splitlines()
    assert lines[-1] == f"and {20 - len(lines) + 1} more warnings, for which the row has no room"
    assert 5 < len(lines) < 20
    assert sweep_file._join(["a"]) == b"a"
    assert sweep_file._join([]) == b""
    assert len(sweep_file._join(["y" * 5000, "z"])) <= sweep_file.TEXTS["warnings"]


def test_a_file_of_before_is_read_and_says_that_it_kept_no_warnings(tmp_path, pulling):
    old = load_sweep(pulling[1]).drop_vars("warnings")
    old.attrs["sweep_format"] = 1
    old.to_netcdf(tmp_path / "a.nc")
    found = load_sweep(tmp_path / "a.nc")
    assert summarise(found)["warned"] is None
    assert any("which kept no warnings" in note for table in list_tables(found) for note in table.notes)
    with pytest.raises(LtcgearError, match=r"of form 1, which is read but not gone on with .*give another -o"):
        sweep(Template("lsp", MISPLACED), LOADS, tmp_path / "a.nc", t_end=0.02, workers=1)
