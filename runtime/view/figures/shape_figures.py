"""Figure of mode shapes: members as circles, displaced and rotated, over their rest positions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...linear.shapes import exaggerate
from ...model.layout import lay_out
from ..plots import BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILLION, make_canvas, save_figure

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ...linear.modes import Mode
    from ...linear.shapes import DiscMotion
    from ...linear.system import Linear
    from ...model.layout import Circle, Sheet

COLOURS = {
    "ring": GREEN, "carrier": PURPLE, "sun": VERMILLION, "planet": BLUE, "input": ORANGE, "output": BLUE,
    "rotor": SKY,
}  # fmt: skip
"""Colour of each kind of member."""


def draw_shapes(linear: Linear, modes: list[Mode], numbers: list[int], title: str, path: Path) -> Path:
    """Draw some modes in one figure.

    Parameters
    ----------
    linear, modes
        The linear system and its modes.
    numbers
        Which to draw, from 1.
    title
        Title.
    path
        File to write; its suffix is the format.
    """
    sheet = lay_out(linear.library, linear.p)
    wide = sheet.width > 3 * sheet.height
    columns = 1 if len(numbers) == 1 else 2 if wide else 3
    rows = -(-len(numbers) // columns)
    width = 14.0
    height = width / columns * 1.32 * sheet.height / (sheet.width + 0.2 * sheet.height) + 0.5
    figure = make_canvas(width, rows * height + 0.8)
    panels = list(figure.subplots(rows, columns, squeeze=False).flat)
    for axes, number in zip(panels, numbers, strict=False):
        _draw(axes, sheet, exaggerate(linear, sheet, modes[number - 1]))
        axes.set_title(caption(number, modes[number - 1]), loc="left", fontsize=9)
    for axes in panels[len(numbers) :]:
        axes.set_axis_off()
    figure.suptitle(f"{title}: mode shapes, exaggerated", x=0.01, ha="left", fontsize=12)
    _explain(figure, sheet)
    return save_figure(figure, path, 110)


def caption(number: int, mode: Mode) -> str:
    """Return number, frequency, damping, class and name of a mode."""
    alike = f", {mode.multiplicity} alike" if mode.multiplicity > 1 else ""
    damping = f"{round(mode.damping_ratio, 4) + 0.0:.2%}"
    return f"{number}: {mode.frequency_hz:.2f} Hz, damping {damping}, {mode.kind}{alike}\n{mode.name}"


def _draw(axes: Axes, sheet: Sheet, motions: dict[str, DiscMotion]) -> None:
    """Draw one mode."""
    for disc in sheet.discs:
        motion = motions[disc.body]
        _circle(axes, disc, (0.0, 0.0, 0.0), GREY, 0.7)
        _circle(axes, disc, (motion.x.real, motion.y.real, motion.turn.real), COLOURS[disc.part], 1.5)
    for name, x in sheet.titles:
        axes.annotate(name, (x, -0.61 * sheet.height), ha="center", va="top", fontsize=8)
    axes.set_xlim(-0.1 * sheet.height, sheet.width + 0.1 * sheet.height)
    axes.set_ylim(-0.71 * sheet.height, 0.61 * sheet.height)
    axes.set_aspect("equal")
    axes.set_axis_off()


def _circle(axes: Axes, disc: Circle, motion: tuple[float, float, float], colour: str, width: float) -> None:
    """Draw a circle with a spoke that shows how it is turned."""
    x, y, turn = motion
    angle = np.linspace(0.0, 2 * np.pi, 73)
    middle = disc.x + x, disc.y + y
    dash = (0, (4, 2)) if disc.part == "carrier" else "-"
    axes.plot(
        middle[0] + disc.radius * np.cos(angle), middle[1] + disc.radius * np.sin(angle),
        color=colour, lw=width, ls=dash,
    )  # fmt: skip
    spoke = disc.radius * np.array([np.cos(np.pi / 2 + turn), np.sin(np.pi / 2 + turn)])
    inner = 0.8 if disc.part in ("ring", "carrier") else 0.0
    axes.plot(*((c + inner * s, c + s) for c, s in zip(middle, spoke, strict=True)), color=colour, lw=width)


def _explain(figure: Figure, sheet: Sheet) -> None:
    """Give the figure one legend."""
    from matplotlib.lines import Line2D

    parts = dict.fromkeys(disc.part for disc in sheet.discs)
    handles = [
        Line2D([], [], color=COLOURS[part], lw=1.5, ls="--" if part == "carrier" else "-", label=part) for part in parts
    ]
    handles.append(Line2D([], [], color=GREY, lw=0.7, label="at rest"))
    figure.legend(handles=handles, loc="outside lower left", ncols=len(handles), frameon=False, fontsize=9)
