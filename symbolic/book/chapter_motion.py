"""Chapter on coordinates and frames: integrated coordinates, and the paper's inertial ones."""

import sympy as sp

from ..elements.base import real
from ..mechanics.frames import rotate
from ..mechanics.model import Model
from .content import Chapter, Maths
from .notation import break_sum, typeset

PHI, PHI_D, RHO, RHO_C, BETA, BETA0, U, U_D = map(real, ("phi", "phi_d", "rho", "rho_C", "beta", "beta_0", "u", "u_d"))
X, Y, VX, VY, PSI, PSI_D = map(real, ("X", "Y", "V_x", "V_y", "psi_b", "psi_d"))
X0, Y0, SX, SY, X_HERE, Y_HERE = map(real, ("x_0", "y_0", "x@seat", "y@seat", "x", "y"))


def write_motion(chapter: Chapter, model: Model) -> None:
    """Write the chapter on coordinates and frames."""
    if model.reference == "rest":
        chapter.say("The train is at rest: places and angles are those against the ground.")
    else:
        _reference(chapter, model)
    _places(chapter, model.has_turning_frame)
    if any(body.seat is not None for body in model.bodies):
        _seats(chapter)
    if model.reference == "rest":
        return
    chapter.head("Speeds of the rigid motion", "ratios")
    values = model.values()
    ratios = [
        (body.name, f"{values[body.ratio]:.9g}" if body.ratio else "0", _frame(model, body.frame))
        for body in model.bodies
    ]
    chapter.tabulate(("body", "speed over the reference speed", "frame"), ratios)


def _frame(model: Model, frame: str) -> str:
    """Say in which frame a body is described."""
    ratio = model.frames[frame]
    if ratio is None:
        return "inertial"
    return f"{frame}, turns with {ratio.removesuffix('.speed_ratio')}"


def _reference(chapter: Chapter, model: Model) -> None:
    """Write the split of angles into rigid motion and deviation."""
    lead = next((body.name for body in model.bodies if body.turning == "reference"), None)
    held = "its speed is held" if lead is None else f"it is the angle of {lead}, whose speed is a state"
    chapter.say(
        "The reference angle ", Maths(typeset(PHI)), f" tells how far the rigid motion has gone; {held}. Every other "
        "angle is a multiple of it and a small deviation, so that nothing that is integrated grows with the turns.",
    )  # fmt: skip
    chapter.equate(break_sum(r"\theta", RHO * PHI + U), "absolute angle of a member")
    chapter.equate(break_sum(r"\dot{\theta}", RHO * PHI_D + U_D), "its speed")
    if model.has_turning_frame:
        chapter.say("A stage's frame turns with the rigid motion of its carrier.")
        chapter.equate(break_sum(typeset(BETA), RHO_C * PHI + BETA0), "angle of the frame")


def _places(chapter: Chapter, turns: bool) -> None:
    """Write places in the frame and in inertial axes."""
    chapter.head("Places", "places")
    chapter.say(
        "A body's place is its nominal place and its displacement. "
        + ("Both are in its frame; the paper's inertial coordinates follow by a turn." if turns else "No frame turns.")
    )
    for letter, nominal, moved in (("X", X0, X_HERE), ("Y", Y0, Y_HERE)):
        chapter.equate(break_sum(letter, nominal + moved))
    if turns:
        _inertial(chapter)
    chapter.say(
        "In the laws of elements x and y are X and Y",
        ", the rates those in the frame, and ", Maths(r"\theta"), " is the deviation ", Maths("u"),
        ": elements see relative places and rolling only, so their laws read the same in inertial coordinates. "
        "Laws that see the ground have ", Maths("v_{x}"), ", ", Maths("v_{y}"), " and the absolute speed ",
        Maths(r"\omega"), ".",
    )  # fmt: skip


def _inertial(chapter: Chapter) -> None:
    """Write positions and velocities relative to the ground."""
    for left, value in zip((r"x^{\text{inertial}}", r"y^{\text{inertial}}"), rotate(BETA, X, Y, sp), strict=True):
        chapter.equate(break_sum(left, value))
    chapter.say("Velocities against the ground, resolved in the turning frame:")
    chapter.equate(break_sum("v_{x}", VX - RHO_C * PHI_D * Y))
    chapter.equate(break_sum("v_{y}", VY + RHO_C * PHI_D * X))


def _seats(chapter: Chapter) -> None:
    """Write the motion of a body that sits on another."""
    chapter.head("Bodies that sit on others", "seats")
    chapter.say(
        "What sits on a body, such as a planet on a rigid pin or the teeth of an eccentric gear, "
        "turns about that body's centre."
    )
    arm = rotate(PSI, X0, Y0, sp)
    for axis, value in zip("xy", arm, strict=True):
        chapter.equate(break_sum(f"a_{{{axis}}}", value), "arm, turned with the seat" if axis == "x" else "")
    ax, ay = sp.symbols("a_x a_y", real=True)
    for left, value in (
        ("X", SX + ax), ("Y", SY + ay),
        (r"\dot{X}", real("v_x@seat") - PSI_D * ay), (r"\dot{Y}", real("v_y@seat") + PSI_D * ax),
    ):  # fmt: skip
        chapter.equate(break_sum(left, value))
