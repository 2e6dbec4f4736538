"""Integration in plain C: the files that are the same for all scenes."""

from functools import cache
from pathlib import Path

from ltcgear.generated.contract import HELD

from ...model import continuation, energy_levels, equilibrium
from ...model.cstruct import FAULTS, FIELDS, SOURCES, source
from ...simulation import contact_events, driver, method_limits
from ...simulation.methods import stepper

PARTS = (
    "run.c", "tables.c", "clocks.c", "solve.c", "balance.c", "scaling.c", "start.c", "saving.c", "advance.c",
    "statistics.c", "events.c",
)  # fmt: skip
"""Parts of ltcgear.c after the integrator."""
UNUSED = ("rows.c", "filter.c", "adjoint.c")
"""Parts of the integrator's C that a simulation does not need."""
HOME = Path(__file__).parent / "c"
HEAD = """/* The integration of a gearbox that ltcgear has turned into C, see ltcgear.h; the same for all scenes. */
#define EXPORTED static
"""
CONSTANTS = {
    "SHORTEST": driver.SHORTEST, "LONGEST": driver.LONGEST, "FINEST": driver.FINEST,
    "MOST_STEPS": stepper.MOST_STEPS,
    "SLACK": contact_events.SLACK, "HELD": HELD, "LOADED": energy_levels.LOADED, "UNLOADED": energy_levels.UNLOADED,
    "ROUNDED": equilibrium.ROUNDING, "SETTLED": equilibrium.SETTLED, "LOOSENESS": equilibrium.LOOSE,
    "OPENNESS": equilibrium.OPEN, "FIRST_PART": continuation.FIRST, "SMALLEST_PART": continuation.SMALLEST,
    "PART_GROWTH": continuation.GROWTH, "REACH": method_limits.REACH,
}  # fmt: skip
"""Constants shared with integration and equilibrium in Python."""


@cache
def write_kit() -> dict[str, str]:
    """Return file name -> text of ltcgear.h, ltcgear.c and main.c."""
    given = {name: _read(name) for name in ("ltcgear.h", "main.c")}
    return {"ltcgear.h": given["ltcgear.h"], "ltcgear.c": _runtime(), "main.c": given["main.c"]}


def _runtime() -> str:
    """Return ltcgear.c."""
    core = source(tuple(name for name in SOURCES if name not in UNUSED))
    return "\n".join([HEAD + core, '#include "ltcgear.h"\n', _tables(), *map(_read, PARTS)])


def _tables() -> str:
    """Write what Python and C share: constants, messages of faults, and the fields of a saved run."""
    kept = " ".join(f"X({name})" for name, kind, role in FIELDS if role == "kept" and kind in ("whole", "real"))
    faults = "".join(f'    "{text}",\n' for text in FAULTS)
    return "\n".join([
        *(f"#define {name} {float(value)!r}" for name, value in CONSTANTS.items()),
        f"#define KEPT_NUMBERS(X) {kept}",
        f"static const char *const FAULT[] = {{\n{faults}}};\n",
    ])  # fmt: skip


def _read(name: str) -> str:
    """Return one of the C files."""
    return (HOME / name).read_text("utf-8")
