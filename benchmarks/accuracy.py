"""What accuracy costs in time: every method at every tolerance, for four scenes.

Run as ``python -m benchmarks.accuracy``; it takes some ten minutes and writes tables and figures of docs/accuracy.md,
and what they are drawn from to docs/data/. Sentences of the conclusions that have the form of ``FASTEST``, ``SLOWER``
or ``OFF`` get the numbers that were measured; what stands around them is for a reader to keep right.

With names of cases as arguments only these are run; with ``--pages`` nothing is run and the page is written from
docs/data/.
"""

import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ltcgear.runtime.cli.measuring import measure
from ltcgear.runtime.cli.opening import compile_model, open_scene
from ltcgear.runtime.results.table import Table
from ltcgear.runtime.studies.accuracy.cheapest import LIMITS, find_cheapest
from ltcgear.runtime.studies.accuracy.phases import PHASES, measure_phases
from ltcgear.runtime.studies.accuracy.record import read_record, to_text
from ltcgear.runtime.studies.accuracy.run_errors import KINDS, value_of
from ltcgear.runtime.studies.accuracy.study import phases_setting
from ltcgear.runtime.view.figures.accuracy_figures import NAMES, draw_overview

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGE = DOCS / "accuracy.md"
BEGIN, END = "<!-- accuracy {} -->\n", "<!-- end {} -->\n"
SHOWN = (*LIMITS, 1e-6, 1e-8)
FASTEST = re.compile(r"For (?P<limit>\S+) % `\w+` is the fastest, \S+ times real time")
SLOWER = re.compile(r"`(?P<slow>\w+)` takes \S+ times as long as `(?P<fast>\w+)` for (?P<limit>\S+) %")
OFF = re.compile(
    rf"`(?P<method>\w+)` at rtol (?P<rtol>\S+) is off by \S+ in (?P<name>{'|'.join(map(re.escape, NAMES.values()))})"
)
COUNTS = ("steps", "rhs", "jacobian", "events", "regimes")
Record = dict[str, Any]


@dataclass(frozen=True)
class Case:
    """A scene with changes."""

    scene: str
    changes: Mapping[str, str] = field(default_factory=dict)

    @property
    def settings(self) -> list[str]:
        """Return the changes as KEY=VALUE."""
        return [f"{key}={value}" for key, value in self.changes.items()]


FILM = "3e8 N*s/m"
"""Damping of a bearing, some hundred times the critical one of its gear."""
CASES = {
    "rig": Case("rig-2mw"),
    "smooth": Case("rig-2mw", {"effects.mesh_stiffness": "smooth"}),
    "contact": Case(
        "psh",
        {
            "effects.contact": "backlash",
            "stages.psh.mesh.backlash": "0.1 mm",
            "loads.output.torque": "-200 N*m",
            "effects.transmission_error": "on",
            "stages.psh.mesh.transmission_error": '{amplitudes = ["3 um"]}',
        },
    ),
    "stiff": Case(
        "psh",
        {
            "effects.mesh_stiffness": "smooth",
            "stages.psh.input.bearing": f'{{stiffness = "7.06e9 N/m", damping = "{FILM}"}}',
            "stages.psh.output.bearing": f'{{stiffness = "3.13e9 N/m", damping = "{FILM}"}}',
        },
    ),
}


def record_path(name: str) -> Path:
    """Return where a case's record is."""
    return DOCS / "data" / f"accuracy-{name}.json"


def run(case: Case, preset: str = "full") -> Record:
    """Measure a case, its phases too."""
    opened = open_scene(case.scene, case.settings)
    record = measure(opened, compile_model(opened), preset)
    arguments = [case.scene, *(part for setting in case.settings for part in ("--set", setting))]
    return record | {"phases": measure_phases(arguments, record["t_end"], *phases_setting(record))}


def slim(record: Record) -> Record:
    """Return a record with what page and figures need, and what ``simulate --record`` does, in few digits."""
    points = [
        {
            "method": point["method"], "rtol": float(f"{point['rtol']:.3g}"), "reason": point["reason"],
            "trusted": point["trusted"], "rounds": point["rounds"], "seconds": _few(point["seconds"]),
            "real_time_factor": _few(point.get("real_time_factor")), "ns_call": _few(point.get("ns_call")),
            "errors": {kind: {"value": _few(value)} if (value := value_of(point["errors"], kind)) is not None else None
                       for kind in KINDS},
            "counts": {name: point["counts"].get(name) for name in COUNTS},
        }
        for point in record["points"]
    ]  # fmt: skip
    return record | {"points": points}


def _few(value: float | None) -> float | None:
    """Round to three digits."""
    return None if value is None else float(f"{value:.3g}")


def table(record: Record) -> str:
    """Return the tables of a case in Markdown."""
    methods = list(dict.fromkeys(point["method"] for point in record["points"]))
    rows = []
    for limit in SHOWN:
        found = [find_cheapest(only(record, method), limit) for method in methods]
        times = (None if point is None else f"{point['seconds'] / record['t_end']:.2g}" for point in found)
        rows.append((f"{100 * limit:g} %", *times, fastest(record, limit)))
    head = "Seconds a simulated second of each method for an error of at most:\n\n"
    text = head + Table("", ("error", *methods, "fastest"), tuple(rows)).to_markdown()
    return text + "\n" + "".join(f"- {line}\n" for line in _remarks(record))


def only(record: Record, method: str) -> Record:
    """Return a record with the points of one method."""
    return record | {"points": [point for point in record["points"] if point["method"] == method]}


def fastest(record: Record, limit: float) -> str:
    """Write the fastest setting for an error."""
    point = find_cheapest(record, limit)
    if point is None:
        return "none"
    return f"{point['method']}, rtol {point['rtol']:.1e}: {point['real_time_factor']:.2g} times real time"


def _remarks(record: Record) -> Iterator[str]:
    """Yield what else there is to know of a case."""
    reference, machine = record["reference"], record["machine"]
    runs = " and ".join(f"{run['method']} at rtol {run['rtol']:g}" for run in reference["runs"])
    yield f"Error: {KINDS[record['measure']]}, the worst mesh; over {record['t_end']:g} s."
    differ = value_of(reference["uncertainty"], record["measure"])
    yield f"Reference: {runs}, which differ by {differ:.1e}; taken to be uncertain by {reference['floor']:.1e}."
    yield f"A right-hand side alone takes {record['ns_rhs']:.0f} ns. `--method auto` takes `{record['auto']}`."
    yield from record["notes"]
    for run_, words in (("cold", "From nothing"), ("warm", "From the store")):
        seconds = record["phases"][run_]
        parts = ", ".join(f"{name} {seconds[name]:.2f}" for name in ("start", *PHASES))
        yield f"{words} {seconds['total']:.1f} s: {parts}."
    yield from _gaps(record)
    versions = ", ".join(f"{name} {version}" for name, version in machine["versions"].items() if version)
    yield f"{machine['processor']}, {machine['cores']} cores, load {machine['load']}."
    yield f"{machine['compiler']}, {machine['flags']}; {versions}."


def _gaps(record: Record) -> Iterator[str]:
    """Yield the reasons of what did not run."""
    for method in dict.fromkeys(point["method"] for point in record["points"] if point["reason"]):
        gaps = [point for point in record["points"] if point["method"] == method and point["reason"]]
        rtols = f"{gaps[0]['rtol']:.1e}" + (f" to {gaps[-1]['rtol']:.1e}" if len(gaps) > 1 else "")
        yield f"`{method}` has no point at rtol {rtols}: {gaps[0]['reason']}."


def write(name: str, record: Record) -> None:
    """Write a case's part of the page, and its figure."""
    before, rest = PAGE.read_text("utf-8").split(BEGIN.format(name))
    conclusion, *others = rest.split(END.format(name))[1].split("\n## ")
    after = "\n## ".join([correct(conclusion, record), *others])
    PAGE.write_text(before + BEGIN.format(name) + table(record) + END.format(name) + after, "utf-8")
    draw_overview(record, DOCS / "images" / f"accuracy-{name}.png")


def correct(conclusion: str, record: Record) -> str:
    """Return a conclusion with the record's methods and numbers in the sentences that name them."""

    def name_fastest(found: re.Match[str]) -> str:
        point = find_cheapest(record, float(found["limit"]) / 100)
        method, factor = ("nothing", 0.0) if point is None else (point["method"], point["real_time_factor"])
        return f"For {found['limit']} % `{method}` is the fastest, {factor:.2g} times real time"

    def compare(found: re.Match[str]) -> str:
        points = [find_cheapest(only(record, found[name]), float(found["limit"]) / 100) for name in ("slow", "fast")]
        slow, fast = (float("nan") if point is None else point["seconds"] for point in points)
        return f"`{found['slow']}` takes {slow / fast:.2g} times as long as `{found['fast']}` for {found['limit']} %"

    def tell_error(found: re.Match[str]) -> str:
        kind = next(kind for kind, name in NAMES.items() if name == found["name"])
        points = (point for point in only(record, found["method"])["points"] if point["rtol"] == float(found["rtol"]))
        values = [value_of(point["errors"], kind) for point in points]
        return f"`{found['method']}` at rtol {found['rtol']} is off by {values[0]:.1e} in {found['name']}"

    return OFF.sub(tell_error, SLOWER.sub(compare, FASTEST.sub(name_fastest, conclusion)))


def main() -> None:
    """Measure, write records, page and figures."""
    wanted = [name for name in sys.argv[1:] if name in CASES] or list(CASES)
    for name in wanted:
        if "--pages" not in sys.argv:
            record = slim(run(CASES[name]))
            record_path(name).parent.mkdir(exist_ok=True)
            record_path(name).write_text(to_text(record), "utf-8")
        write(name, read_record(record_path(name)))
        print(f"{name} done", flush=True)


if __name__ == "__main__":
    main()
