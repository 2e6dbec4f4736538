"""Text of scenes and files on a terminal, and streams that are full, closed or know few characters."""

import io
import os
import re
import subprocess
import sys

import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.generated.text import LONGEST, shorten, write_out
from ltcgear.runtime.cli import commands
from ltcgear.runtime.cli.machine_faults import find_fault
from ltcgear.runtime.cli.progress import progress
from ltcgear.runtime.cli.streams import Outlet
from ltcgear.runtime.results.table import Table
from ltcgear.runtime.view.tables import book_printed, modes_printed, printed, resonance_printed

EVIL = "\x1b]0;owned\x07\x1b[2J\x9b31mred\u202egnp.\u2066x\x08\x7f[bold]\ud800"
ACTS = ("\x1b", "\x07", "\x9b", "\u202e", "\u2066", "\x08", "\x7f", "\ud800")


def test_what_a_terminal_would_obey_is_written_out():
    shown = write_out(f"a\n{EVIL}µ°")
    assert shown.isprintable()
    assert shown.startswith(r"a\n\x1b]0;owned\x07")
    assert r"\u202e" in shown
    assert shown.endswith("µ°")
    assert write_out("a\n\x1b", keep="\n") == "a\n\\x1b"
    assert len(shorten("x" * 10_000)) <= LONGEST + 5


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
        lambda: printed.scenes({"scenes": [{"name": "a", "title": EVIL}]}),
        lambda: printed.simulated(simulated(EVIL)),
        lambda: printed.analysed(analysed, [table], [EVIL]),
        lambda: printed.paper_verdicts({"equations": [verdict]}),
        lambda: printed.checks({"checks": [check]}),
        lambda: printed.generated({"files": [EVIL], "library": EVIL, "ops": {EVIL: 1}, "seconds": {}}),
        lambda: modes_printed.modes(modes, {name: name for name in mode["members"]}),
        lambda: resonance_printed.campbell(campbell | {"values": [0.0, 1.0], "unit": "1", "home": 1.0}),
        lambda: book_printed.book(book | {"scene": EVIL, "file": EVIL, "key": EVIL}),
        lambda: printed.costs({"variants": [variant]}),
        table.print,
    ):  # fmt: skip
        refuse_acts("".join(shown_by(presented, capsys).split()))


def test_json_writes_out_what_acts(capsys):
    printed.show(True, {"title": EVIL}, print)
    assert capsys.readouterr().out.isascii()


def test_progress_shows_what_it_is_given_as_text(monkeypatch):
    class Screen(io.StringIO):
        def isatty(self):
            return True

    screen = Screen()
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.setenv("TERM", "xterm")
    with progress(f"sweep [red]{EVIL}", 2, "points") as told:
        told(1, f"note {EVIL}")
    assert "\x1b]0;" not in screen.getvalue()
    assert "\x07" not in screen.getvalue()
    assert "[red]" in screen.getvalue()


@pytest.mark.parametrize("columns", ["0", "1", "7", "39", "999999999"])
def test_any_width_shows_every_number(capsys, monkeypatch, columns):
    monkeypatch.setenv("COLUMNS", columns)
    Table("title", ("what", "one [N]", "two [N]", "three [N]"), (("mesh", 11111.0, 22222.0, 33333.0),)).print()
    printed.simulated(simulated("a mesh") | {"accuracy": {"reason": "none"}})
    out = "".join(capsys.readouterr().out.split())
    for digit in "123":
        assert 5 * digit in out
    assert "amesh" in out


# --- streams


class Full(io.StringIO):
    """A stream on a device that takes nothing."""

    def __init__(self, error):
        super().__init__()
        self.error = error

    def write(self, text):
        raise self.error

    def flush(self):
        raise self.error


def test_a_stream_that_takes_nothing_does_not_stop_a_program():
    full, gone = Outlet(Full(OSError(28, "No space left on device"))), Outlet(Full(BrokenPipeError(32, "Broken pipe")))
    for outlet in (full, gone):
        print("a", file=outlet, flush=True)
    assert full.fault.errno == 28
    assert gone.fault is None


def test_output_without_room_is_told_and_the_code_says_so(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["ltcgear", "scenes", "--json"])
    monkeypatch.setattr(sys, "stdout", Full(OSError(28, "No space left on device")))
    with pytest.raises(SystemExit) as stop:
        commands.main()
    assert stop.value.code == 2
    told = "ltcgear: standard output cannot be written: No space left on device; make room, or send it somewhere else\n"
    assert capsys.readouterr().err == told


def test_a_reader_that_goes_away_changes_nothing(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["ltcgear", "scenes"])
    monkeypatch.setattr(sys, "stdout", Full(BrokenPipeError(32, "Broken pipe")))
    with pytest.raises(SystemExit) as stop:
        commands.main()
    assert (stop.value.code, capsys.readouterr().err) == (0, "")


def test_what_is_printed_to_no_stream_is_told_to_be_lost(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["ltcgear", "scenes"])
    monkeypatch.setattr(sys, "stdout", None)
    with pytest.raises(SystemExit) as stop:
        commands.main()
    told = "ltcgear: standard output cannot be written: it is closed; make room, or send it somewhere else\n"
    assert (stop.value.code, capsys.readouterr().err) == (2, told)


@pytest.mark.parametrize("stream", [Full(OSError(28, "No space left on device")), None])
def test_a_message_that_nobody_takes_leaves_the_code(monkeypatch, stream):
    monkeypatch.setattr(sys, "argv", ["ltcgear", "info", "no-such-scene"])
    monkeypatch.setattr(sys, "stderr", stream)
    with pytest.raises(SystemExit) as stop:
        commands.main()
    assert stop.value.code == 2


ENTRY = [
    sys.executable,
    "-c",
    "import sys\nfrom ltcgear.runtime.cli.entry import main\nsys.argv[0] = 'ltcgear'\nmain()",
]


def test_a_full_device_and_closed_streams_as_a_shell_gives_them():
    with open("/dev/full", "w") as full:  # noqa: PTH123
        ended = subprocess.run([*ENTRY, "scenes"], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert (ended.returncode, ended.stderr.count("\n")) == (2, 1)
    assert "standard output cannot be written: No space left on device" in ended.stderr
    closed = subprocess.run(
        ["sh", "-c", 'exec "$@" <&- >&- 2>&-', "sh", *ENTRY, "info", "no-such-scene"], check=False
    )  # fmt: skip
    assert closed.returncode == 2
    shell = ["sh", "-c", 'exec "$@" >&-', "sh", *ENTRY, "scenes"]
    ended = subprocess.run(shell, stderr=subprocess.PIPE, text=True, check=False)
    assert ended.returncode == 2
    assert "standard output cannot be written: it is closed" in ended.stderr


def test_few_characters_are_enough():
    surroundings = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "PYTHONIOENCODING": "ascii"}
    kept = {name: value for name, value in os.environ.items() if name not in ("TERM", "LANG")}
    ended = subprocess.run([*ENTRY, "effects"], env=kept | surroundings, capture_output=True, check=False)
    assert (ended.returncode, ended.stderr) == (0, b"")
    assert ended.stdout.isascii()


def test_any_argument_can_be_named_in_a_message(run):
    code, _, err = run("info", os.fsdecode(b"caf\xe9\x1b[31m.toml"))
    assert code == 2
    assert r"caf\udce9\x1b[31m.toml" in err
    assert err.endswith("\n")
    assert err.replace("\n", "").isprintable()
    code, _, err = run("nothing\x1b[31m")
    assert (code, "\x1b" in err) == (2, False)


# --- the machine


@pytest.mark.parametrize(
    ("error", "told"),
    [
        (MemoryError(), "out of memory; ask for less at once"),
        (MemoryError("Unable to allocate 7 GiB"), "out of memory: Unable to allocate 7 GiB; ask for less"),
        (RuntimeError("std::bad_alloc"), r"out of memory: std::bad_alloc; .*\(ulimit -v\)"),
        (OSError(12, "Cannot allocate memory"), "out of memory: "),
        (ImportError("a.so: failed to map segment from shared object"), "out of memory: a.so"),
        (FileNotFoundError(2, "No usable temporary directory found in ['/tmp']"), "set TMPDIR to a folder that can"),
        (OSError(28, "No space left on device", "/tmp/x"), "/tmp/x: No space left on device; make room there"),
        (PermissionError(13, "Permission denied", "/x"), "/x: Permission denied; make it readable and writable"),
    ],
)
def test_what_a_machine_lacks_is_one_message(monkeypatch, run, error, told):
    def lacking(**given):
        raise error

    monkeypatch.setattr(printed, "scenes", lacking)
    monkeypatch.setattr(printed, "show", lambda as_json, data, people: lacking())
    code, out, err = run("scenes")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert re.match(f"ltcgear: .*{told}", err)


def test_other_errors_are_not_hidden(monkeypatch):
    assert find_fault(RuntimeError("by us")) is None
    assert find_fault(LtcgearError("by us")) is None


def test_a_temporary_folder_can_be_chosen_as_advised(tmp_path, monkeypatch):
    import tempfile

    monkeypatch.setattr(tempfile, "tempdir", None)
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    assert tempfile.gettempdir() == str(tmp_path)


# --- Ctrl-C


INTERRUPTING = """
import importlib.abc, os, signal, sys
class Hook(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name == "{module}":
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, Hook())
signal.signal(signal.SIGINT, signal.{handler})
from ltcgear.runtime.cli.entry import main
sys.argv = ["ltcgear", "--version"]
main()
"""


@pytest.mark.parametrize("module", ["typer", "rich.table", "rich.console"])
def test_a_stop_while_all_is_imported_is_quiet(module):
    code = INTERRUPTING.format(module=module, handler="default_int_handler")
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout) == (130, "")
    assert ended.stderr == "ltcgear: stopped; no file is half-written\n"


def test_a_stop_that_a_shell_ignores_is_ignored():
    code = INTERRUPTING.format(module="typer", handler="SIG_IGN")
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stderr) == (0, "")


def test_a_package_that_is_missing_is_told(tmp_path):
    (tmp_path / "typer.py").write_text("raise ImportError('typer: failed to map segment from shared object')")
    code = f"import sys; sys.path.insert(0, {str(tmp_path)!r})\nfrom ltcgear.runtime.cli.entry import main\nmain()"
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert ended.returncode == 2
    assert ended.stderr.startswith("ltcgear: cannot be started: typer: failed to map segment")
    assert ended.stderr.count("\n") == 1


def test_a_limit_of_memory_with_which_nothing_loads_is_told():
    limits = "import resource; resource.setrlimit(resource.RLIMIT_AS, (200 << 20, resource.RLIM_INFINITY))\n"
    code = f"{limits}from ltcgear.runtime.cli.entry import main\nmain()"
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=30)
    assert ended.returncode == 2
    assert (
        ended.stderr
        == "ltcgear: cannot be started with 200 MiB of memory; lift its limit (ulimit -v) to 262144 or more\n"
    )
