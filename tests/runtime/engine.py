"""The march's C, function by function."""

import ctypes

import numpy as np
from ltcgear.runtime.model.cstruct import engine


def _pointer(array):
    return ctypes.c_void_p(array.ctypes.data)


def _rows(phases):
    return np.concatenate([phases.tau, phases.rate, phases.share]).astype(float)


def time_to_border(cells, phases, gain=0.0):
    """The time to the next border of some cells."""
    run = engine().ltcgear_time_to_border
    run.restype = ctypes.c_double
    run.argtypes = [ctypes.c_longlong, *3 * [ctypes.c_void_p]]
    cells, rows = np.array(cells, np.int64), _rows(phases)
    gain = np.broadcast_to(np.asarray(gain, float), cells.shape).copy()
    return run(len(cells), _pointer(cells), _pointer(rows), _pointer(gain))


def crossed(cells, before, after):
    """The cells after a step, and the part of it before the first border."""
    run = engine().ltcgear_crossed
    run.restype = ctypes.c_double
    run.argtypes = [ctypes.c_longlong, *4 * [ctypes.c_void_p]]
    cells, rows, ends = np.array(cells, np.int64), _rows(before), _rows(after)
    changed = np.zeros_like(cells)
    part = run(len(cells), _pointer(cells), _pointer(rows), _pointer(ends), _pointer(changed))
    return changed, part
