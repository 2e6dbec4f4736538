"""Faults of a sweep: the machine's, which stop it, and a model's own, which are rows."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager

from ltcgear.generated.errors import LtcgearError, MachineError

from ...simulation.methods.registry import EXHAUSTED

CRASHES = {"SIGSEGV", "SIGABRT", "SIGFPE", "SIGILL"}
"""Signals by which a process ends through what it computes; others come from outside, as where memory runs out."""


def is_machines(error: BaseException) -> bool:
    """Say whether an error is the machine's, which any other point would meet too."""
    return isinstance(error, MachineError | OSError | MemoryError) or EXHAUSTED in str(error)


def describe(error: BaseException) -> str:
    """Return what an error says; of those that are not written for people, the type too."""
    if isinstance(error, LtcgearError):
        return str(error)
    return f"{type(error).__name__}: {error}" if str(error) else f"{type(error).__name__}, out of memory"


@contextmanager
def own_reason(noted: Callable[[str], None] = lambda reason: None) -> Iterator[None]:
    """Continue after a point's own failure, which is reported where it is computed; not after a machine fault."""
    try:
        yield
    except LtcgearError as error:
        if is_machines(error):
            raise
        noted(str(error))


@contextmanager
def stopped_by_machine(advise: Callable[[], str]) -> Iterator[None]:
    """Turn any fault of the machine into one error that ends with the advice of then.

    Raises
    ------
    MachineError
        In place of such a fault.
    """
    try:
        yield
    except Exception as error:
        if not is_machines(error):
            raise
        kind = type(error) if isinstance(error, MachineError) else MachineError
        raise kind(f"{describe(error)}; {advise()}") from error


def is_crash(signals: Iterable[str]) -> bool:
    """Say whether processes that died did so by what they computed; where it is not known they did not."""
    found = set(signals)
    return bool(found) and found <= CRASHES
