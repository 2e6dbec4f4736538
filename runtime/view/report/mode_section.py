"""Modes in the report: a table of all, and the lowest as moving shapes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...linear.shapes import exaggerate
from ...model.layout import lay_out
from ...results.table import Table
from ..figures.shape_page import draw_mode
from .sections import Section

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...linear.modes import Mode
    from ...linear.system import Linear

DRAWN = 8
"""Shapes in a page."""


def make_mode_section(linear: Linear | None, modes: Sequence[Mode], reason: str) -> Section:
    """Return the section of the modes.

    Parameters
    ----------
    linear, modes
        The linear system and its modes, named; None and none if they are not known.
    reason
        Why they are not known.
    """
    section = Section("modes", "Mode shapes", [])
    if linear is None:
        section.text.append(f"Not shown: {reason}")
        return section
    vibrating = [number for number, mode in enumerate(modes, start=1) if mode.kind != "rigid"]
    chosen = (vibrating or list(range(1, len(modes) + 1)))[:DRAWN]
    sheet = lay_out(linear.library, linear.p)
    section.text.append(
        "Eigenmodes at the loaded equilibrium, meshes at their mean stiffness. Shapes are exaggerated, slowed down and "
        f"all at one pace; grey: at rest. The lowest {len(chosen)} that vibrate are drawn; ltcgear modes draws any."
    )
    section.modes = [draw_mode(sheet, k, modes[k - 1], exaggerate(linear, sheet, modes[k - 1])) for k in chosen]
    section.moves = True
    section.tables = [_list(modes)]
    return section


def _list(modes: Sequence[Mode]) -> Table:
    """List all modes."""
    rows = tuple(
        (str(number), mode.frequency_hz, 100 * mode.damping_ratio, mode.kind, mode.name)
        for number, mode in enumerate(modes, start=1)
    )
    return Table("Eigenfrequencies", ("mode", "frequency [Hz]", "damping [%]", "class", "what moves"), rows)
