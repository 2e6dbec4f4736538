"""Runs of hours are refused before they begin, with what takes so long, for every method; or they are asked for."""

from time import perf_counter

import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.simulation import method_limits
from ltcgear.runtime.simulation.ensemble import simulate_many
from ltcgear.runtime.simulation.methods.registry import AUTO, METHODS
from ltcgear.runtime.simulation.recording import record
from ltcgear.runtime.simulation.simulate import simulate

from ..models import case

OPTIONS = {"t_end": 1.0, "rate": 8192.0}
OWN = [AUTO, *(name for name, method in METHODS.items() if method.package is None)]
FAST, LIGHT = {"reference.speed": 4e13}, {"psh.output.inertia": 2e-10}
STIFF = {"psh.input.bearing.stiffness": 1e20, "psh.input.bearing.damping": 0.0}


class BegunError(Exception):
    """A run is under way."""


def begun(time):
    raise BegunError


@pytest.mark.parametrize("method", OWN)
def test_a_speed_that_no_run_can_follow_is_refused_by_every_method(tmp_path, method):
    c = case("psh")
    values = c.model.values() | FAST
    before = perf_counter()
    with pytest.raises(LtcgearError) as refused:
        simulate(c.library, values, method=method, **OPTIONS)
    assert perf_counter() - before < 10  # hours otherwise
    for words in ("hours", "psh.mesh mesh ", "times a second", "lower the speed", "--long", "long=True"):
        assert words in str(refused.value)
    with pytest.raises(LtcgearError, match="hours"):
        record(c.library, values, tmp_path / "a.nc", method=method, **OPTIONS)
    assert not list(tmp_path.iterdir())
    (other,) = simulate_many(c.library, [values], method=method, **OPTIONS)
    assert other.summary["status"] == str(refused.value)


def test_the_body_that_makes_steps_so_short_is_named_and_the_advice_works():
    c = case("psh")
    options = OPTIONS | {"t_end": 100.0, "rate": 64.0}
    told = r"(psh\.\w+) \(.\) swings at .*use --method rosenbrock, give \1 more inertia or softer springs"
    for change in (STIFF, LIGHT):
        with pytest.raises(LtcgearError, match=told):
            simulate(c.library, c.model.values() | change, method="erk", **options)
    # What is so light shortens the segments of all methods; what is stiff leaves the others alone.
    with pytest.raises(LtcgearError, match=r"hours, .* steps: psh\.output \(u\) swings at .*; give psh\.output more"):
        simulate(c.library, c.model.values() | LIGHT, method="rosenbrock", **options)
    for change, method in ((STIFF, "rosenbrock"), ({}, "erk"), (dict.fromkeys(LIGHT, 1.0), "erk")):
        with pytest.raises(BegunError):
            simulate(c.library, c.model.values() | change, method=method, told=begun, **options)
    with pytest.raises(LtcgearError, match=r"hours, .* steps for accuracy; take a larger --rtol"):
        simulate(c.library, c.model.values(), method="rosenbrock", **options | {"t_end": 1e5, "rate": 1.0})


@pytest.mark.parametrize("method", OWN)
def test_a_long_run_is_told_and_begun_if_it_is_asked_for(method):
    c = case("psh")
    options = OPTIONS | {"t_end": 9e6, "rate": 1.0, "method": method}
    with pytest.raises(LtcgearError, match=r"hours|would need about \de\+\d+ steps"):
        simulate(c.library, c.model.values(), **options)
    with pytest.raises(BegunError):
        simulate(c.library, c.model.values(), long=True, told=begun, **options)


def test_rows_samples_and_turns_count(monkeypatch):
    c = case("hard-dead-band")
    monkeypatch.setattr(method_limits, "LONGEST", 1.0)
    name = "loads.output.torque_over_time"
    rows = [(i * 1e-4, 70.0 + i % 2) for i in range(20_000)]
    tables = dict(c.model.tables) | {name: rows}
    with pytest.raises(LtcgearError, match=rf"2\.0e\+04 rows of {name}; give fewer rows"):
        simulate(c.library, c.model.values(), tables=tables, **OPTIONS)
    with pytest.raises(LtcgearError, match=r"samples; lower the rate"):
        simulate(c.library, c.model.values(), tables=c.model.tables, **OPTIONS | {"rate": 3e6})


def test_the_command_refuses_and_begins_what_it_says(run, refused, monkeypatch):
    monkeypatch.setattr(method_limits, "LONGEST", 1e-4)
    told = refused("simulate", "psh", "--t-end", "0.01")
    assert "--long, or long=True in Python, begins it all the same" in told
    code, out, _ = run("simulate", "psh", "--t-end", "0.01", "--long")
    assert code == 0
    assert "psh" in out
