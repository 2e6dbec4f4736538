"""The start of the program: interrupts while it imports, packages and memory that are missing."""

import subprocess
import sys

import pytest

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


@pytest.mark.parametrize("module", ["typer", "rich.padding", "rich.console"])
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
