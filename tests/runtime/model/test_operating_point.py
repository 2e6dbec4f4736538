"""Operating point and run settings: computed once, checked once, handed on."""

from dataclasses import replace

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.model import operating_point
from ltcgear.runtime.model.operating_point import OperatingPoint
from ltcgear.runtime.model.state_matrix import closed, state_matrix
from ltcgear.runtime.simulation.run_settings import RunSettings
from ltcgear.runtime.simulation.simulate import Run

from ..models import case


def test_the_fastest_motion_is_an_eigenvalue_of_the_closed_model():
    c = case("psh")
    point = OperatingPoint(c.library, c.p, c.at)
    values = np.linalg.eigvals(state_matrix(c.library, c.at.x, c.at.s, closed(c.library, c.p)))
    assert point.fastest == pytest.approx(np.abs(values).max(), rel=1e-9)
    assert point.fastest_body.split(" ")[0] in {state.body for state in c.library.manifest.states}
    assert (point.scale > 0).all()


def test_what_follows_is_computed_once_and_anew_at_another_point():
    c = case("psh")
    point = OperatingPoint(c.library, c.p, c.at)
    other = replace(point, at=replace(c.at, x=c.at.x + 1e-6))
    for name in ("scale", "spectrum", "stiffest_spectrum"):
        assert getattr(point, name) is getattr(point, name)
        assert getattr(other, name) is not getattr(point, name)


@pytest.mark.parametrize("method", ["auto", "erk", "rosenbrock"])
def test_a_run_takes_each_spectrum_once(monkeypatch, method):
    c, taken = case("lsp"), []
    monkeypatch.setattr(operating_point, "state_matrix", lambda *given: taken.append(given) or state_matrix(*given))
    run = Run(c.library, c.p, RunSettings(1.0, method=method))
    assert run.integration.march.point is run.point
    assert len(taken) == 3  # of the scale, and of both spectra


def test_settings_are_refused_in_one_place():
    assert RunSettings(1.0).checked() == RunSettings(1.0)
    for settings, message in (
        (RunSettings(1.0, rtol=1e-14), "rtol 1e-14: must lie between"),
        (RunSettings(0.0), "t_end 0: must be a time"),
        (RunSettings(1.0, rate=-1.0), "rate -1: must be a number of samples"),
        (RunSettings(1.0, rate=0.1), "shorter than one sample"),
        (RunSettings(1.0, method="rk4"), 'did you mean "erk"'),
    ):
        with pytest.raises(LtcgearError, match=message):
            settings.checked()
    with pytest.raises(LtcgearError, match="rate"):
        RunSettings(1.0).samples  # noqa: B018
