"""Hard cases: all pass by every method in their short form, or are refused with the reason."""

import re

import pytest
from ltcgear.runtime.cli.testing import open_bench
from ltcgear.runtime.simulation.methods.registry import METHODS
from ltcgear.runtime.studies.selftest.cases import CASES as LISTED
from ltcgear.runtime.studies.selftest.suite import run_case

CASES = {case.name: case for case in LISTED}
REFUSALS = {
    ("tiny-inertia", "adams"): r"adams is not for stiff models: speck \(u\) .* use --method rosenbrock",
    ("tiny-inertia-long", "erk"): r"erk would need about \de\+\d+ steps: speck \(u\) .* use --method rosenbrock",
    ("tiny-inertia-long", "adams"): r"adams is not for stiff models: speck \(u\) .* use --method rosenbrock",
    ("tiny-inertia-long", "idas"): r"idas stopped at t = 0 s .*try another --method",
}
"""Case and method -> the reason, where a refusal is the right answer."""
STOPPED = ("closing",)
"""Cases whose run is to stop, so that nothing is counted."""
LONG = ("closing", "wrap", "in-phase", "on-output", "dead-band", "no-damping")
LEFT = {(name, "sundae"): "long in Python called back at each step; `ltcgear selftest` runs it" for name in LONG}
"""What is not run here, and why."""
PAIRS = [(name, method) for name, case in CASES.items() for method in (METHODS if case.integrates else ("-",))]


@pytest.mark.parametrize(("name", "method"), [pair for pair in PAIRS if pair not in LEFT])
def test_a_case_passes(name, method):
    outcome = run_case(CASES[name], method, open_bench, full=False)
    expected = REFUSALS.get((name, method))
    assert outcome.verdict == ("refused" if expected else "ok"), outcome.reason
    assert expected is None or re.search(expected, outcome.reason)
    if CASES[name].integrates and not expected and name not in STOPPED:
        assert outcome.counts["steps"] > 5
        assert outcome.seconds > 0
