"""The tableau of the explicit method, read from its C."""

import re

import numpy as np
from ltcgear.runtime.model.cstruct import source


def array(name):
    """One of the C's arrays, rows filled up with zeros."""
    text = re.search(rf"static const double {name}\[[^=]*= \{{(.*?)\}};", source(), re.DOTALL).group(1)
    rows = re.findall(r"\{([^{}]*)\}", text) or [text]
    values = [[float(number) for number in row.replace("\n", " ").split(",") if number.strip()] for row in rows]
    widest = max(map(len, values))
    return np.squeeze(np.array([row + [0.0] * (widest - len(row)) for row in values]))


def growth():
    """The coefficients of a mode's growth in a step."""
    weights, inner = array("WEIGHT"), np.zeros((7, 7))
    inner[:, :6] = array("A")
    found, vector = [1.0], np.ones(7)
    for _ in range(6):
        found.append(weights @ vector)
        vector = inner @ vector
    return found
