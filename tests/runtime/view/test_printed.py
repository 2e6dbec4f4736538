"""Printed text: control characters of scenes and files are written out, and any width shows every number."""

import pytest
from ltcgear.runtime.results.table import Table
from ltcgear.runtime.view.tables import mode_tables, printed, resonance_tables, scene_tables

EVIL = "\x1b]0;owned\x07\x1b[2J\x9b31mred\u202egnp.\u2066x\x08\x7f[bold]\ud800"
ACTS = ("\x1b", "\x07", "\x9b", "\u202e", "\u2066", "\x08", "\x7f", "\ud800")


def refuse_acts(text):
    assert not [code for code in ACTS if code in text]
    assert "[bold]" in text


def simulated(text):
    return {
        "forces": {text: {"mean": 1.0, "min": 1.0, "max": 1.0, "load_factor": 1.0}}, "warnings": [text],
        "counts": dict.fromkeys(("steps", "rhs", "jacobian", "events", "expected_events"), 1), "method": "erk",
        "engine": "compiled C", "rtol": 1e-6, "simulated_s": 1.0, "real_time_factor": 1.0, "energy_residual": 0.0,
        "seconds": {"integrate": 1.0}, "why": text, "rate_hz": 1.0, "why_rate": text,
        "accuracy": {"reason": text},
    }  # fmt: skip


def shown_by(present_it, capsys):
    capsys.readouterr()
    present_it()
    return capsys.readouterr().out


def test_no_command_prints_what_acts(capsys):
    table = Table(EVIL, (EVIL, "b"), ((EVIL, 1.0),), (EVIL,))
    analysed = {"file": EVIL, "scene": EVIL, "from_s": 0.0, "to_s": 1.0, "notes": [EVIL]}
    verdict = {"equation": "1", "row": EVIL, "verdict": "misprint", "printed": EVIL, "derived": EVIL, "why": EVIL}
    mode = {"frequency_hz": 1.0, "damping_ratio": 0.0, "class": "a", "multiplicity": 1, "name": EVIL, "members": {}}
    check = {"name": EVIL, "note": EVIL, "passed": False, "value": 1.0, "tolerance": 1.0}
    crossing = {"crossing": EVIL, "at": 1.0, "frequency_hz": 1.0, "margin": 0.0, "force_per_um": 1.0, "force": 1.0}
    campbell = {"axis": "load", "crossings": [crossing | {"modes": [1]}], "modes": [mode | {"mode": 1}], "orders": [1]}
    campbell |= {"values": [0.0, 1.0], "unit": "1", "home": 1.0}
    book = {"chapters": [], "checks": {"passed": 1, "failed": 0}, "paper": {}, "bytes": 1, "equations": 1}
    variant = {
        "effect": "a",
        "value": "b",
        "without": "c",
        "reason": EVIL,
        "states": 1,
        "ops": {"rhs": 1, "jacobian": 1},
    }
    variant |= {"ns_call": None, "seconds_per_simulated_second": None, "counts": {}}
    variant |= {"changes": dict.fromkeys(("rms", "peak", "share", "spectrum"))}
    modes = {"meshes": "mean", "modes": [mode], "lowest": False, "freedoms": 1, "files": [EVIL]}
    for presented in (
        lambda: printed.listed(scene_tables.list_scenes({"scenes": [{"name": "a", "title": EVIL}]})),
        lambda: printed.simulated(simulated(EVIL)),
        lambda: printed.analysed(analysed, [table], [EVIL]),
        lambda: printed.paper_verdicts({"equations": [verdict]}),
        lambda: printed.listed(scene_tables.list_checks({"checks": [check]})),
        lambda: printed.generated({"files": [EVIL], "library": EVIL, "ops": {EVIL: 1}, "seconds": {}}),
        lambda: printed.listed(mode_tables.tabulate_modes(modes, {name: name for name in mode["members"]}), [EVIL]),
        lambda: printed.listed(resonance_tables.tabulate_crossings(campbell)),
        lambda: printed.listed(scene_tables.list_book(book | {"scene": EVIL, "file": EVIL, "key": EVIL})),
        lambda: printed.costs({"variants": [variant]}),
        table.print,
    ):  # fmt: skip
        refuse_acts("".join(shown_by(presented, capsys).split()))


def test_json_writes_out_what_acts(capsys):
    printed.show(True, {"title": EVIL}, print)
    assert capsys.readouterr().out.isascii()


@pytest.mark.parametrize("columns", ["0", "1", "7", "39", "999999999"])
def test_any_width_shows_every_number(capsys, monkeypatch, columns):
    monkeypatch.setenv("COLUMNS", columns)
    Table("title", ("what", "one [N]", "two [N]", "three [N]"), (("mesh", 11111.0, 22222.0, 33333.0),)).print()
    printed.simulated(simulated("a mesh") | {"accuracy": {"reason": "none"}})
    out = "".join(capsys.readouterr().out.split())
    for digit in "123":
        assert 5 * digit in out
    assert "amesh" in out
