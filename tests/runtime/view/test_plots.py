import subprocess
import sys

import numpy as np
import pytest
from ltcgear.runtime.view.plots import (
    _FORCES,
    _SPECTRA,
    _draw_forces,
    _draw_spectrum,
    make_canvas,
    overview_figure,
    paper_figures,
)

from ..synthetic import ALPHA, LSP, PSH, make_dataset


@pytest.fixture(scope="module")
def dataset():
    return make_dataset(pressure_angle=True)


def curves(axes):
    return {line.get_label(): line for line in axes.get_lines()}


def test_all_figures_are_written(dataset, tmp_path):
    paths = paper_figures(dataset, tmp_path / "new" / "folder")
    assert [path.name for path in paths] == [f"figure{number:02d}.png" for number in (9, 10, 11, 12, 13)]
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in paths)


def test_another_format(dataset, tmp_path):
    path = paper_figures(dataset, tmp_path, fmt="svg")[0]
    assert path.suffix == ".svg"
    assert "Front chassis" in path.read_text() or "<svg" in path.read_text()


def test_what_is_missing_is_left_out(dataset, tmp_path):
    planets = dataset.sel(mesh=[mesh for mesh in dataset["mesh"].values if mesh.startswith("lsp")])
    planets = planets.drop_vars(["acceleration_x", "acceleration_y", "bearing_force_x", "bearing_force_y"])
    assert [path.name for path in paper_figures(planets, tmp_path)] == ["figure11.png"]
    assert overview_figure(planets, tmp_path / "overview.png").exists()


def test_overview(dataset, tmp_path):
    assert overview_figure(dataset, tmp_path / "overview.png").stat().st_size > 10_000


def test_forces_are_tangential_and_span_six_periods(dataset):
    axes = make_canvas(9, 4).add_subplot()
    assert _draw_forces(axes, dataset, _FORCES[0])
    lines = curves(axes)
    assert list(lines) == ["planet 1", "planet 2", "planet 3", "planet 4", "printed mean"]
    assert [lines[f"planet {number}"].get_linestyle() for number in (1, 2, 3, 4)] == ["-", "-", "--", "--"]
    time, force = lines["planet 1"].get_data()
    assert time[-1] == pytest.approx(1e3 * 6 / LSP, abs=0.2)
    assert force.max() == pytest.approx(4.0 * np.cos(ALPHA), rel=1e-4)
    assert lines["printed mean"].get_ydata()[0] == 3.34
    assert "tangential" in axes.get_ylabel()
    assert len({line.get_color() for line in lines.values()}) == 5


def test_the_other_flank_is_drawn_positive():
    axes = make_canvas(9, 4).add_subplot()
    assert _draw_forces(axes, make_dataset(), _FORCES[2])
    time, force = curves(axes)["simulated"].get_data()
    assert time[-1] == pytest.approx(1e3 * 30 / PSH, abs=0.2)
    assert force.mean() == pytest.approx(1.2, rel=1e-2)
    assert "normal" in axes.get_ylabel()


def test_spectrum_shows_its_lines_and_the_printed_ones(dataset):
    axes = make_canvas(9, 4).add_subplot()
    assert _draw_spectrum(axes, dataset, _SPECTRA[0])
    frequency, amplitude = curves(axes)["simulated"].get_data()
    assert amplitude[frequency == 316.0] == pytest.approx(1.3)
    assert list(curves(axes)["paper, measured"].get_xdata()) == [62.5, 114.4, 156.3, 312.5, 625]
    assert {"1: 316.0 Hz = 2 hsp", "2: 29.5 Hz = 1 lsp", "3: 45.0 Hz"} <= set(curves(axes))
    assert list(curves(axes)["paper, simulated"].get_xdata()) == [59.2, 158.7, 316.2, 628.1]
    places = {text.get_text(): text.xy for text in axes.texts}
    assert places["1"] == pytest.approx((316.0, 1.3))


def test_importing_stays_light():
    heavy = "matplotlib scipy xarray sympy casadi"
    code = (
        "import sys, ltcgear.runtime.view.plots, ltcgear.runtime.studies.wu2021.comparison\n"
        "import ltcgear.runtime.results.table\n"
        "import ltcgear.runtime.view.figures.gallery, ltcgear.runtime.view.tables.analysis_tables\n"
        f"print([name for name in '{heavy}'.split() if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
