"""Order spectrum: an output over the revolutions of a shaft, sharp also while the speed varies."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

import numpy as np
from ltcgear.generated.errors import LtcgearError

from ..model.ties import largest_first
from ..results.amplitude_spectrum import amplitude_spectrum, noise_bandwidth
from ..results.select import split_output
from ..results.train_record import read_train
from .spectrum import Spectrum
from .trace import FloatArray, list_items, read_trace, tell_bounds

if TYPE_CHECKING:
    import xarray as xr

TURN = 2.0 * np.pi
MARGIN = 0.4
"""Share of the sampling rate up to which orders are given, at the highest speed of the span."""
DENSE = 2.0
"""Samples at equal angles over samples at equal times, at the lowest speed: images of interpolation stay outside."""
SLOWEST = 0.02
"""Lowest speed of a span over its highest."""
MOST = 2**23
"""Most samples at equal angles."""


def shaft_angle(dataset: xr.Dataset, rotor: str) -> xr.DataArray:
    """Return the absolute angle of a rotor [rad], whole turns included (see ``results.Result``).

    Raises
    ------
    LtcgearError
        If there is no such rotor, or it has no twist.
    """
    from ..results.result import Group

    try:
        return Group("rotor", dataset)[rotor].angle
    except (KeyError, AttributeError) as error:
        raise LtcgearError(f"--shaft {rotor}: {error.args[0]}") from error


def choose_shaft(dataset: xr.Dataset, stage: str = "") -> str | None:
    """Return the fastest rotor of a stage that is no planet, of all where the stage has none; None without rotors."""
    if "speed" not in dataset:
        return None
    speed = np.abs(dataset["speed"].transpose("time", "rotor").values).mean(axis=0)
    sizes = dict(zip(list_items(dataset, "speed"), speed.tolist(), strict=True))
    train = read_train(dataset)
    turning = {name: size for name, size in sizes.items() if not train.is_planet(name)} or sizes
    own = {name: size for name, size in turning.items() if train.stage(name) == stage} or turning
    return next(iter(largest_first(own)), None)


def find_order_spectrum(
    signal: xr.DataArray, angle: xr.DataArray, *, window: str = "hann", highest_hz: float = inf
) -> Spectrum:
    """Return the amplitude spectrum of an output over the turns of a shaft.

    The output is interpolated by a spline of degree 5 at equal angles of the shaft over a whole number of turns, so
    densely that nothing below half the sampling rate folds back at any speed of the span. Orders are given up to
    `MARGIN` of the sampling rate at the highest speed.

    Parameters
    ----------
    signal
        Output over time.
    angle
        Absolute angle of the shaft at the same instants [rad], unwrapped.
    window
        See ``find_spectrum``.
    highest_hz
        Frequency up to which samples are true, if that is lower.

    Raises
    ------
    LtcgearError
        If the shaft is at rest, turns back or is slower at some time than `SLOWEST` of its fastest, or turns
        fewer than four times.
    """
    one, other = read_trace(signal), read_trace(angle)
    turns, shaft = _turns(other.values), split_output(other.name)[1] or "the shaft"
    speeds = np.diff(turns) * one.rate
    if not speeds.min() > SLOWEST * speeds.max():
        raise LtcgearError(
            f"{shaft} stands, turns back or is very slow in the span; give a span in which it turns, or another shaft"
        )
    whole = int(turns[-1] * (1.0 + 1e-12))
    if whole < 4:
        needed = tell_bounds(4.04 / turns[-1] * (one.time[-1] - one.time[0]), inf)[0]
        raise LtcgearError(
            f"{shaft} turns {turns[-1]:.3g} times in the span, 4 at least are needed; "
            f"give a span of {needed} s or more, by --from and --to, or simulate longer"
        )
    each = int(np.ceil(DENSE * one.rate / speeds.min()))
    if each * whole > MOST:
        raise LtcgearError(f"{shaft}: too slow at some time of the span beside its fastest; give a later start, --from")
    order, value = amplitude_spectrum(_resample(turns, one.values, each, whole), float(each), window)
    kept = order <= min(MARGIN * one.rate, highest_hz) / speeds.max()
    return Spectrum(
        one.name, one.title, "amplitude", one.unit, "1", order[kept], value[kept], window, 1.0 / whole,
        noise_bandwidth(window, each * whole) / whole, float(one.time[0]),
        float(np.interp(whole, turns, one.time)), shaft,
    )  # fmt: skip


def _turns(angle: FloatArray) -> FloatArray:
    """Return turns since the first instant, counted in the sense in which the shaft goes."""
    return np.asarray((angle - angle[0]) * np.sign(angle[-1] - angle[0]) / TURN)


def _resample(turns: FloatArray, values: FloatArray, each: int, whole: int) -> FloatArray:
    """Return values at ``each`` equal angles of ``whole`` turns."""
    from scipy.interpolate import make_interp_spline

    places = np.arange(each * whole) / each
    return np.asarray(make_interp_spline(turns, values, k=5)(places), dtype=np.float64)
