"""Stage view of the report, posed at a sample and moved by the page's script."""

from __future__ import annotations

from cmath import exp
from dataclasses import asdict, dataclass
from math import degrees, pi
from typing import TYPE_CHECKING, Any

import numpy as np

from .panels import nice

if TYPE_CHECKING:
    from .film import Track
    from .panels import Contact, Panel, Wheel

SIZE = 100.0
"""Reach of a stage in the drawing's units."""
LONGEST = 46.0
"""Length of the arrow of the largest force of a stage."""
HEAD = 7.0
MARGIN = 16.0
RIM = 1.12
"""Radius of a ring's rim over that of its pitch circle."""


@dataclass(frozen=True)
class View:
    """A panel at a sample: drawing units a metre, angle of its frame [rad], exaggeration, largest force [N]."""

    track: Track
    panel: Panel
    sample: int
    factor: float

    @property
    def scale(self) -> float:
        """Return the drawing's units a metre."""
        return SIZE / self.panel.reach

    @property
    def turned(self) -> complex:
        """Return how the stage's frame has turned, as a factor."""
        return exp(1j * self.track.angle(self.panel.frame, self.sample))

    @property
    def unit(self) -> float:
        """Return the largest force of the stage in the record [N]."""
        names = [contact.name for contact in self.panel.contacts]
        columns = [k for k, mesh in enumerate(self.track.meshes) if mesh in names]
        return float(np.abs(self.track.force[:, columns]).max()) if columns else 0.0

    def shift(self, body: str) -> complex:
        """Return how far a member is drawn from its place, in the frame [m]."""
        return self.factor * complex(*self.track.shift(body, self.sample))


def pose_stage(track: Track, panels: list[Panel], sample: int, factor: float) -> list[dict[str, Any]]:
    """Return what the page draws of each panel at a sample.

    Parameters
    ----------
    track
        The motion.
    panels
        The stages.
    sample
        Number of the sample.
    factor
        How much deflections are exaggerated.
    """
    return [_pose(View(track, panel, sample, factor)) for panel in panels]


def _pose(view: View) -> dict[str, Any]:
    """Return one panel."""
    panel, scale, unit = view.panel, view.scale, view.unit
    length, force = nice(0.5 * panel.reach), nice(0.8 * unit)
    return {
        "name": panel.name,
        "frame": panel.frame,
        "alone": panel.wheels[0].part == "rotor",
        "box": _box(panel, scale),
        "scale": scale,
        "unit": unit,
        "measure": measure(unit),
        "wheels": [_wheel(view, wheel) for wheel in panel.wheels],
        "contacts": [_contact(view, contact, unit) for contact in panel.contacts],
        "length": {"drawn": round(length * scale, 2), "text": f"{length * 1e3:g} mm"},
        "force": _arrow_scale(force, unit) if unit else None,
    }


def _arrow_scale(force: float, unit: float) -> dict[str, Any]:
    """Return the scale arrow."""
    length = force / unit * LONGEST
    return {"drawn": round(length, 2), "path": arrow(length), "text": newtons(force, unit)}


def _box(panel: Panel, scale: float) -> list[float]:
    """Return the viewBox of a panel: left, top, width, height."""
    sizes = [(scale * complex(w.x, -w.y), scale * w.radius * (RIM if w.part == "ring" else 1.0)) for w in panel.wheels]
    left, right = min(z.real - r for z, r in sizes) - MARGIN, max(z.real + r for z, r in sizes) + MARGIN
    top, low = min(z.imag - r for z, r in sizes) - MARGIN, max(z.imag + r for z, r in sizes) + MARGIN
    return [round(v, 1) for v in (left, top, right - left, low - top)]


def _wheel(view: View, wheel: Wheel) -> dict[str, Any]:
    """Return a wheel: its drawing at angle zero, and its position."""
    scale, radius = view.scale, wheel.radius * view.scale
    module = 2 * radius / wheel.teeth if wheel.teeth else 0.0
    pins = [complex(item.x, -item.y) * scale for item in view.panel.wheels if item.part == "planet"]
    middle = view.turned * (complex(wheel.x, wheel.y) + view.shift(wheel.body)) * scale
    return asdict(wheel) | {
        "r": round(radius, 2),
        "rim": round(radius * RIM, 2),
        "height": round(2 * module, 3),
        "root": round(radius + module if wheel.part == "ring" else radius - module, 2),
        "transform": transform(middle, view.track.angle(wheel.body, view.sample)),
        "teeth_turn": round(-degrees(wheel.offset) % 360, 3),
        "arms": [(round(z.real, 2), round(z.imag, 2)) for z in pins] if wheel.part == "carrier" else [],
    }


def _contact(view: View, contact: Contact, unit: float) -> dict[str, Any]:
    """Return a mesh: its line of action at the pitch point, and the arrow of its force on gear 2."""
    track, k = view.track, view.track.meshes.index(contact.name)
    force, touching = float(track.force[view.sample, k]), bool(track.touching[view.sample, k])
    shift = (view.shift(contact.one) + view.shift(contact.two)) / 2
    middle = view.turned * (complex(contact.x, contact.y) + shift) * view.scale
    turn = track.angle(view.panel.frame, view.sample) + contact.direction
    return asdict(contact) | {
        "transform": transform(middle, turn),
        "arrow": arrow(force / unit * LONGEST if unit else 0.0),
        "open": not touching or force == 0.0,
        "now": newtons(force, unit),
    }


def transform(middle: complex, turn: float) -> str:
    """Return an SVG transform to a place (its y points up, the page's down) and an angle [rad]."""
    angle = -degrees(turn % (2 * pi))
    return f"translate({middle.real:.2f} {-middle.imag + 0.0:.2f}) rotate({angle:.2f})"


def arrow(length: float) -> str:
    """Return the path of an arrow along x from the origin; a short one has a short head."""
    head = min(HEAD, abs(length)) * (1 if length >= 0 else -1)
    half = abs(head) * 0.42
    return f"M0 0H{length - head:.2f}M{length:.2f} 0l{-head:.2f} {-half:.2f}v{2 * half:.2f}z"


def measure(largest: float) -> tuple[str, float]:
    """Return the unit in which forces up to a largest one [N] are told, and what it is in N."""
    return ("kN", 1e3) if largest >= 2e3 else ("N", 1.0)


def newtons(force: float, largest: float) -> str:
    """Write a force [N] in the unit that suits the largest one."""
    unit, size = measure(largest)
    return f"{force / size:.4g} {unit}"
