"""Theme of the report's figures: SVG in the colours and fonts of the page."""

from __future__ import annotations

import re
from contextlib import contextmanager
from io import BytesIO
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

from ..plots import write_plainly

if TYPE_CHECKING:
    from collections.abc import Iterator

    from matplotlib.figure import Figure

INK, SOFT, LINE = "#1b2a41", "#5d6b7e", "#cfd6df"
"""Colours of a figure that stand for the page's text, its lighter text, and thin lines."""
COLOURS = {
    INK: "ink", SOFT: "soft", LINE: "line",
    "#0072b2": "blue", "#d55e00": "vermillion", "#009e73": "green", "#cc79a7": "purple",
    "#e69f00": "orange", "#56b4e9": "sky", "#777777": "soft", "#000000": "ink",
}  # fmt: skip
"""Colours in a figure, and the page's names for them."""
STYLE: Any = {
    "svg.fonttype": "none", "text.parse_math": False, "font.size": 10, "font.family": "sans-serif",
    "axes.titlesize": 10.5, "axes.titlelocation": "left", "axes.titleweight": "bold", "axes.labelsize": 10,
    "xtick.labelsize": 9.5, "ytick.labelsize": 9.5, "legend.frameon": False,
    "text.color": INK, "axes.labelcolor": INK, "axes.titlecolor": INK, "axes.edgecolor": SOFT, "xtick.color": SOFT,
    "ytick.color": SOFT, "xtick.labelcolor": INK, "ytick.labelcolor": INK, "grid.color": LINE, "grid.linewidth": 0.6,
    "axes.grid": True, "axes.axisbelow": True, "axes.spines.top": False, "axes.spines.right": False,
    "figure.facecolor": "none", "axes.facecolor": "none", "savefig.facecolor": "none", "lines.linewidth": 1.1,
    "axes.formatter.useoffset": False, "path.simplify_threshold": 0.3, "axes.unicode_minus": True,
}  # fmt: skip
SVG, XLINK = "{http://www.w3.org/2000/svg}", "{http://www.w3.org/1999/xlink}"
NUMBER = re.compile(r"-?\d+\.\d{2,}")
COLOUR = re.compile(r"#[0-9a-f]{6}\b")
LINK = re.compile(r"^(?:url\()?#([\w-]+)\)?$")
FONT = re.compile(r"font-family: [^;]*")


@contextmanager
def themed() -> Iterator[None]:
    """Draw figures in the page's style while this lasts."""
    import matplotlib as mpl

    with mpl.rc_context(STYLE):
        yield


def write_svg(figure: Figure, name: str, label: str) -> str:
    """Return a figure as SVG for a page.

    Parameters
    ----------
    figure
        The figure.
    name
        What all ids of the drawing begin with; no two of a page may share it.
    label
        What the figure shows, for those who cannot see it.
    """
    import matplotlib as mpl

    write_plainly(figure)
    draft = BytesIO()
    with mpl.rc_context(STYLE | {"svg.hashsalt": name}):
        figure.savefig(draft, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    root = ElementTree.fromstring(draft.getvalue())
    used = {found for element in root.iter() for value in element.attrib.values() for found in LINK.findall(value)}
    for element in root.iter():
        _adopt(element, name, used)
    for key in ("width", "height", "version"):
        root.attrib.pop(key, None)
    root.attrib |= {"role": "img", "aria-label": label}
    ElementTree.register_namespace("", SVG[1:-1])
    return ElementTree.tostring(root, encoding="unicode")


def _adopt(element: ElementTree.Element, name: str, used: set[str]) -> None:
    """Give an element the page's colours and fonts, unique ids, and only visible digits."""
    attributes = element.attrib
    for child in [item for item in element if item.tag in (f"{SVG}style", f"{SVG}metadata")]:
        element.remove(child)
    element.text = (element.text or "").strip() or None
    element.tail = None
    own = attributes.pop("id", None)
    if own in used:
        attributes["id"] = f"{name}-{own}"
    if f"{XLINK}href" in attributes:
        attributes["href"] = attributes.pop(f"{XLINK}href")
    for key in ("href", "clip-path"):
        if LINK.match(attributes.get(key, "")):
            attributes[key] = attributes[key].replace("#", f"#{name}-", 1)
    if "style" in attributes:
        style = COLOUR.sub(_colour, attributes["style"].replace("fill: #ffffff", "fill: var(--card)"))
        attributes["style"] = FONT.sub("font-family: var(--font)", style)
    for key in ("d", "transform", "points", "x", "y"):
        if key in attributes:
            attributes[key] = NUMBER.sub(lambda found: f"{float(found.group()):.1f}", attributes[key])


def _colour(found: re.Match[str]) -> str:
    """Return the page's name of a colour; a colour that it has no name for stays."""
    colour = found.group()
    return f"var(--{COLOURS[colour]})" if colour in COLOURS else colour
