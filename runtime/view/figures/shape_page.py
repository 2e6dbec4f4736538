"""Page of moving mode shapes: one HTML file with its own drawings and script; it needs no network."""

from __future__ import annotations

import json
from html import escape
from typing import TYPE_CHECKING

from ltcgear.generated.writing import write_text

from ...linear.shapes import exaggerate
from ...model.layout import lay_out
from .shape_figures import COLOURS, caption

if TYPE_CHECKING:
    from pathlib import Path

    from ...linear.modes import Mode
    from ...linear.shapes import DiscMotion
    from ...linear.system import Linear
    from ...model.layout import Circle, Sheet

WIDTH = 640
"""Width of a drawing in its own units."""
STYLE = """
body { font: 15px/1.4 system-ui, sans-serif; margin: 1.5rem; color: #222; background: #fff; }
main { display: grid; grid-template-columns: repeat(auto-fill, minmax(24rem, 1fr)); gap: 1.2rem; }
figure { margin: 0; padding: .6rem; border: 1px solid #ddd; }
figcaption { font-size: .9rem; white-space: pre-line; }
svg { width: 100%; height: auto; }
circle, line { fill: none; vector-effect: non-scaling-stroke; stroke-width: 1.6px; }
.rest * { stroke: #999; stroke-width: .8px; }
text { font-size: 13px; text-anchor: middle; fill: #444; }
"""
SCRIPT = """
const parts = [...document.querySelectorAll("g[data-m]")].map(g => [g, JSON.parse(g.dataset.m)]);
const button = document.querySelector("button");
let moving = !matchMedia("(prefers-reduced-motion: reduce)").matches, angle = 0, last = 0;
function place() {
  const c = Math.cos(angle), s = Math.sin(angle), at = v => v[0] * c - v[1] * s;
  for (const [g, [x, y, turn, cx, cy]] of parts)
    g.setAttribute("transform", `translate(${at(x)} ${at(y)}) rotate(${at(turn)} ${cx} ${cy})`);
}
function step(time) {
  if (moving) { angle += (time - last) / 1000 * 3; place(); }
  last = time;
  requestAnimationFrame(step);
}
function label() { button.textContent = moving ? "Stop" : "Move"; }
button.hidden = false;
button.onclick = () => { moving = !moving; label(); };
label();
requestAnimationFrame(step);
"""


def write_page(linear: Linear, modes: list[Mode], numbers: list[int], title: str, path: Path) -> Path:
    """Write a page of modes that move, slowed down and all at one pace.

    Without a script they show the real part of the shapes.

    Parameters
    ----------
    linear, modes
        The linear system and its modes.
    numbers
        Which to draw, from 1.
    title
        Heading of the page.
    path
        File to write.
    """
    sheet = lay_out(linear.library, linear.p)
    figures = "\n".join(draw_mode(sheet, k, modes[k - 1], exaggerate(linear, sheet, modes[k - 1])) for k in numbers)
    legend = ", ".join(
        f'<b style="color:{COLOURS[part]}">{part}</b>' for part in dict.fromkeys(d.part for d in sheet.discs)
    )
    head = escape(f"{title}: mode shapes")
    return write_text(
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{head}</title>\n'
        f'<meta name="generator" content="ltcgear">\n'
        f"<style>{STYLE}</style></head>\n<body><h1>{head}</h1>\n"
        f"<p>Exaggerated, slowed down, and all at one pace. Circles: {legend}; grey: at rest. "
        f"<button hidden>Stop</button></p>\n<main>\n{figures}\n</main>\n<script>{SCRIPT}</script></body></html>\n",
        path,
    )


def draw_mode(sheet: Sheet, number: int, mode: Mode, motions: dict[str, DiscMotion]) -> str:
    """Return one mode as a figure of HTML, in the real part of its shape.

    Parameters
    ----------
    sheet
        Layout of the members.
    number
        The mode's, from 1.
    mode, motions
        The mode, and how its members move (``exaggerate``).
    """
    scale, edge = WIDTH / sheet.width, 0.1 * sheet.height
    low, high = -sheet.height * 0.61, sheet.height * 0.72
    box = " ".join(f"{scale * v:.1f}" for v in (-edge, low, sheet.width + 2 * edge, high - low))
    rest = "".join(_circle(disc, scale) for disc in sheet.discs)
    moved = "".join(_moved(disc, motions[disc.body], scale) for disc in sheet.discs)
    names = "".join(
        f'<text x="{scale * x:.1f}" y="{scale * 0.69 * sheet.height:.1f}">{escape(name)}</text>'
        for name, x in sheet.titles
    )
    told = escape(caption(number, mode))
    return (
        f'<figure class="mode"><svg viewBox="{box}" role="img" aria-label="{told}"><g class="rest">{rest}</g>'
        f"{moved}{names}</svg>"
        f"<figcaption>{told}</figcaption></figure>"
    )


def _circle(disc: Circle, scale: float) -> str:
    """Return a circle with a spoke; the page's y points down."""
    x, y, radius = scale * disc.x, -scale * disc.y, scale * disc.radius
    inner = 0.8 * radius if disc.part in ("ring", "carrier") else 0.0
    dash = ' stroke-dasharray="6 4"' if disc.part == "carrier" else ""
    return (
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}"{dash}/>'
        f'<line x1="{x:.1f}" y1="{y - inner:.1f}" x2="{x:.1f}" y2="{y - radius:.1f}"/>'
    )


def _moved(disc: Circle, motion: DiscMotion, scale: float) -> str:
    """Return a circle that moves: amplitudes of x, y [drawing] and turn [deg] as real and imaginary parts."""
    degrees = -57.29577951308232 * motion.turn
    shifts = scale * motion.x, -scale * motion.y
    x, y = scale * disc.x, -scale * disc.y
    pairs = [[round(v.real, 3), round(v.imag, 3)] for v in (*shifts, degrees)]
    numbers = escape(json.dumps([*pairs, round(x, 1), round(y, 1)], separators=(",", ":")))
    still = f"translate({pairs[0][0]} {pairs[1][0]}) rotate({pairs[2][0]} {x:.1f} {y:.1f})"
    circle = _circle(disc, scale)
    colour = COLOURS[disc.part]
    return f'<g class="part {disc.part}" data-m="{numbers}" stroke="{colour}" transform="{still}">{circle}</g>'
