"""Registry of the integrators: what each of them is and can, in one record.

A record names its stepper and does not import it: commands list the names before anything heavy is loaded, and a
package that is optional is imported by those who use it only.
"""

from dataclasses import dataclass
from difflib import get_close_matches
from importlib import import_module
from importlib.util import find_spec
from math import inf
from typing import TYPE_CHECKING

from ltcgear.generated.errors import LtcgearError

if TYPE_CHECKING:
    from .stepper import SegmentProblem, Stepper

EXHAUSTED = "std::bad_alloc"
"""What CasADi says where memory is short."""


@dataclass(frozen=True)
class Method:
    """An integrator.

    Attributes
    ----------
    name, about
        What it is called, and what it is.
    stepper
        Module of this room and class in it; None for the method built into the C.
    explicit
        Whether its step is bound by the fastest motion, whether or not that vibrates.
    multistep
        Whether it goes by steps before the last.
    reference
        Its place among those that may give a reference, the most accurate is 1; None for a method that may not.
    stiffest
        Fastest over slowest motion beyond which it is refused.
    unresolved
        What a segment's nodes may miss, over rtol; more where the method's own errors are larger.
    segment_operations
        Operations in the time that a segment takes in addition to its steps (measured).
    package
        The module that it needs and that is not always installed.
    """

    name: str
    about: str
    stepper: str | None
    explicit: bool = False
    multistep: bool = True
    reference: int | None = None
    stiffest: float = inf
    unresolved: float = 10.0
    segment_operations: float = 2e5
    package: str | None = None

    @property
    def in_march(self) -> bool:
        """Return whether it is built into the C: its runs can be parallel, since they do not need the interpreter."""
        return self.stepper is None

    @property
    def installed(self) -> bool:
        """Return whether the package that it needs is installed."""
        return self.package is None or find_spec(self.package) is not None

    def make(self, problem: "SegmentProblem") -> "Stepper | None":
        """Make its stepper; None for the method built into the C."""
        if self.stepper is None:
            return None
        module, name = self.stepper.split(".")
        made: Stepper = getattr(import_module(f".{module}", __package__), name)(problem)
        return made


ERK = Method(
    "erk", "explicit Runge-Kutta 5(4), compiled with the march", None,
    explicit=True, multistep=False, reference=1, unresolved=1.0, segment_operations=3e4,
)  # fmt: skip
CVODES = Method(
    "cvodes", "SUNDIALS CVODES, BDF, on compiled right-hand side and Jacobian", "casadi.CvodesStepper", reference=3
)
# Held at its bound of stability for as long, it was seen to err 1e4 times its tolerance (hard case ``tiny-inertia``).
ADAMS = Method(
    "adams", "SUNDIALS CVODES, Adams, on the compiled right-hand side; for tight tolerances without stiffness",
    "casadi.AdamsStepper", explicit=True, reference=5, stiffest=5e4,
)  # fmt: skip
IDAS = Method("idas", "SUNDIALS IDAS, BDF, on compiled right-hand side and Jacobian", "casadi.IdasStepper", reference=4)
ROSENBROCK = Method(
    "rosenbrock", "L-stable Rosenbrock, compiled whole; for very stiff models", "casadi.RosenbrockStepper",
    multistep=False, reference=2,
)  # fmt: skip
SUNDAE = Method(
    "sundae", "SUNDIALS 7 CVODE, BDF, which finds switchings by itself; for a second opinion",
    "sundials7.SundaeStepper", package="sksundae",
)  # fmt: skip
METHODS = {method.name: method for method in (ERK, CVODES, ADAMS, IDAS, ROSENBROCK, SUNDAE)}
AUTO = "auto"
"""In place of a method: let one be chosen by the model."""


def find_method(name: str) -> Method:
    """Return a method by its name.

    Raises
    ------
    LtcgearError
        If there is no such method, or its package is not installed.
    """
    if name not in METHODS:
        near = get_close_matches(name, METHODS, 1)
        hint = f'did you mean "{near[0]}"?' if near else f"there are {AUTO}, {', '.join(METHODS)}"
        raise LtcgearError(f"method {name!r}: unknown; {hint}")
    if not METHODS[name].installed:
        raise LtcgearError(f"method {name!r}: needs a package that is missing; pip install 'ltcgear[{name}]'")
    return METHODS[name]
