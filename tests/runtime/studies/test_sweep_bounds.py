"""What `sweep` is asked for is bounded: one message, at once, whatever stands behind --vary and the other options."""

from time import monotonic

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime import sweep
from ltcgear.runtime.studies.sweep import planning
from ltcgear.runtime.studies.sweep.design import draw_design
from ltcgear.runtime.studies.sweep.metrics import find_metric
from ltcgear.runtime.studies.sweep.sweep_axes import MOST, MOST_AXES, MOST_ITEMS, read_axes
from ltcgear.symbolic import Template

LONG = "9" * 10**6
AXES = {
    "key": ([f"{'a' * 10**6}=1:2:3"], "500 characters at most"),
    "key of dots": ([f"{'.'.join(['a'] * 10**5)}=1:2:3"], "500 characters at most"),
    "value": ([f"a={LONG}"], "500 characters at most"),
    "bound": ([f"a=1 rpm:{LONG} rpm:3"], "500 characters at most"),
    "unit": ([f"a=1 {LONG}:2 {LONG}:3"], "500 characters at most"),
    "count": (["a=1:2:1000000000"], "'1000000000' points; give a whole number from 1 to 1000000"),
    "negative count": (["a=1:2:-3"], "'-3' points; give a whole number from 1 to 1000000"),
    "long count": ([f"a=1:2:{LONG}"], "500 characters at most"),
    "no digit": (["a=1:2:²"], "'²' points; give a whole number"),
    "nan": (["a=nan:2:3"], "the bound 'nan' is not finite; give a number"),
    "infinite": (["a=1:1e999:3"], "the bound '1e999' is not finite; give a number"),
    "wide": (["a=-1e308:1e308:3"], "the bound '-1e308' is too large; give one below 1e[+]300"),
    "narrow": (["a=5:5.000000000000001:1000"], "2 different numbers for 1000 points; give fewer points"),
    "list": (
        [f"a={','.join(map(str, range(5000)))}"],
        f"5000 values, a list has {MOST_ITEMS} at most; write NAME=a:b:n",
    ),
    "axes": ([f"a.b{k}=1" for k in range(30000)], f"30000 keys are varied, {MOST_AXES} at most are served; take fewer"),
    "twice": (["a=1:2:3", " a =1,2"], "--vary a: is given 2 times; give each key once"),
}
DRAWS = {
    "grid": ([f"a.b{k}=1:2:1000" for k in range(3)], "grid", None, "1e[+]09 points, 1000000 at most"),
    "lists": ([f"a.b{k}=1,2" for k in range(50)], "grid", None, "1.126e[+]15 points, 1000000 at most"),
    "draws": (["a=1:2"], "lhs", 10**30, "1e[+]30 points, 1000000 at most"),
    "scheme": (["a=1:2"], "saltelli", MOST, "3e[+]06 points, 1000000 at most"),
    "memory": (
        [f"a.b{k}=1:2" for k in range(50)],
        "sobol",
        MOST,
        "1e[+]06 points of 50 keys, 5e[+]07 numbers",
    ),
    "none": (["a=1:2"], "lhs", 0, "--points 0: must be a whole number from 1 on"),
    "negative": (["a=1:2"], "lhs", -3, "--points -3: must be a whole number from 1 on"),
}


@pytest.mark.parametrize("name", AXES)
def test_axes_are_bounded(name):
    texts, reason = AXES[name]
    begin = monotonic()
    with pytest.raises(LtcgearError, match=reason) as caught:
        read_axes(texts)
    assert len(str(caught.value)) < 400
    assert monotonic() - begin < 20


@pytest.mark.parametrize("name", DRAWS)
def test_designs_are_bounded_before_they_are_drawn(name):
    texts, sample, points, reason = DRAWS[name]
    begin = monotonic()
    with pytest.raises(LtcgearError, match=reason):
        draw_design(read_axes(texts), sample, points)
    assert monotonic() - begin < 20


def test_as_many_axes_as_are_served_are_drawn():
    """NumPy's own grids end at 32 dimensions."""
    lists = [f"a.b{k}={k}" for k in range(MOST_AXES - 1)]
    assert draw_design(read_axes([*lists, "c=1:2"]), "lhs", 3).values.shape == (3, MOST_AXES)
    assert draw_design(read_axes([*lists, "c=1:2:3"])).values.shape == (3, MOST_AXES)
    assert draw_design(read_axes([f"a.b{k}=1:2" for k in range(MOST_AXES)]), "sobol", 4).values.shape == (4, MOST_AXES)


def test_bounds_that_are_served_give_finite_points():
    values = draw_design(read_axes(["a=-1e300:1e300"]), "lhs", 50).values
    assert np.isfinite(values).all()


def test_a_name_of_a_metric_is_told_in_short():
    with pytest.raises(LtcgearError, match=r"^--metric x{80}: no such metric; there are forces, "):
        find_metric("x" * 10**5)


def test_each_point_that_is_checked_is_made_once_before_the_runs(tmp_path, monkeypatch):
    made = []

    class Counted(Template):
        def make(self, changes):
            made.append(tuple(changes.items()))
            return super().make(changes)

    class EnoughError(Exception):
        """Ends the sweep before anything is built."""

    def enough(*arguments):
        raise EnoughError

    monkeypatch.setattr(planning, "prepare", enough)
    with pytest.raises(EnoughError):
        sweep(Counted("lsp"), ["loads.ring.speed=5 rpm,6 rpm,7 rpm"], tmp_path / "a.nc", workers=1)
    assert len(made) == len(set(made)) == 3
