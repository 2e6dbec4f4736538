"""Streams that are full, closed or know few characters."""

import io
import os
import subprocess
import sys

import pytest
from ltcgear.runtime.cli import commands
from ltcgear.runtime.cli.streams import Outlet


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
