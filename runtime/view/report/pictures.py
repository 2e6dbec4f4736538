"""Figures of the report: SVG without titles, which are text of the page."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from .theme import COLOURS, write_svg

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH = 5.2
"""Width of a figure [in], legible on a phone and for two side by side on a screen."""
MARGINS, BETWEEN = (0.68, 0.14, 0.48, 0.1), 0.72
"""Left, right, lower and upper margin, and what lies between panels one above another [in]."""
FEW = 200.0
"""Ratio of the ends of a logarithmic axis below which 2 and 5 are numbered too."""
WHITE = "#ffffff"


def make_picture(
    figure: Figure, name: str, caption: str, height: float, *, width: float = WIDTH, wide: bool = False
) -> dict[str, Any]:
    """Return a figure as the page's template takes it.

    Parameters
    ----------
    figure
        Drawn while ``themed``; its legends and its first title become text of the page.
    name
        Begins the drawing's ids.
    caption
        What is to be said of it.
    height, width
        Size [in].
    wide
        Whether it takes the whole width of the page.
    """
    title, legend = _take_title(figure), _take_legend(figure)
    _number_axes(figure)
    _lay_out(figure, width, height)
    svg = write_svg(figure, name, f"{title}. {caption}")
    clocks = [_place(figure, axes) for axes in figure.axes if axes.get_xlabel() == "time [s]"]
    return {
        "title": title, "legend": legend, "svg": svg, "caption": caption, "wide": wide,
        "clocks": json.dumps(clocks) if clocks else "",
    }  # fmt: skip


def _lay_out(figure: Figure, width: float, height: float) -> None:
    """Give a figure [in] fixed margins, since finding them takes as long as drawing; not with a colour bar."""
    figure.set_size_inches(width, height)
    places = [axes.get_subplotspec() for axes in figure.axes]
    rows = len({place.rowspan.start for place in places if place is not None})
    if any(axes.get_label() == "<colorbar>" for axes in figure.axes):
        return
    figure.set_layout_engine(None)
    left, right, low, high = MARGINS
    space = BETWEEN * rows / max(height - low - high - BETWEEN * (rows - 1), 0.1)
    figure.subplots_adjust(left / width, low / height, 1 - right / width, 1 - high / height, hspace=space)


def _number_axes(figure: Figure) -> None:
    """Write powers of ten as plain numbers: names may hold any sign, so nothing in a figure is read as mathematics."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    for axis in (axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis)):
        if axis.get_scale() == "log":
            low, high = axis.get_view_interval()
            axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high < FEW * low else (1.0,)))
            axis.set_major_formatter(FuncFormatter(lambda value, place: f"{value:g}"))
            axis.set_minor_locator(NullLocator())


def _take_title(figure: Figure) -> str:
    """Take the title of the first panel, or of the figure, off the figure."""
    axes = figure.axes[0]
    title = figure.get_suptitle() or axes.get_title(loc="left")
    figure.suptitle("")
    axes.set_title("", loc="left")
    return title


def _take_legend(figure: Figure) -> list[dict[str, Any]]:
    """Take the legends off the figure; entries that panels share come once, with the number that follows a name."""
    found: dict[str, dict[str, Any]] = {}
    for axes in figure.axes:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            entry = {"text": label.replace("\n", ", ")} | _look(handle)
            known = (other for other in found.values() if other["text"].startswith(entry["text"] + ":"))
            if not any(_look_of(other) == _look_of(entry) for other in known):
                found.setdefault(label, entry)
        drawn = axes.get_legend()
        if drawn is not None:
            drawn.remove()
    for legend in list(figure.legends):
        legend.remove()
    return list(found.values())


def _look_of(entry: dict[str, Any]) -> tuple[str, ...]:
    """Return what an entry looks like."""
    return entry["colour"], entry["dash"], entry["mark"]


def _look(handle: Any) -> dict[str, Any]:  # noqa: ANN401
    """Return the colour, dashes and mark of a legend's entry; no colour where it is words only."""
    from matplotlib.colors import to_hex
    from matplotlib.lines import Line2D

    if not isinstance(handle, Line2D):
        patch = handle.patches[0] if hasattr(handle, "patches") else handle
        return {"colour": _name(to_hex(patch.get_facecolor())), "dash": "", "mark": "block"}
    marker, style = str(handle.get_marker()), handle.get_linestyle()
    if style in (" ", "None", ""):
        words = marker in ("None", "", " ")
        return {"colour": "" if words else _name(to_hex(handle.get_color())), "dash": "", "mark": marker}
    dash = {"--": "6 3", "-.": "6 2 1 2", ":": "1.5 2.5"}.get(str(style), "")
    return {"colour": _name(to_hex(handle.get_color())), "dash": dash, "mark": "line"}


def _name(colour: str) -> str:
    """Return the page's name of a colour; white lines on a picture become grey outside it."""
    return f"var(--{'soft' if colour == WHITE else COLOURS.get(colour, 'ink')})"


def _place(figure: Figure, axes: Axes) -> dict[str, float]:
    """Return where a panel over time lies in the drawing, and which time its edges are."""
    wide, high = (72 * float(v) for v in figure.get_size_inches())
    box, (begin, end) = axes.get_position(), axes.get_xlim()
    return {
        "left": round(box.x0 * wide, 2), "right": round(box.x1 * wide, 2), "top": round((1 - box.y1) * high, 2),
        "bottom": round((1 - box.y0) * high, 2), "begin": float(begin), "end": float(end),
    }  # fmt: skip
