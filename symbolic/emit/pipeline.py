"""Pipeline of the symbolic side: Model -> equations -> checks -> C, or the same from the store."""

from collections.abc import Callable
from functools import cache
from pathlib import Path
from time import perf_counter

from ltcgear.generated import store
from ltcgear.generated.contract import Artifact
from ltcgear.generated.errors import CheckError

from ..mechanics.model import Model


@cache
def _surroundings() -> str:
    """Return the digest of source text and package versions, which determine the C together with a structure."""
    from importlib.metadata import version

    return store.digest([_sources(), version("casadi"), version("sympy")])


def _sources() -> str:
    """Return the source text that derives and checks C: every module of ``symbolic``."""
    home = Path(__file__).parents[1]
    return "\n".join(path.read_text("utf-8") for path in sorted(home.rglob("*.py")))


def content_key(model: Model) -> str:
    """Return the key of a model's C in the store: structure, source text of the equations, package versions."""
    return store.digest([model.structure(), _surroundings()])


def generate(model: Model, told: Callable[[str, float], None] = lambda stage, seconds: None) -> Artifact:
    """Derive, check and emit a model.

    Parameters
    ----------
    model
        The model.
    told
        Called with stage name and seconds after each stage.

    Raises
    ------
    CheckError
        If Lagrange's and Newton's equations disagree; nothing is emitted then.
    """
    from ..checks.agree import agreement
    from ..mechanics.equations import derive
    from .c_text import emit

    clock = perf_counter()

    def lap(stage: str) -> None:
        nonlocal clock
        clock, before = perf_counter(), clock
        told(stage, clock - before)

    equations = derive(model)
    lap("derive")
    failed = [check for check in agreement(model, equations) if not check.passed]
    if failed:
        raise CheckError("\n".join(f"{c.name}: {c.value:.3g} is above {c.tolerance:.3g}; {c.note}" for c in failed))
    lap("check")
    artifact = emit(model, equations)
    lap("emit")
    return artifact


def obtain(
    model: Model, told: Callable[[str, float], None] = lambda stage, seconds: None, fresh: bool = False
) -> Artifact:
    """Return a model's C from the store; if it is missing, or with ``fresh``, generate and store it.

    Raises
    ------
    CheckError
        As ``generate``.
    """
    key = content_key(model)
    artifact = None if fresh else store.get(key)
    if artifact is None:
        artifact = generate(model, told)
        store.put(key, artifact)
    return artifact
