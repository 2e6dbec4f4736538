"""The page of the peers: what was measured, as tables in Markdown."""

import json
from pathlib import Path
from typing import Any

from ltcgear.runtime.results.table import Table

from .race import best
from .runners import EXUDYN, NUMPY, OURS, SCIPY, SUNDAE

PAGE = Path(__file__).resolve().parents[2] / "docs" / "peers.md"
DATA = PAGE.parent / "data" / "peers.json"
FIGURE = PAGE.parent / "images" / "peers.png"
BEGIN, END = "<!-- peers -->\n", "<!-- end of peers -->\n"
AIMS = (
    (SCIPY, "rig", 10.0),
    (NUMPY, "rig", 300.0),
    (SUNDAE, "rig", 5.0),
    (EXUDYN, "stage", 1.0),
    (EXUDYN, "torsion", 1.0),
)
"""How many times as long each tool was to take as ours, at equal error."""
MAKING, FLOOR = 20.0, 1.3
"""How many times as long PyDy was to take from nothing, and ours at most for one call beside hand-written C."""
WRITTEN = {"written": "laws as printed", "merged": "one arc tangent a mesh"}
RACES = {"rig": "rig-2mw", "stage": "the stage", "torsion": "the torsional stage"}
STAGES = ("scene", "derive", "check", "emit", "compile", "generate_and_compile")
"""What making a right-hand side consists of."""


def read() -> dict[str, Any]:
    """Return the data of the page."""
    found: dict[str, Any] = json.loads(DATA.read_text("utf-8"))
    return found


def total(found: dict[str, float]) -> float:
    """Return the time from nothing to a right-hand side [s], or the time after which it was stopped."""
    return found.get("stopped_after", 0.0) + sum(found.get(stage, 0.0) for stage in STAGES)


def table(columns: tuple[str, ...], rows: list[tuple[Any, ...]]) -> str:
    """Write a table."""
    return Table("", columns, tuple(rows)).to_markdown()


def short(value: float | None) -> str | None:
    """Return a number to three digits."""
    return None if value is None else f"{value:.3g}"


def tables(data: dict[str, Any]) -> str:
    """Return all tables."""
    parts = [verdicts(data), calls(data)]
    parts += [standing(data[key], name) for key, name in RACES.items() if key in data]
    if "making" in data:
        parts.append(making(data["making"]))
    parts += [checks(data["checks"]), points(data), about(data)]
    return "\n" + "\n".join(parts) + "\n"


def ratio(race: dict[str, Any] | None, tool: str) -> tuple[float | None, str]:
    """Return how many times as long as ours a tool takes at equal error, each by its quickest solver, and the names."""
    one, two = (best(race["rows"], name) if race else None for name in (tool, OURS))
    if one is None or two is None:
        return None, ""
    return one["at_target"]["min"] / two["at_target"]["min"], f"{one['solver']} against {two['solver']}"


def verdicts(data: dict[str, Any]) -> str:
    """Return what was aimed at and what was found."""
    rows: list[tuple[Any, ...]] = []
    for tool, race, aim in AIMS:
        found, names = ratio(data.get(race), tool)
        reached = "not measured" if found is None else "yes" if found >= aim else "no"
        what = f"{RACES[race]}, {tool}: time at equal error over ours"
        rows.append((what, f"at least {aim:g}", short(found), reached, names))
    if "making" in data:
        one, two = (data["making"][name] for name in ("pydy_stage", "our_stage"))
        found = total(one) / total(two)
        bound = "more than " if "stopped_after" in one else ""
        reached = "yes" if found >= MAKING else "no"
        what = "the stage, PyDy: time from nothing to a right-hand side over ours"
        rows.append((what, f"at least {MAKING:g}", f"{bound}{found:.3g}", reached, ""))
    loop = data["calls"]["loop"]
    for key, name in WRITTEN.items():
        found = loop["generated"]["min"] / loop[key]["min"]
        reached = "yes" if found <= FLOOR else "no"
        rows.append(
            ("rig-2mw: one call of our C over hand-written C", f"at most {FLOOR:g}", short(found), reached, name)
        )
    return table(("what", "aim", "found", "reached", "by"), rows)


def calls(data: dict[str, Any]) -> str:
    """Return the times of one call."""
    loop, python = data["calls"]["loop"], data["calls"]["python"]
    floor = loop["written"]["min"]
    rows: list[tuple[Any, ...]] = [
        *((f"rig-2mw, hand-written C, {n}, called from C", *cost(loop[k]["min"], floor)) for k, n in WRITTEN.items()),
        ("rig-2mw, our C, called from C", *cost(loop["generated"]["min"], floor)),
        ("rig-2mw, our C, called from Python", *cost(python["generated"], floor)),
        ("rig-2mw, NumPy", *cost(python["numpy"], floor)),
    ]
    for name, key in (("our C, called from Python", "our_stage"), ("PyDy's C, called from Python", "pydy_stage")):
        call = data.get("making", {}).get(key, {}).get("call")
        if call is not None:
            rows.append((f"the stage, {name}", f"{call * 1e9:.0f}", None))
    return table(("one right-hand side", "ns", "over hand-written C"), rows)


def cost(seconds: float, floor: float) -> tuple[str, str]:
    """Return a call's time [ns] and its ratio to the floor."""
    return f"{seconds * 1e9:.0f}", f"{seconds / floor:.3g}"


def standing(race: dict[str, Any], name: str) -> str:
    """Return the times at equal error, the quickest first."""
    ours = best(race["rows"], OURS)
    unit = ours["at_target"]["min"] if ours else None
    far = float("inf")
    order = sorted(race["rows"], key=lambda row: row["at_target"]["min"] or far)
    rows = []
    for row in order:
        least, middle = (row["at_target"][key] for key in ("min", "median"))
        over = None if least is None or unit is None else least / unit
        rows.append((row["tool"], row["solver"], short(least), short(middle), short(over)))
    title = f"{name}: seconds for mesh forces with an error of {race['target']:g}, "
    title += f"of a reference that is certain to {race['uncertainty']:.1g}:\n\n"
    text = title + table(("tool", "solver", "least s", "median s", "over ours"), rows)
    reasons = [f"- {row['tool']}, {row['solver']}: {row['reason']}\n" for row in race["rows"] if row["reason"]]
    return text + ("\n" + "".join(reasons) if reasons else "")


def making(found: dict[str, Any]) -> str:
    """Return the times from nothing to a right-hand side of the stage."""
    ours, theirs = found["our_stage"], found["pydy_stage"]
    rows: list[tuple[Any, ...]] = [
        (OURS, *(short(ours[stage]) for stage in ("derive", "check", "emit", "compile")), short(total(ours)))
    ]
    if "stopped_after" in theirs:
        rows.append(("PyDy", None, None, None, None, f"stopped after {theirs['stopped_after']}"))
    else:
        stages = short(theirs["derive"]), None, None, short(theirs["generate_and_compile"])
        rows.append(("PyDy", *stages, short(total(theirs))))
    return "The stage from nothing, seconds:\n\n" + table(
        ("tool", "derive", "prove", "emit", "compile (PyDy: and emit)", "all"), rows
    )


def checks(found: dict[str, float]) -> str:
    """Return how far each peer's accelerations are from ours."""
    rows = [(name, f"{value:.1e}") for name, value in found.items()]
    return table(("peer", "accelerations differ from ours by"), rows)


def points(data: dict[str, Any]) -> str:
    """Return every setting that was run."""
    rows = []
    for key, name in RACES.items():
        for row in data[key]["rows"] if key in data else ():
            for p in row["points"]:
                numbers = f"{p['setting']:g}", f"{p['error']:.2g}", short(p["min"]), short(p["median"]), p["runs"]
                rows.append((name, row["tool"], row["solver"], *numbers))
    return table(("model", "tool", "solver", "setting", "error", "least s", "median s", "runs"), rows)


def about(data: dict[str, Any]) -> str:
    """Return when, where and with what."""
    found, race = data["surroundings"], data["rig"]
    versions = ", ".join(f"{name} {number}" for name, number in found["versions"].items())
    set_up = ", ".join(f"{method} {seconds:.2g} s" for method, seconds in race["set_up"].items())
    left_out = ", ".join(data["left_out"]) or "nothing"
    return (
        f"{found['date']}: {found['cpu']}, {found['cores']} cores, load {found['load']:.1f} at the start; {versions}; "
        f"{found['compiler']}, {found['flags']}. Left out of this run: {left_out}. {race['t_end']:g} s of the rig with "
        f"{race['switchings']} switching instants. Not in our times: setting a run up, {set_up}.\n"
    )
