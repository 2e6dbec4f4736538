"""Design of a sweep: its points, drawn reproducibly from its axes."""

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray

from .sweep_axes import MOST, SweepAxis, Vector

SAMPLES = {
    "grid": "every combination of the axes' own points",
    "lhs": "Latin hypercube: as many equal strata of each range as points, each hit once (McKay et al. 1979)",
    "sobol": "scrambled Sobol sequence, which fills the ranges evenly (Owen 1998)",
    "normal": "independent normal draws, the axes written NAME=mean:deviation",
    "saltelli": "N (d + 2) points for Sobol indices of d axes (Saltelli et al. 2010), N being the points asked for",
}
"""Ways to draw points, and what each is."""
PAIRED = ("sobol", "saltelli")
"""Samples that are even only for powers of two."""
INSTALL = "pip install 'ltcgear[sweep]'"
MOST_NUMBERS = 20_000_000
"""Numbers of all points together at most, for the memory that they and their samplers take."""
TOLD = 4
"""Values of a point that a message names."""


@dataclass(frozen=True, eq=False)
class Design:
    """The points of a sweep.

    Axes that bring their own points (lists, ranges NAME=a:b:n) are crossed with each other and with what is drawn of
    the others; the first axis changes slowest, and the drawn points are the same at each crossing.

    Attributes
    ----------
    axes
        What is varied.
    sample, points, seed
        How points were drawn: one of `SAMPLES`, how many were asked for (None for a grid), and the seed.
    values
        Points, shape (size, axes): numbers in the axis' unit, or places in its list.
    """

    axes: tuple[SweepAxis, ...]
    sample: str
    points: int | None
    seed: int
    values: Vector

    @property
    def size(self) -> int:
        """Return the number of points."""
        return len(self.values)

    @property
    def varied(self) -> tuple[SweepAxis, ...]:
        """Return the axes that take more than one value."""
        return tuple(axis for axis in self.axes if not (axis.crossed and axis.places.size == 1))

    @cached_property
    def digest(self) -> str:
        """Return a sum over all values, by which two designs are told apart.

        They are rounded to single precision: the tails of normal draws take a logarithm, whose last bit is the libm's.
        """
        return self._digest("<f4")

    def _digest(self, kind: str) -> str:
        return hashlib.sha256(np.ascontiguousarray(self.values, dtype=kind).tobytes()).hexdigest()

    @property
    def notes(self) -> tuple[str, ...]:
        """Return what one should know of the sample."""
        if self.sample in PAIRED and self.points is not None and self.points & (self.points - 1):
            below = 1 << (self.points.bit_length() - 1)
            return (f"{self.sample}: {self.points} points; a power of two fills evenly, {below} or {2 * below}",)
        return ()

    def changes(self, point: int) -> dict[str, str]:
        """Return what a point puts in place of the scene's values, as ``load_scene(changes=...)`` takes it."""
        return {axis.key: axis.write(float(value)) for axis, value in zip(self.axes, self.values[point], strict=True)}

    def tell(self, point: int) -> str:
        """Return a point as messages name it, with the first few of its values."""
        told = [f"{key}={value}" for key, value in self.changes(point).items()]
        more = [f"{len(told) - TOLD} more"] if len(told) > TOLD else []
        return f"point {point} ({', '.join([*told[:TOLD], *more])})"

    def ends(self) -> list[dict[str, str]]:
        """Return the changes of points that reach all bounds: for each axis its extremes, all items of a list.

        Bounds of a range that is filled are put in place of a point's own value, since draws come close to them only.
        """
        places: list[int] = []
        for axis, column in zip(self.axes, self.values.T, strict=True):
            found = np.unique(column, return_index=True)[1]
            places += found.tolist() if axis.items else [found[0], found[-1]]
        reached = [self.changes(place) for place in dict.fromkeys(places)]
        bounds = [
            (axis.key, axis.write(end)) for axis in self.axes if not axis.crossed for end in (axis.low, axis.high)
        ]
        return [*reached, *(reached[0] | {key: bound} for key, bound in bounds)]

    def coordinates(self) -> dict[str, tuple[str, NDArray[Any], dict[str, str]]]:
        """Return one coordinate per axis over the dimension ``point``, as xarray takes it."""
        columns = zip(self.axes, self.values.T, strict=True)
        return {axis.key: ("point", *axis.coordinate(column)) for axis, column in columns}

    def to_json(self) -> dict[str, Any]:
        """Return plain values that give the same design again."""
        return {
            "axes": [axis.to_json() for axis in self.axes],
            "sample": self.sample,
            "points": self.points,
            "seed": self.seed,
            "size": self.size,
            "digest": self.digest,
        }

    @classmethod
    def from_json(cls, kept: Mapping[str, Any] | str) -> "Design":
        """Draw the design again that ``to_json`` wrote.

        Raises
        ------
        LtcgearError
            If it cannot be read, or other points come out, as another version of NumPy, SciPy or SALib may draw them.
        """
        try:
            kept = json.loads(kept) if isinstance(kept, str) else kept
            axes = [SweepAxis.from_json(axis) for axis in kept["axes"]]
            design, digest = draw_design(axes, kept["sample"], kept["points"], kept["seed"]), kept["digest"]
        except (ValueError, LookupError, TypeError, AttributeError, ArithmeticError, RecursionError) as error:
            raise LtcgearError(f"its design cannot be read ({error}), so it is damaged") from error
        if digest not in (design.digest, design._digest("<f8")):  # files of before have the latter
            raise LtcgearError(
                f"the {design.sample} design was drawn by other versions of NumPy, SciPy or SALib, which this one "
                "cannot draw again, or is damaged; install those that the file names"
            )
        return design

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Design) and self.to_json() == other.to_json()

    def __hash__(self) -> int:
        return hash(self.digest)


def draw_design(axes: Sequence[SweepAxis], sample: str = "grid", points: int | None = None, seed: int = 0) -> Design:
    """Draw the points of a sweep.

    Parameters
    ----------
    axes
        From ``read_axes``.
    sample
        One of `SAMPLES`.
    points
        How many are drawn of the ranges without points of their own; of ``saltelli`` N, which makes N (d + 2).
    seed
        Of the random numbers.

    Raises
    ------
    LtcgearError
        If sample, points and axes do not go together, a range is empty, or SALib is needed and missing.
    """
    crossed, drawn = [axis for axis in axes if axis.crossed], [axis for axis in axes if not axis.crossed]
    _check_sample(sample, crossed, drawn)
    for axis in drawn:
        _check_range(axis, sample)
    count = _check_points(sample, points, seed, len(drawn), [axis.places.size for axis in crossed])
    samples = SAMPLERS[sample](drawn, count, seed) if drawn else np.zeros((1, 0))
    *places, draws = _cross([*(axis.places.size for axis in crossed), len(samples)])
    columns = {axis.key: axis.places[place] for axis, place in zip(crossed, places, strict=True)}
    columns |= {axis.key: samples[draws, k] for k, axis in enumerate(drawn)}
    values = np.stack([columns[axis.key] for axis in axes], axis=1).astype(np.float64)
    return Design(tuple(axes), sample, points, seed, values)


def _cross(sizes: Sequence[int]) -> list[NDArray[np.int64]]:
    """Return the indices of every combination, the first changing slowest; NumPy's own grids end at 32 dimensions."""
    number, behind = np.arange(math.prod(sizes)), [math.prod(sizes[k + 1 :]) for k in range(len(sizes))]
    return [number // later % size for size, later in zip(sizes, behind, strict=True)]


def _check_sample(sample: str, crossed: Sequence[SweepAxis], drawn: Sequence[SweepAxis]) -> None:
    """Refuse axes that a sample cannot serve."""
    if sample not in SAMPLES:
        raise LtcgearError(f"--sample {sample}: no such sample; there are {', '.join(SAMPLES)}")
    if sample == "grid" and drawn:
        key, low, high = drawn[0].key, drawn[0].write(drawn[0].low), drawn[0].write(drawn[0].high)
        raise LtcgearError(
            f"--vary {key}: how many points? write {key}='{low}:{high}:11', or draw them with --sample lhs --points 100"
        )
    if sample == "saltelli" and crossed:
        raise LtcgearError(f"--vary {crossed[0].key}: Sobol indices are of ranges; write NAME=a:b, without points")
    if sample != "grid" and not drawn:
        raise LtcgearError(f"--sample {sample}: every axis has its own points; leave --sample out, or write NAME=a:b")


def _check_range(axis: SweepAxis, sample: str) -> None:
    """Refuse an empty range, or a deviation that is none."""
    if sample == "normal" and not axis.high > 0.0:
        raise LtcgearError(
            f"--vary {axis.key}: the standard deviation {axis.write(axis.high)} must be greater than zero; "
            "with --sample normal write NAME=mean:deviation"
        )
    if sample != "normal" and not axis.low < axis.high:
        raise LtcgearError(
            f"--vary {axis.key}: the range is empty, for {axis.low:g} is not below {axis.high:g}; "
            "give the lower bound first"
        )


def _check_points(sample: str, points: int | None, seed: int, drawn: int, crossed: Sequence[int]) -> int:
    """Return how many points are drawn; refuse too few or too many, and a seed that is none."""
    if seed < 0:
        raise LtcgearError(f"--seed {seed}: must be a whole number from 0 on")
    if sample == "grid" and points is not None:
        raise LtcgearError(f"--points {points}: a grid has the points of its axes; write NAME=a:b:n, or give --sample")
    if sample != "grid" and points is None:
        raise LtcgearError(f"--sample {sample}: how many points? give --points, such as --points 128")
    count = 1 if points is None else points
    if count < 1:
        raise LtcgearError(f"--points {count}: must be a whole number from 1 on")
    total = float(np.prod([count, *crossed], dtype=float)) * (drawn + 2 if sample == "saltelli" else 1)
    if total > MOST:
        raise LtcgearError(f"the sweep would have {total:.4g} points, {MOST} at most are served; take fewer")
    if (numbers := total * (drawn + len(crossed))) > MOST_NUMBERS:
        raise LtcgearError(
            f"the sweep would have {total:.4g} points of {drawn + len(crossed)} keys, {numbers:.2g} numbers; "
            f"{MOST_NUMBERS:.2g} at most are served: take fewer points or keys"
        )
    return count


def _spread(axes: Sequence[SweepAxis], unit: Vector) -> Vector:
    """Map the unit cube to the ranges, bounds kept."""
    low, high = (np.array([getattr(axis, name) for axis in axes]) for name in ("low", "high"))
    return np.asarray(np.clip(low + unit * (high - low), low, high))


def _draw_lhs(axes: Sequence[SweepAxis], count: int, seed: int) -> Vector:
    """Draw a Latin hypercube."""
    from scipy.stats.qmc import LatinHypercube

    return _spread(axes, LatinHypercube(len(axes), seed=np.random.default_rng(seed)).random(count))


def _draw_sobol(axes: Sequence[SweepAxis], count: int, seed: int) -> Vector:
    """Draw the first points of a scrambled Sobol sequence; drawn to a power of two, since less is warned about."""
    from scipy.stats.qmc import Sobol

    sequence = Sobol(len(axes), seed=np.random.default_rng(seed)).random_base2((count - 1).bit_length())
    return _spread(axes, sequence[:count])


def _draw_normal(axes: Sequence[SweepAxis], count: int, seed: int) -> Vector:
    """Draw independent normal numbers."""
    mean, deviation = (np.array([getattr(axis, name) for axis in axes]) for name in ("low", "high"))
    return np.asarray(mean + deviation * np.random.default_rng(seed).standard_normal((count, len(axes))))


def _draw_saltelli(axes: Sequence[SweepAxis], count: int, seed: int) -> Vector:
    """Draw Saltelli's scheme: of each base point A, A with one column of B for each axis, and B."""
    sampler = import_salib("sample")
    problem = make_problem(axes)
    base = 1 << (count - 1).bit_length()
    block = len(axes) + 2
    unit = sampler.sample(problem, base, calc_second_order=False, seed=np.random.default_rng(seed))
    return _spread(axes, unit[: count * block])


SAMPLERS = {"lhs": _draw_lhs, "sobol": _draw_sobol, "normal": _draw_normal, "saltelli": _draw_saltelli}
"""Sample -> function of axes, points and seed to values, shape (points, axes)."""


def make_problem(axes: Sequence[SweepAxis]) -> dict[str, Any]:
    """Return the axes as SALib takes them, each over the unit interval."""
    return {"num_vars": len(axes), "names": [axis.key for axis in axes], "bounds": [[0.0, 1.0]] * len(axes)}


def import_salib(part: str) -> Any:  # noqa: ANN401
    """Return SALib's module ``sample.sobol`` or ``analyze.sobol``.

    Raises
    ------
    LtcgearError
        If SALib is not installed.
    """
    from importlib import import_module

    try:
        return import_module(f"SALib.{part}.sobol")
    except ModuleNotFoundError as error:
        raise LtcgearError(f"Sobol indices need SALib: {INSTALL}") from error
