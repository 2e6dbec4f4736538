"""The involute law is the textbook's, wherever the line of centres points."""

import casadi as ca
import numpy as np
import pytest
from ltcgear.symbolic.elements.element_types import make
from ltcgear.symbolic.elements.key import ElementKey
from ltcgear.symbolic.mechanics.lower import element_function

SIZES = {"external": (1, 0.11, 0.27, 0.4), "internal": (-1, 0.27, 0.11, 0.17)}
"""The sign sigma, both base radii and the nominal centre distance [m]."""


def involute(alpha):
    return np.tan(alpha) - alpha


@pytest.mark.parametrize("kind", ["external", "internal"])
@pytest.mark.parametrize("flank", [1.0, -1.0])
def test_the_deflection_is_that_of_involutes(kind, flank):
    element = ElementKey.of("mesh", kind=kind, law="involute", switched=False, damped=False)
    function = element_function(element, "newton")
    names = [symbol.name for symbol in make(element).arguments]
    sigma, one, two, nominal = SIZES[kind]
    c = one + sigma * two
    alpha_0 = np.arccos(c / nominal)
    rng = np.random.default_rng(8)
    for direction in rng.uniform(-np.pi, np.pi, 40):
        turned, away = rng.uniform(-2.1, 2.1), nominal * rng.uniform(0.99, 1.2)
        angles = rng.uniform(-0.1, 0.1, 2)
        given = dict.fromkeys(names, 0.0) | {
            "x_1": 0.3, "y_1": -0.7, "theta_1": angles[0], "theta_2": angles[1], "r_1": one, "r_2": two, "k": 1e8,
            "x_2": 0.3 + away * np.cos(direction + turned), "y_2": -0.7 + away * np.sin(direction + turned),
            "s": flank, "e_x": np.cos(direction), "e_y": np.sin(direction), "inv_0": involute(alpha_0),
        }  # fmt: skip
        result = function(**{name: ca.DM(given[name]) for name in names})
        alpha = np.arccos(c / away)
        rolled = one * (angles[0] - turned) + sigma * two * (angles[1] - turned)
        wanted = flank * rolled - sigma * c * (involute(alpha) - involute(alpha_0))
        assert float(result["out_deflection"]) == pytest.approx(wanted, abs=1e-14)
        assert float(result["out_pressure_angle"]) == pytest.approx(alpha, abs=1e-13)
        assert float(result["out_rolling"]) == pytest.approx(angles[0] - turned, abs=1e-14)
