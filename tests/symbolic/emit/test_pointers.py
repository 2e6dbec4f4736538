"""The C looks at its pointers once; what a caller leaves out is zero, or written to nowhere."""

import ctypes

import casadi as ca
import numpy as np
import pytest
from ltcgear.generated import store
from ltcgear.symbolic.emit.c_text import c_text
from ltcgear.symbolic.emit.pointers import BODY, READ, WRITE, look_once


@pytest.fixture(scope="module")
def function():
    x, y = ca.SX.sym("x", 3), ca.SX.sym("y", 2)
    return ca.Function("f", [x, y], [ca.vertcat(x[0] + y[1], x[2] * y[0]), ca.sin(x[1]) + y[1]])


@pytest.fixture(scope="module")
def compiled(function):
    if store.compiler() is None:
        pytest.skip("no C compiler here")
    return ctypes.CDLL(str(store.library(c_text([function]), store.compiler()))).f


def called(compiled, arguments, results):
    pointers = [[None if a is None else a.ctypes.data for a in group] for group in (arguments, results)]
    arg, res = ((ctypes.c_void_p * len(group))(*group) for group in pointers)
    assert compiled(arg, res, None, None, 0) == 0
    return results


@pytest.mark.parametrize("given", [(True, True), (True, False), (False, True), (False, False)])
@pytest.mark.parametrize("wanted", [(True, True), (True, False), (False, True), (False, False)])
def test_what_is_left_out(function, compiled, given, wanted):
    values = np.array([0.3, -0.7, 1.9]), np.array([2.5, -4.0])
    arguments = [value if there else None for value, there in zip(values, given, strict=True)]
    empty = [np.full(n, np.nan) if there else None for n, there in zip((2, 1), wanted, strict=True)]
    results = called(compiled, arguments, empty)
    due = function(*(value if there else 0 * value for value, there in zip(values, given, strict=True)))
    for result, value in zip(results, due, strict=True):
        assert result is None or np.abs(result - np.array(value).ravel()).max() <= 1e-15


def test_no_number_is_asked_for_its_pointer(function):
    text = c_text([function])
    assert not READ.search(text)
    assert not WRITE.search(text)
    assert look_once(text) == text
    assert BODY.findall(text)
