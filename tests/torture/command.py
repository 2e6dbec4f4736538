"""The command line of the attacks: counts of each kind, findings with their seeds, and the table of docs/torture.md."""

import argparse
import json
import os
import shutil
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from importlib import import_module
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from .outcome import BAD, WELL
from .process import Finding, attack

ROOT = Path(__file__).resolve().parents[2]
OUT = ROOT / "out" / "torture"
PAGE = ROOT / "docs" / "torture.md"
KINDS = ("scenes", "files", "kills", "disks", "compilers", "environments", "commands")
SEED = 20_260_101
HEAD = f"| attack | cases | {' | '.join((*WELL, *BAD))} | seconds |\n|{'---|' * (len(WELL) + len(BAD) + 3)}\n"


def read_arguments(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser("python -m tests.torture", description=__doc__)
    parser.add_argument("--only", action="append", choices=KINDS, help="a kind of attack; all where none is given")
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--part", type=float, default=1.0, help="part of the cases of each kind")
    parser.add_argument("--case", type=int, action="append", help="number of a case")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--store", type=Path, default=OUT / "store", help="folder that keeps compiled models")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write counts and findings here, and no page")
    return parser.parse_args(arguments)


def numbered(kind: Any, chosen: argparse.Namespace) -> list[int]:
    """Return the numbers of the cases that are run."""
    if chosen.case or chosen.part == 1:
        return chosen.case or list(range(kind.COUNT))
    order = np.random.default_rng(chosen.seed).permutation(kind.COUNT)
    return sorted(map(int, order[: max(2, round(kind.COUNT * chosen.part))]))


def keep(kind: str, seed: int, finding: Finding) -> str:
    """Keep what a bad case left; return how it is run again."""
    again = f"python -m tests.torture --only {kind} --seed {seed} --case {finding.number}"
    folder = OUT / f"{kind}-{seed}-{finding.number}"
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(finding.folder, folder / "files", symlinks=True, ignore_dangling_symlinks=True)
    told = f"{finding.verdict.kind}: {finding.case.name}: {finding.verdict.note}\n{again}\n"
    (folder / "told.txt").write_text(f"{told}\n{finding.done.out}\n{finding.done.err}", "utf-8", "replace")
    return again


def assault(name: str, chosen: argparse.Namespace, told: Any) -> Iterator[tuple[Finding, str]]:
    """Run the cases of a kind; yield what each came to, and how a bad one is run again."""
    kind = import_module(f".{name}", __package__)
    numbers = numbered(kind, chosen)
    getattr(kind, "prepare", lambda: None)()
    workers = min(chosen.workers, getattr(kind, "WORKERS", chosen.workers))
    cases = ((number, kind.make_case(chosen.seed, number)) for number in numbers)
    for done, finding in enumerate(attack(cases, workers), start=1):
        told(done, len(numbers))
        try:
            yield finding, keep(name, chosen.seed, finding) if finding.verdict.bad else ""
        except OSError as error:
            yield finding, f"not kept: {error}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run everything, print the table, and write it to its page."""
    chosen = read_arguments(arguments)
    chosen.store.mkdir(mode=0o700, parents=True, exist_ok=True)
    os.environ["LTCGEAR_CACHE"] = str(chosen.store.resolve())
    os.environ["MPLBACKEND"] = "Agg"
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    table, findings, began = HEAD, list[dict[str, Any]](), perf_counter()
    counts: dict[str, Counter[str]] = {}
    from .base import prepare

    prepare(few=chosen.part < 1)
    for name in chosen.only or KINDS:
        clock, found = perf_counter(), Counter[str]()
        for finding, again in assault(name, chosen, lambda done, total, name=name: _show(name, done, total)):
            found[finding.verdict.kind] += 1
            if finding.verdict.bad:
                print(f"\r{finding.verdict.kind}: {finding.case.name}: {finding.verdict.note}\n  {again}", flush=True)
                findings.append({"kind": name, "number": finding.number, "case": finding.case.name, "again": again,
                                 "verdict": finding.verdict.kind, "note": finding.verdict.note})  # fmt: skip
            elif finding.verdict.kind == "skipped":
                print(f"\rskipped: {finding.case.name}: {finding.verdict.note}", flush=True)
        row = [str(found[kind] or "-") for kind in (*WELL, *BAD)]
        table += f"| {name} | {found.total()} | {' | '.join(row)} | {perf_counter() - clock:.0f} |\n"
        print(f"\r{table.splitlines()[-1]}", flush=True)
        counts[name] = found
    print(f"\n{table}\n{perf_counter() - began:.0f} s, seed {chosen.seed}")
    if chosen.json:
        chosen.json.write_text(json.dumps({"counts": counts, "findings": findings}), "utf-8")
    elif not chosen.only and not chosen.case and chosen.part == 1 and not findings:
        from benchmarks.marks import put

        put(
            PAGE,
            {"torture": f"{table}\nSeed {chosen.seed}; {perf_counter() - began:.0f} s on {chosen.workers} cores.\n"},
        )
    return 1 if findings else 0


def _show(name: str, done: int, total: int) -> None:
    """Show how far a kind of attack is, on a terminal."""
    if sys.stderr.isatty():
        print(f"\r{name}: {done}/{total}", end="", file=sys.stderr, flush=True)
