"""Hard cases: each sees what is broken, and the suite judges well (test_hard_methods.py has them pass)."""

import json
import sys
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError, MachineError
from ltcgear.runtime.cli import commands
from ltcgear.runtime.cli.testing import open_bench
from ltcgear.runtime.model import cstruct
from ltcgear.runtime.studies.selftest import case as bench_module
from ltcgear.runtime.studies.selftest import cases as all_cases
from ltcgear.runtime.studies.selftest.case import Finding, HardCase
from ltcgear.runtime.studies.selftest.suite import outcome_of, run_case, run_suite, with_slow
from ltcgear.runtime.view.tables.selftest_tables import draw_matrix, make_table

CASES = {case.name: case for case in all_cases.CASES}

# --- each case sees what is broken


@pytest.fixture
def lazy(monkeypatch):
    """A march whose first level never changes."""
    text = cstruct.source()
    right, wrong = "m->s[i] = (double)(m->cells[i] & 1)", "m->s[i] = i ? (double)(m->cells[i] & 1) : 0"
    assert text.count(right) == 1
    monkeypatch.setattr(cstruct, "source", lambda: text.replace(right, wrong))
    cstruct.engine.cache_clear()
    yield
    cstruct.engine.cache_clear()


def changed(**changes):
    """An opener that puts other values than the case asks for."""
    return lambda name, wanted: open_bench(name, {**wanted, **changes})


@pytest.mark.parametrize("name", ["jumps", "in-phase", "on-output"])
def test_a_mesh_that_does_not_switch_is_seen(lazy, name):
    outcome = run_case(CASES[name], "erk", open_bench, full=False)
    assert outcome.verdict == "wrong"
    assert "wrong contact" in outcome.reason


def test_a_lost_jump_is_seen(monkeypatch):
    run = bench_module.Bench.run

    def losing(self, method, **options):
        path = run(self, method, **options)
        path.counts.events -= 1
        return path

    monkeypatch.setattr(bench_module.Bench, "run", losing)
    for name in ("jumps", "in-phase", "on-output", "whole-contact-ratio"):
        outcome = run_case(CASES[name], "erk", open_bench, full=False)
        lost = [finding for finding in outcome.findings if "jumps" in finding.what and not finding.right]
        assert lost or name == "whole-contact-ratio", name


@pytest.mark.parametrize(("name", "method"), [("jumps", "cvodes"), ("parametric", "idas"), ("no-damping", "erk")])
def test_a_coarse_tolerance_is_seen(monkeypatch, name, method):
    run = bench_module.Bench.run
    coarse = {"jumps": 1e-8, "parametric": 1e-3, "no-damping": 1e-7}[name]
    monkeypatch.setattr(
        bench_module.Bench, "run", lambda self, m, **options: run(self, m, **options | {"rtol": coarse})
    )
    assert run_case(CASES[name], method, open_bench, full=False).verdict == "wrong"


def test_weight_on_orbiting_planets_is_seen():
    opener = changed(**{"effects.gravity": "on"})
    outcome = run_case(CASES["wrap"], "erk", opener, full=False)
    assert "mesh forces" in outcome.reason


def test_another_contact_ratio_is_seen():
    def opener(name, wanted):
        ratio = wanted["stages.psh.mesh.contact_ratio"]
        return open_bench(name, {**wanted, "stages.psh.mesh.contact_ratio": {"1": "1.01"}.get(ratio, ratio)})

    outcome = run_case(CASES["whole-contact-ratio"], "erk", opener, full=False)
    assert [finding.right for finding in outcome.findings] == [False, False, True, True]


def test_a_rerun_that_differs_in_one_bit_is_seen(monkeypatch):
    made = iter([0.0, np.finfo(float).eps])
    integrate = bench_module.integrate

    def noisy(*arguments, **options):
        path = integrate(*arguments, **options)
        path.x[-1, 0] *= 1 + next(made)
        return path

    monkeypatch.setattr(bench_module, "integrate", noisy)
    assert "numbers that differ: 1" in run_case(CASES["rerun"], "erk", open_bench, full=False).reason


# --- how the suite judges


def made(name, *findings, error=None, **options):
    def check(open_, method, full):
        yield from findings
        if error is not None:
            raise error

    return HardCase(name, f"title of {name}", f"what {name} must show", check, **options)


def judged(case):
    return run_case(case, "erk", open_bench, full=False)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), 1.5])
def test_what_is_above_its_limit_or_no_number_is_wrong(value):
    outcome = judged(made("a", Finding("fine", 0.0, 0.0), Finding("force", value, 1.0)))
    assert outcome.verdict == "wrong"
    assert outcome.reason == f"force: {value:.3g}, 1 at most"


def test_a_case_that_finds_nothing_is_wrong():
    assert judged(made("a")).verdict == "wrong"


def test_an_error_of_ours_is_a_refusal_with_its_reason():
    outcome = judged(made("a", Finding("force", 0.5, 1.0), error=LtcgearError("give a bearing")))
    assert (outcome.verdict, outcome.reason) == ("refused", "give a bearing")


def test_a_fault_of_the_machine_is_no_finding():
    with pytest.raises(MachineError, match="no room"):
        judged(made("a", Finding("force", 0.5, 1.0), error=MachineError("no room")))


def test_any_other_error_is_wrong_with_its_text():
    outcome = judged(made("a", Finding("force", 0.5, 1.0), error=ZeroDivisionError("by zero")))
    assert (outcome.verdict, outcome.reason) == ("wrong", "ZeroDivisionError: by zero")


def test_right_but_far_slower_than_another_right_one_is_slow():
    outcomes = [
        replace(judged(made("a", Finding("force", 0.5, limit))), method=method, seconds=seconds)
        for method, seconds, limit in (("quick", 0.1, 0.1), ("one", 1.0, 1.0), ("two", 29.0, 1.0), ("three", 31.0, 1.0))
    ]
    found = with_slow(outcomes)
    # The quickest is wrong and sets no pace.
    assert [item.verdict for item in found] == ["wrong", "ok", "ok", "slow"]
    assert "30 times" in found[3].reason


def test_a_process_that_dies_is_wrong():
    future = Future()
    future.set_exception(BrokenProcessPool("died"))
    assert outcome_of(future, "idas").verdict == "wrong"


def test_what_integrates_nothing_is_run_once_and_one_wrong_result_fails_all():
    good, bad = Finding("force", 0.5, 1.0), Finding("force", 2.0, 1.0)
    still, two = made("still", good, integrates=False), made("two", good)
    told = []
    data = run_suite([still, two], ["erk", "idas"], open_bench, told=told.append)
    assert data["passed"]
    assert [[result["method"] for result in case["results"]] for case in data["cases"]] == [["-"], ["erk", "idas"]]
    assert told == [1, 2, 3]
    assert not run_suite([still, made("three", bad)], ["erk"], open_bench)["passed"]


def test_what_runs_cost_is_added_up():
    def check(open_, method, full):
        bench = open_("psh", {})
        paths = [bench.run(method, t_end=0.01, rate=1000.0, rtol=1e-6) for _ in range(2)]
        steps.append(sum(path.counts.steps for path in paths))
        yield Finding("none", 0.0, 0.0)

    steps = []
    outcome = judged(HardCase("a", "", "", check))
    assert outcome.counts["steps"] == steps[0] > 0
    assert outcome.counts["events"] > 0


# --- table, figure, command


def test_table_and_figure_show_every_verdict(tmp_path):
    cases = [
        made("good", Finding("force", 0.5, 1.0)),
        made("bad", Finding("force", float("nan"), 1.0)),
        made("never", error=LtcgearError("give a bearing")),
        made("still", Finding("force", 0.0, 0.0), integrates=False),
    ]
    data = run_suite(cases, ["erk", "idas"], open_bench)
    table = make_table(data)
    assert table.columns == ("case", "erk", "idas")
    assert [row[1] for row in table.rows] == ["ok\n0.5/1", "wrong\nnan/1", "refused", "ok\n0/0"]
    assert any("never, erk, idas: refused: give a bearing" in note for note in table.notes)
    assert draw_matrix(data, tmp_path / "matrix.png").stat().st_size > 1000


@pytest.fixture
def command(monkeypatch, capsys):
    """Run a command line; return exit code, stdout and stderr."""

    def runner(*arguments):
        monkeypatch.setattr(sys, "argv", ["ltcgear", *arguments])
        with pytest.raises(SystemExit) as stop:
            commands.main()
        out, err = capsys.readouterr()
        return stop.value.code or 0, out, err

    return runner


def test_the_command_runs_cases_side_by_side(command):
    code, out, _ = command("selftest", "--case", "rerun", "--method", "erk", "--method", "cvodes", "--json")
    data = json.loads(out)
    assert code == 0
    assert data["passed"] is True
    assert [case["name"] for case in data["cases"]] == ["rerun"]
    assert [result["method"] for result in data["cases"][0]["results"]] == ["erk", "cvodes"]
    result = data["cases"][0]["results"][0]
    assert set(result) == {"method", "verdict", "findings", "reason", "seconds", "counts"}
    assert set(result["findings"][0]) == {"what", "value", "limit"}


def test_the_command_fails_where_something_is_wrong(command, monkeypatch, tmp_path):
    monkeypatch.setattr(all_cases, "CASES", (made("bad", Finding("force", float("nan"), 1.0)),))
    figure = tmp_path / "matrix.svg"
    code, out, _ = command("selftest", "--method", "erk", "--json", "-o", str(figure))
    assert code == 1
    assert json.loads(out)["cases"][0]["results"][0]["findings"] == [{"what": "force", "value": None, "limit": 1.0}]
    assert figure.exists()
    code, out, _ = command("selftest", "--method", "erk")
    assert code == 1
    assert "wrong" in out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [(("--case", "jump"), 'did you mean "jumps"?'), (("--method", "euler"), "--method 'euler': unknown")],
)
def test_unknown_names_are_refused(command, arguments, words):
    code, out, err = command("selftest", *arguments)
    assert (code, out) == (2, "")
    assert words in err
    assert len(err.splitlines()) == 1
