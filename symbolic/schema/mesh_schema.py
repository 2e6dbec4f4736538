"""Schema of a gear mesh: stiffness, damping, contact, friction, tooth errors."""

from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import Field

from .quantities import Angle, Bore, Damping, Length, Ratio, SceneTable, Stiffness, TorsionalStiffness, Velocity
from .series import Pairs, Series

MOST_HARMONICS = 200
TRANSITION = 0.1  # [pitches]
SHORTEST = 1e-6  # [pitches] that single or double contact lasts, where there is any


class Friction(SceneTable):
    """Mesh friction; acts when ``mesh_friction`` is on, ``damping`` at the pitch point only."""

    coefficient: Annotated[float, Field(ge=0, lt=1)]
    speed: Velocity = 0.01
    damping: Damping | None = None


def _periodic(key: str, table: Pairs | None) -> Iterator[str]:
    """Check that a table over the mesh phase covers one tooth pitch and closes."""
    if table is None:
        return
    (first, start), (last, end) = table[0], table[-1]
    if first < 0 or last > 1:
        yield f"{key}: phases must lie between 0 and 1 (tooth pitches, 0 where single contact begins)"
    elif first == 0 and last == 1 and abs(end - start) > 1e-6 * max(abs(end), abs(start)):
        yield f"{key}: the values at phase 0 and 1 differ, {start:.6g} and {end:.6g} in SI; a pitch must close"
    elif last - first < 0.5:
        yield f"{key}: covers {last - first:.3g} of a pitch only; give it over the whole pitch"


class GivenTransmissionError(SceneTable):
    """Static transmission error along the line of action over the mesh phase; acts with ``transmission_error``.

    Given by harmonics, e = sum of amplitude cos(2 pi n tau + phase) over n = 1, 2, ... (omitted phases are zero), or by
    a table over a tooth pitch, of which the mesh's ``harmonics`` are kept.
    """

    amplitudes: Annotated[list[Bore], Field(max_length=MOST_HARMONICS)] = []
    phases: Annotated[list[Angle], Field(max_length=MOST_HARMONICS)] = []
    table: Annotated[Pairs, Series("", "m")] | None = None

    def faults(self) -> Iterator[str]:
        """Check that there is exactly one description, and that phases belong to amplitudes."""
        if bool(self.amplitudes) == (self.table is not None):
            yield "give either amplitudes or a table"
        yield from _periodic(".table", self.table)
        if self.phases and len(self.phases) != len(self.amplitudes):
            yield f".phases: {len(self.phases)} phases for {len(self.amplitudes)} amplitudes; give one each, or none"


class ToothError(SceneTable):
    """Spacing error of one tooth [m], positive if the tooth lags its position; acts with ``tooth_errors``.

    Tooth 0 of a gear is the one whose single contact begins at mesh phase 0.
    """

    gear: Literal["sun", "ring", "planet", "input", "output"]
    tooth: Annotated[int, Field(ge=0)]
    error: Bore
    planet: Annotated[int, Field(ge=1)] | None = None


class Mesh(SceneTable):
    """A gear mesh.

    ``stiffness`` is that of single contact (or the constant one); alternatively ``torsional_stiffness`` with its
    ``reference`` gear, k = K / r_b^2. ``double_factor`` is the paper's xi, the ratio of double to single contact.
    Without it the stiffness is constant. From ``face_width`` both levels are computed (spur gears). ``transition`` is
    the width of ``smooth`` transitions in tooth pitches (default `TRANSITION`, or the shorter of single and double
    contact). ``harmonics`` is the number of mesh harmonics that ``fourier`` and ``table`` keep. ``table`` uses
    ``stiffness_table``, stiffness over the mesh phase (0 where single contact begins, 1 a tooth pitch later).
    """

    stiffness: Stiffness | None = None
    torsional_stiffness: TorsionalStiffness | None = None
    reference: Literal["sun", "ring", "planet", "input", "output"] | None = None
    face_width: Length | None = None
    stiffness_table: Annotated[Pairs, Series("", "N/m")] | None = None
    double_factor: Annotated[float, Field(ge=1, le=3)] | None = None
    contact_ratio: Annotated[float, Field(ge=1, le=2)] | None = None
    phase: Annotated[float, Field(ge=-1, le=1)] = 0.0
    damping: Damping | None = None
    damping_ratio: Ratio | None = None
    flank: Literal["auto", "printed", "opposite"] = "auto"
    backlash: Bore = 0.0
    friction: Friction | None = None
    transition: Annotated[float, Field(ge=0.001, lt=1)] | None = None
    harmonics: Annotated[int, Field(ge=1, le=MOST_HARMONICS)] = 5
    transmission_error: GivenTransmissionError | None = None
    tooth_errors: Annotated[list[ToothError], Field(max_length=200)] = []

    def faults(self) -> Iterator[str]:
        """Check that there is exactly one stiffness and one damping."""
        yield from super().faults()
        given = sum(k is not None for k in (self.stiffness, self.torsional_stiffness, self.face_width))
        if given > 1 or (given == 0 and self.stiffness_table is None):
            yield "give either stiffness, or torsional_stiffness with its reference gear, or face_width"
        elif (self.torsional_stiffness is None) != (self.reference is None):
            yield "torsional_stiffness and reference belong together"
        whole = round(self.contact_ratio or 0.0)
        if self.contact_ratio is not None and 0 < abs(self.contact_ratio - whole) <= SHORTEST:
            yield f".contact_ratio: is within {SHORTEST:.0e} of {whole}, so that hardly anything switches; give {whole}"
        yield from _periodic(".stiffness_table", self.stiffness_table)
        if self.stiffness_table is not None and min(value for _, value in self.stiffness_table) <= 0:
            yield ".stiffness_table: every stiffness must be greater than zero"
