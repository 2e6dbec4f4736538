"""Self-test suite: every hard case by every method."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from multiprocessing import get_context
from time import perf_counter
from typing import Any

from ltcgear.generated.errors import LtcgearError, MachineError

from ...simulation.trajectory import Counts, Trajectory
from .case import Bench, Finding, HardCase, Open

OK, SLOW, WRONG, REFUSED = VERDICTS = ("ok", "slow", "wrong", "refused")
SLOWER = 30.0
"""A right method is slow if it takes more than this many times the seconds of the fastest right one."""
NO_METHOD = "-"
"""Placeholder for the method of a case without integration."""


@dataclass(frozen=True)
class CaseOutcome:
    """What a case found with one method.

    Attributes
    ----------
    method
        A key of ``METHODS``, or ``-``.
    verdict
        ``ok``; ``slow``: right, but 30 times slower than the fastest that is right; ``wrong``: a finding is above its
        limit or not a number, or something failed that should not; ``refused``: with a reason.
    findings
        Numbers with their limits.
    reason
        Why it is wrong or refused.
    seconds
        Time of its integrations [s]; of the whole case where it integrates nothing.
    counts
        Steps and calls of its integrations, added up.
    """

    method: str
    verdict: str
    findings: tuple[Finding, ...]
    reason: str
    seconds: float
    counts: dict[str, int]


@dataclass
class _Spent:
    """What the integrations of one case and method have taken so far."""

    seconds: float = 0.0
    counts: Counts = field(default_factory=Counts)


@dataclass(frozen=True)
class _Watched(Bench):
    """A bench whose integrations are added up."""

    spent: _Spent = field(default_factory=_Spent)

    def run(self, method: str, **options: Any) -> Trajectory:  # noqa: ANN401
        """Integrate and note what it took."""
        path = super().run(method, **options)
        self.spent.seconds += path.seconds["integrate"]
        for name, value in asdict(path.counts).items():
            setattr(self.spent.counts, name, getattr(self.spent.counts, name) + value)
        return path


def run_case(case: HardCase, method: str, open_: Open, full: bool) -> CaseOutcome:
    """Run one case with one method; never raises for what the case meets."""
    spent, clock = _Spent(), perf_counter()
    found: list[Finding] = []

    def watched(name: str, changes: Mapping[str, str]) -> Bench:
        bench = open_(name, changes)
        return _Watched(bench.library, bench.values, bench.tables, spent)

    verdict, reason = OK, ""
    try:
        found += case.check(watched, method, full)
    except MachineError:
        raise
    except LtcgearError as error:
        verdict, reason = REFUSED, str(error)
    except Exception as error:  # whatever a case meets that was not foreseen is its finding
        verdict, reason = WRONG, f"{type(error).__name__}: {error}"
    if verdict == OK:
        verdict, reason = _judge(found)
    seconds = spent.seconds if case.integrates else perf_counter() - clock
    plain = tuple(Finding(item.what, float(item.value), float(item.limit)) for item in found)
    return CaseOutcome(method, verdict, plain, reason, seconds, asdict(spent.counts))


def _judge(found: Sequence[Finding]) -> tuple[str, str]:
    """Return verdict and reason of what was found."""
    off = [f"{item.what}: {item.value:.3g}, {item.limit:.3g} at most" for item in found if not item.right]
    if not found:
        off = ["the case found nothing to judge by"]
    return (WRONG, "; ".join(off)) if off else (OK, "")


def with_slow(outcomes: Iterable[CaseOutcome]) -> tuple[CaseOutcome, ...]:
    """Return a case's outcomes, those marked that are right but far slower than the fastest right one."""
    kept = tuple(outcomes)
    fastest = min((item.seconds for item in kept if item.verdict == OK), default=0.0)
    late = f"more than {SLOWER:.0f} times the time of the fastest method that is right"
    return tuple(
        replace(item, verdict=SLOW, reason=late) if item.verdict == OK and item.seconds > SLOWER * fastest else item
        for item in kept
    )


def run_suite(
    cases: Sequence[HardCase], methods: Sequence[str], open_: Open, *, full: bool = False, workers: int = 1,
    told: Callable[[float], None] = lambda done: None,
) -> dict[str, Any]:  # fmt: skip
    """Run cases with methods.

    Parameters
    ----------
    cases
        The cases; those that integrate nothing are run once.
    methods
        Keys of ``METHODS``.
    open_
        Opens a scene; with more than one worker it and the cases' checks must be functions of a module.
    full
        Whether the long form is wanted.
    workers
        Processes at work.
    told
        Called with the number of runs that are done.

    Returns
    -------
    dict
        ``passed`` and ``cases`` with their ``results``, as ``ltcgear selftest --json`` prints them.
    """
    jobs = [(i, method) for i, case in enumerate(cases) for method in (methods if case.integrates else [NO_METHOD])]
    work = [partial(run_case, cases[i], method, open_, full) for i, method in jobs]
    if workers < 2:
        outcomes = _in_turn(work, told)
    else:
        futures = _side_by_side(work, workers, told)
        outcomes = [outcome_of(future, method) for future, (_, method) in zip(futures, jobs, strict=True)]
    shown = []
    for i, case in enumerate(cases):
        own = with_slow(outcome for (k, _), outcome in zip(jobs, outcomes, strict=True) if k == i)
        results = [asdict(outcome) for outcome in own]
        shown.append({"name": case.name, "title": case.title, "passes": case.passes, "results": results})
    passed = all(outcome.verdict != WRONG for outcome in outcomes)
    return {"passed": passed, "full": full, "cases": shown}


Work = Sequence[Callable[[], CaseOutcome]]


def _in_turn(work: Work, told: Callable[[float], None]) -> list[CaseOutcome]:
    """Run one after another."""
    outcomes = []
    for job in work:
        outcomes.append(job())
        told(len(outcomes))
    return outcomes


def _side_by_side(work: Work, workers: int, told: Callable[[float], None]) -> list[Future[CaseOutcome]]:
    """Run in fresh processes, so that nothing of an integrator's memory is shared."""
    with ProcessPoolExecutor(workers, get_context("spawn")) as pool:
        futures = [pool.submit(job) for job in work]
        try:
            for done, _ in enumerate(as_completed(futures), start=1):
                told(done)
        except KeyboardInterrupt:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
        return futures


def outcome_of(future: Future[CaseOutcome], method: str) -> CaseOutcome:
    """Return what a process found; one that died found its case wrong, and so did those that waited for it."""
    try:
        return future.result()
    except BrokenProcessPool:
        return CaseOutcome(method, WRONG, (), "a process died on the way; run cases and methods one by one", 0.0, {})
