"""C sources of an FMU."""

from collections.abc import Iterable
from pathlib import Path

from ...model.library import Library
from ..plain_c.data import PlainRun, write_data
from ..plain_c.kit import write_kit
from .variables import Interface

HOME = Path(__file__).parents[1] / "plain_c" / "c"
OWN = {False: ("fmu.h", "fmu.c", "fmi2types.h", "fmi2.c"), True: ("fmu.h", "fmu.c", "fmi3types.h", "fmi3.c")}
"""Whether it is for model exchange -> files that a plain C user does not need."""
HEAD = """/* The variables of an FMU, see fmu.h. */
#include "fmu.h"
"""


def write_sources(library: Library, name: str, run: PlainRun, interface: Interface) -> dict[str, str]:
    """Return file name -> text of all C but ``variables.c``, which has the token."""
    kit = write_kit()
    return {
        "model.c": library.artifact.c,
        "data.c": write_data(library, name, run),
        **{file: kit[file] for file in ("ltcgear.h", "ltcgear.c")},
        **{file: (HOME / file).read_text("utf-8") for file in OWN[interface.exchange]},
    }


def write_variables(interface: Interface, token: str) -> str:
    """Return ``variables.c``."""
    states = [state.name for state in interface.manifest.states]
    arrays: dict[str, tuple[str, Iterable[object]]] = {
        "first": ("unsigned", interface.first),
        "nominal": ("double", map(float, interface.nominal)),
        "angle_ratio": ("double", map(float, interface.ratios)),
        "angle_twist": ("ltcgear_whole", [place for place, _ in interface.rotors]),
        "input_table": ("ltcgear_whole", [item.table for item in interface.inputs]),
        "input_slope": ("unsigned char", [int(item.slope) for item in interface.inputs]),
        "input_ramp": ("unsigned char", [int(item.ramps) for item in interface.inputs]),
        "input_start": ("double", [item.start for item in interface.inputs]),
    }
    reference = states.index("reference.angle") if "reference.angle" in states else -1
    fields = {"token": f'"{token}"', **{name: name for name in arrays}, "reference": reference}
    lines = [_array(kind, name, items) for name, (kind, items) in arrays.items()]
    inside = "".join(f"  .{field} = {value},\n" for field, value in fields.items())
    return "\n".join([HEAD, *lines, f"\nconst fmu_variables fmu_scene = {{\n{inside}}};\n"])


def _array(kind: str, name: str, items: Iterable[object]) -> str:
    """Write a constant array; C knows none without an item, so an empty one has one that nobody reads."""
    texts = list(map(str, items)) or ["0"]
    rows = (", ".join(texts[i : i + 8]) for i in range(0, len(texts), 8))
    return f"static const {kind} {name}[] = {{\n  " + ",\n  ".join(rows) + "};"
