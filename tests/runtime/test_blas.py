"""Threads of the linear algebra: one while ltcgear sets a run up, the user's number before and after."""

from threading import Barrier, Thread

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.model import blas
from ltcgear.runtime.model.blas import SingleThreaded
from ltcgear.runtime.simulation.simulate import simulate

from .models import case


def counts():
    return [get() for get, _ in blas._libraries()]


@pytest.fixture
def two():
    """Let the libraries use two threads, as a user's program on two cores does."""
    before = counts()
    if not before:
        pytest.skip("neither NumPy nor SciPy has OpenBLAS from a wheel")
    blas._set([2] * len(before))
    yield
    blas._set(before)


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


def test_threads_that_overlap_restore_what_was(two):
    first, second = Barrier(2), Barrier(2)

    def early():
        with SingleThreaded():
            first.wait()
        second.wait()

    thread = Thread(target=early)
    thread.start()
    with SingleThreaded():
        first.wait()
        second.wait()
        assert set(counts()) == {1}
    thread.join()
    assert set(counts()) == {2}
