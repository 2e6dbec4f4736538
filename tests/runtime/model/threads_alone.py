"""Threads of the linear algebra: one while ltcgear sets a run up, the user's number before and after."""

from threading import Event, Thread

import numpy as np
import pytest
import scipy.linalg  # noqa: F401  # its BLAS is there from the beginning, so that the program may set its threads
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.model.blas import single_threaded
from ltcgear.runtime.simulation.simulate import simulate
from threadpoolctl import threadpool_info, threadpool_limits

from ..models import case


def counts():
    return [library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"]


def set_threads(count):
    """Set the number for the process; a thread that sets it keeps others from it as long as it lives."""
    thread = Thread(target=threadpool_limits, args=(count, "blas"))
    thread.start()
    thread.join()


@pytest.fixture
def two():
    """Let the libraries use two threads, as a user's program on two cores does."""
    before = counts()
    set_threads(2)
    if set(counts()) != {2}:
        pytest.skip("this BLAS has one thread")
    yield
    set_threads(before[0])


def test_a_set_up_has_one_thread_and_the_program_keeps_its_own(two, monkeypatch):
    seen, eig = [], np.linalg.eig

    def watch(matrix):
        seen.append(counts())
        return eig(matrix)

    c = case("psh")
    monkeypatch.setattr(np.linalg, "eig", watch)
    simulate(c.library, c.model.values(), t_end=0.01)
    assert seen
    assert {count for each in seen for count in each} == {1}
    assert set(counts()) == {2}
    with pytest.raises(LtcgearError):
        simulate(c.library, c.model.values(), t_end=9e6, method="erk", rate=1.0)
    assert set(counts()) == {2}


def test_set_ups_in_threads_follow_each_other_and_restore_what_was(two):
    begun, seen = Event(), []

    @single_threaded()
    def late():
        seen.append(set(counts()))

    def start():
        begun.set()
        late()

    thread = Thread(target=start)
    with single_threaded():
        thread.start()
        begun.wait()
        with single_threaded():
            assert set(counts()) == {1}
        assert (set(counts()), seen) == ({1}, [])
    thread.join()
    assert seen == [{1}]
    assert set(counts()) == {2}
