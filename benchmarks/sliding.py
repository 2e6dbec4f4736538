"""Sliding friction of spur gears: simulated tooth losses beside closed forms, and friction over the mesh phase.

Run as ``python -m benchmarks.sliding``; it writes the table of docs/friction.md and its figure.
"""

from dataclasses import dataclass
from math import pi
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from ltcgear.runtime.model.building import build
from ltcgear.runtime.model.equilibrium import find_equilibrium
from ltcgear.runtime.model.function import Vector
from ltcgear.runtime.model.operating_point import OperatingPoint
from ltcgear.runtime.model.rows import over_time
from ltcgear.runtime.simulation.integrate import integrate
from ltcgear.runtime.simulation.run_settings import RunSettings
from ltcgear.runtime.view.plots import BLUE, GREY, ORANGE, SKY
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.gears import gear_geometry
from ltcgear.symbolic.scene.load import make_scene
from ltcgear.symbolic.scene.validate import meshes
from ltcgear.symbolic.schema.scene_schema import Scene

PAGE = Path(__file__).resolve().parents[1] / "docs" / "friction.md"
FIGURE = PAGE.parent / "images" / "friction.png"
BEGIN, END = "<!-- friction -->\n", "<!-- end -->\n"
HEAD = (
    "| teeth 1 : 2 | contact ratio | gear that drives | loss factor simulated, gear 1 turning +, - | "
    "linear sharing | halves (Ohlendorf) | efficiency simulated | 1 - mu H, linear sharing |\n"
    "|---|---|---|---|---|---|---|---|\n"
)
MU = 0.05
SPEED, TORQUE = 600.0, 1e4  # [rpm], [N m]
PITCHES, SAMPLES = 8, 2000  # simulated tooth pitches, samples in each
CASES = ((59, 21), (31, 30), (-96, 21))
"""Teeth of gear 1, which is held at its speed, and of gear 2; a ring's are negative."""
FRICTION = {"coefficient": MU, "speed": "1 mm/s"}
EFFECTS = {"mesh_friction": "sliding", "mesh_stiffness": "mean", "lateral": "off"}


def scene(z1: int, z2: int, speed: float = SPEED, torque: float = TORQUE) -> Scene:
    """Return the scene of an external pair, or of a ring and planets whose carrier stands still.

    Gear 1 turns at ``speed`` [rpm]; ``torque`` [N m] acts on gear 2, or on the sun behind the planets.
    """
    stage: dict[str, Any] = {"module": "9 mm", "pressure_angle": "20 deg"}
    stiff, small = {"stiffness": "1e11 N/m"}, {"mass": "20 kg", "inertia": "0.5 kg*m^2"}
    turns = small | {"support": "rigid"}
    if z1 > 0:
        stage |= {"kind": "pair", "mesh": stiff | {"friction": FRICTION}}
        stage |= {"input": turns | {"teeth": z1}, "output": turns | {"teeth": z2}}
        ends = "input", "output"
    else:
        stage |= {"kind": "planetary", "planets": 3, "carrier": small | {"support": "fixed"}}
        stage |= {
            "ring": turns | {"teeth": -z1},
            "planet": small | {"teeth": z2},
            "sun": turns | {"teeth": -z1 - 2 * z2},
        }
        stage |= {"sun_planet": stiff, "ring_planet": stiff | {"friction": FRICTION}, "pin": stiff}
        ends = "ring", "sun"
    held, loaded = (f"gears.{end}" for end in ends)
    loads = {
        "held": {"member": held, "speed": f"{speed} rpm"},
        "loaded": {"member": loaded, "torque": f"{torque} N*m"},
    }
    return make_scene({"title": f"{z1} : {z2}", "effects": EFFECTS, "stages": {"gears": stage}, "loads": loads})


def geometry(made: Scene) -> tuple[float, int, float, float]:
    """Return u = z_2 / z_1, z_1, and the parts of the contact ratio on both sides of the pitch point."""
    (stage,) = made.stages.values()
    ((_, _, one, two, sigma),) = (found for found in meshes(stage) if found[1].friction)
    first, last = gear_geometry.path_of_contact(stage, one, two, sigma)
    pitch = 2 * pi * gear_geometry.base_radius(stage, one) / one.teeth
    return sigma * two.teeth / one.teeth, one.teeth, -first / pitch, last / pitch


def linear(u: float, z1: int, eps_1: float, eps_2: float) -> float:
    """Return the loss factor of a load handed over linearly in double contact (docs/method.md).

    A ring's teeth are negative. The last term counts where the pitch point lies in double contact, a part above 1.
    """
    eps = eps_1 + eps_2
    beyond = sum(max(part - 1, 0.0) ** 3 for part in (eps_1, eps_2))
    rubbed = 2 - eps + 2 * eps_1**2 + 2 * eps_2**2 - 2 * eps_1 * eps_2 - 2 * beyond / (eps - 1)
    return pi * abs((1 / u + 1) / z1) * rubbed / 3


def halves(u: float, z1: int, eps_1: float, eps_2: float) -> float:
    """Return the loss factor of a load shared in halves in double contact.

    Ohlendorf (dissertation, TH Munich 1958), who takes the pitch point to lie in single contact; the last term
    counts where it does not.
    """
    beyond = sum(max(part - 1, 0.0) ** 2 for part in (eps_1, eps_2))
    return pi * abs((1 / u + 1) / z1) * (1 - eps_1 - eps_2 + eps_1**2 + eps_2**2 - beyond)


@dataclass(frozen=True)
class Run:
    """Whole tooth pitches: mesh phase, mesh force and friction [N], power lost and power of the load [W]."""

    phase: Vector
    force: Vector
    friction: Vector
    lost: Vector
    power: float

    @property
    def efficiency(self) -> float:
        """Power out over power in; the load takes or gives one of them."""
        lost, power = float(self.lost.mean()), abs(self.power)
        return power / (power + lost) if self.power < 0 else 1 - lost / power

    @property
    def factor(self) -> float:
        """The loss factor: power lost over mu times the power in."""
        return (1 - self.efficiency) / MU


def simulate(z1: int, z2: int, speed: float = SPEED, torque: float = TORQUE, pitches: int = PITCHES) -> Run:
    """Simulate whole tooth pitches from the equilibrium at the start; the arguments are those of ``scene``."""
    model = build_model(scene(z1, z2, speed, torque))
    library, turning = build(obtain(model)), speed * 2 * pi / 60
    p, rate = library.parameters(model.values()), abs(z1 * turning) / (2 * pi)
    at = find_equilibrium(library, p)
    path = integrate(OperatingPoint(library, p, at), RunSettings(pitches / rate, rate * SAMPLES, "erk", 1e-8))
    if path.status != "done":
        raise RuntimeError(path.status)
    outputs, energy = (over_time(library, name, path.x, path.s, p)[:-1] for name in ("outputs", "energy"))
    # Planets of these teeth are all at the same phase, so the first stands for all.
    mesh = "gears.mesh" if z1 > 0 else "gears.ring_planet.1"
    of = {report.quantity: i for i, report in enumerate(library.manifest.reports) if report.item == mesh}
    loaded = -turning * z1 / z2 if z1 > 0 else -turning * z1 / (z1 + 2 * z2)
    force, friction = outputs[:, of["mesh_force"]], outputs[:, of["mesh_friction"]]
    return Run(rate * path.time[:-1], force, friction, energy[:, 4], torque * loaded)


def row(teeth: tuple[int, int], driver: int, factors: tuple[float, float], efficiency: float) -> str:
    """Return one row of the table; ``factors`` are those simulated for both senses of rotation."""
    at = geometry(scene(*teeth))
    expected = linear(*at)
    return (
        f"| {teeth[0]} : {teeth[1]} | {at[2] + at[3]:.3f} | {driver} | {factors[0]:.4f}, {factors[1]:.4f} | "
        f"{expected:.4f} | {halves(*at):.4f} | {efficiency:.5f} | {1 - MU * expected:.5f} |\n"
    )


def table() -> str:
    """Simulate all cases and return the table in Markdown."""
    text = HEAD
    for teeth in CASES:
        for driver, sign in ((1, 1.0), (2, -1.0)):
            runs = [simulate(*teeth, sense * SPEED, sense * sign * TORQUE) for sense in (1.0, -1.0)]
            text += row(teeth, driver, (runs[0].factor, runs[1].factor), runs[0].efficiency)
    return text


def draw() -> None:
    """Draw friction over mesh force for the first case, gear 1 driving."""
    _, _, eps_1, eps_2 = geometry(scene(*CASES[0]))
    single = 2 - eps_1 - eps_2
    found = simulate(*CASES[0], pitches=2)
    ratio = found.friction / found.force
    # In double contact the two pairs lie on both sides of the pitch point, so halves would cancel.
    cancelled = np.where(found.phase % 1 < single, ratio, 0.0)
    figure, axis = plt.subplots(figsize=(8, 3.8), layout="constrained")
    for pitch in (0, 1):
        axis.axvspan(
            pitch + single, pitch + 1, color=SKY, alpha=0.2, lw=0, label="double contact" if pitch == 0 else None
        )
        axis.axvline(
            pitch + 1 - eps_2, ymax=0.78, color=GREY, ls=":", label="contact at the pitch point" if pitch == 0 else None
        )
    axis.axhline(0.0, color="black", linewidth=0.8)
    axis.plot(found.phase, ratio, color=BLUE, label="simulated: load handed over linearly", zorder=3)
    axis.plot(found.phase, cancelled, color=ORANGE, ls="--", label="load shared in halves")
    axis.set(
        xlabel="mesh phase, tooth pitches (0: single contact begins)", ylabel="friction over mesh force", xlim=(0, 2)
    )
    axis.set_ylim(-1.15 * MU, 1.75 * MU)
    axis.legend(frameon=False, loc="upper center", ncols=2)
    figure.savefig(FIGURE, dpi=130)


def main() -> None:
    """Simulate, print the table and write page and figure."""
    made = table()
    print(made)
    draw()
    before, rest = PAGE.read_text("utf-8").split(BEGIN)
    PAGE.write_text(before + BEGIN + made + END + rest.split(END)[1], "utf-8")


if __name__ == "__main__":
    main()
