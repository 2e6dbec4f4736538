"""What all tests share: the command line, and a store of their own, so that nothing touches the user's cache."""

import json
import os
import signal
import sys
from pathlib import Path

import pytest
from ltcgear.generated.compiler import MORE_FLAGS
from ltcgear.runtime.cli import commands

os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # hundreds of programs are started; none compiles all modules again


@pytest.fixture(autouse=True, scope="session")
def store(tmp_path_factory):
    """Point LTCGEAR_CACHE to a private folder; one for all workers of a session, so that each model is compiled once.

    LTCGEAR_TEST_STORE names one that sessions under other arithmetic share.
    """
    shared, base = os.environ.get("LTCGEAR_TEST_STORE"), tmp_path_factory.getbasetemp()
    private = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "ltcgear-cache"
    folder = Path(shared) if shared else private
    folder.mkdir(mode=0o700, exist_ok=True)
    folder.chmod(0o700)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LTCGEAR_CACHE", str(folder))
        yield folder


@pytest.fixture(autouse=True, scope="session")
def flags():
    """Compile with -O1, in about half the time; what is told of -O3 stands in benchmarks and in ``shipped_flags``."""
    with pytest.MonkeyPatch.context() as patch:
        if MORE_FLAGS not in os.environ:
            patch.setenv(MORE_FLAGS, "-O1")
        yield


@pytest.fixture
def shipped_flags(monkeypatch):
    """Compile as users do."""
    if os.environ.get(MORE_FLAGS) == "-O1":
        monkeypatch.delenv(MORE_FLAGS)


@pytest.fixture(autouse=True, scope="session")
def interrupts():
    """Let Ctrl-C stop the tests and the programs that they start, also where a shell has it ignored (nohup, or `&`)."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture(autouse=True, scope="session")
def disks():
    """Wait for no disk: tests have no power cuts."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", lambda handle: None)
        yield


@pytest.fixture
def run(monkeypatch, capsys):
    """Run a command line in this process; return exit code, stdout and stderr."""

    def runner(*arguments):
        monkeypatch.setattr(sys, "argv", ["ltcgear", *map(str, arguments)])
        capsys.readouterr()
        try:
            commands.main()
            code = 0
        except SystemExit as stop:
            code = stop.code or 0
        out, err = capsys.readouterr()
        assert "Traceback" not in out + err
        return code, out, err

    return runner


@pytest.fixture
def data(run):
    """Run a command with --json; return its object, which must be all that stdout holds."""

    def runner(*arguments, code=0):
        found, out, err = run(*arguments, "--json")
        assert found == code, err
        assert len(out.splitlines()) == 1
        shown = json.loads(out, parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))
        assert isinstance(shown, dict)
        return shown

    return runner


@pytest.fixture
def refused(run):
    """Run a command that must fail; return its message. Nothing may be on stdout."""

    def runner(*arguments, code=2):
        found, out, err = run(*arguments)
        assert (found, out) == (code, ""), (out, err)
        assert err.strip()
        return err

    return runner
