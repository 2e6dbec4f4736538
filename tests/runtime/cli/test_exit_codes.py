"""Exit codes: help, bad input, the installed program, an interrupt; one message and no traceback."""

import os
import signal
import subprocess
import sys
from pathlib import Path
from time import sleep

import pytest


def test_help_and_no_command(run):
    assert run("--help")[0] == 0
    for command in ("scenes", "effects", "info", "check", "generate", "simulate", "modes", "cost"):
        code, out, _ = run(command, "--help")
        assert code == 0
        assert "--json" in out
    out = " ".join(run("simulate", "--help")[1].split())
    for text in ("Time to simulate [s].", "default: auto", "default: 1e-06", "simulation.t_end of the scene"):
        assert text in out


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["nosuch"], "No such command"),
        (["info"], "Missing argument"),
        (["info", "lsp", "hsp"], "unexpected extra argument"),
        (["info", "lsp", "--nosuch"], "No such option"),
        (["scenes", "lsp"], "unexpected extra argument"),
        (["simulate", "lsp", "--t-end", "soon"], "--t-end"),
        (["simulate", "lsp", "--rtol"], "requires an argument"),
        (["check"], "give a SCENE, or --paper"),
        (["check", "lsp", "--paper"], "both lsp and --paper were given"),
        (["paper", "--t-end", "0.0005"], "need 0.2 s at least"),
        (["paper", "--t-end", "nan"], "need 0.2 s at least"),
        (["check", "nosuch"], "nosuch: no such file"),
        (["info", "rig2mw"], 'did you mean "rig-2mw"?'),
        (["modes", "nosuch"], "shipped scenes: "),
        (["generate", "nosuch"], "no such file"),
        (["simulate", "nosuch"], "no such file"),
        (["simulate", "lsp", "--method", "rk4"], 'did you mean "erk"?'),
        (["simulate", "lsp", "--method", "ode45"], "method 'ode45': unknown"),
        (["simulate", "lsp", "--method", ""], "method '': unknown"),
        (["simulate", "lsp", "--rtol", "0"], "must lie between"),
        (["simulate", "lsp", "--rtol", "1"], "must lie between"),
        (["simulate", "lsp", "--rtol", "-1e-6"], "must lie between"),
        (["simulate", "lsp", "--rtol", "nan"], "must lie between"),
        (["simulate", "lsp", "--t-end", "0"], "t_end 0: must"),
        (["simulate", "lsp", "--t-end", "-1"], "t_end -1: must"),
        (["simulate", "lsp", "--t-end", "nan"], "t_end nan: must"),
        (["simulate", "lsp", "--t-end", "inf"], "t_end inf: must"),
        (["simulate", "lsp", "--resume"], "say which result is to go on, -o FILE.nc"),
        (["cost", "lsp", "--t-end", "0"], "t_end 0: must"),
        (["cost", "lsp", "--rtol", "1"], "must lie between"),
        (["cost", "lsp", "-o", "cost.jpg"], "name it cost.png"),
        (["cost", "nosuch"], "no such file"),
        (["info", "lsp", "--set"], "requires an argument"),
        (["info", "lsp", "--set", "foo"], "write KEY=VALUE"),
        (["info", "lsp", "--set", "=3"], "write KEY=VALUE"),
        (["info", "lsp", "--set", "effects.mesh_law=papre"], 'did you mean "paper"?'),
        (["info", "lsp", "--set", "stages.lsp.modul=16 mm"], 'did you mean "module"?'),
        (["info", "lsp", "--set", "stages.lsp.module=16"], 'write it like "16 mm"'),
        (["info", "lsp", "--set", "title.x=1"], "is a value, not a table"),
        (["info", "lsp", "--set", "x=" + "[" * 50_000], "unknown key"),
        (["modes", "lsp", "--set", "a" + ".a" * 3000 + "=1"], "nested too deeply"),
        (["check", "lsp", "--set", "x=" + "9" * 6000], "unknown key"),
    ],
    ids=lambda value: " ".join(value)[:60] if isinstance(value, list) else "",
)
@pytest.mark.parametrize("more", [[], ["--json"]], ids=["", "json"])
def test_bad_input_is_exit_code_2(refused, arguments, reason, more):
    if more and arguments[-1] in ("--set", "--rtol"):
        pytest.skip("the option would take --json for its value")
    assert reason in " ".join(refused(*arguments, *more).split())


@pytest.mark.parametrize(
    ("arguments", "code"), [(["scenes", "--json"], 0), (["info", "nosuch", "--json"], 2), (["nosuch"], 2)]
)
def test_the_installed_program(arguments, code):
    program = Path(sys.executable).with_name("ltcgear")
    done = subprocess.run([program, *arguments], capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == code
    assert "Traceback" not in done.stdout + done.stderr
    assert bool(done.stdout) is (code == 0)
    assert bool(done.stderr) is (code != 0)


STARTED = """
import sys
from ltcgear.runtime.cli import commands
sys.argv = ["ltcgear", *sys.argv[1:]]
module = sys.modules["ltcgear.runtime.cli.app"]
app = module.app
def started(**options):  # what comes before is the interpreter's own
    print("ready", flush=True)
    return app(**options)
module.app = started
commands.main()
"""


@pytest.mark.parametrize("delay", [0.0, 3.0], ids=["while it starts", "while it integrates"])
def test_control_c_is_exit_code_130(delay):
    command = [sys.executable, "-c", STARTED, "simulate", "lsp", "--t-end", "1000", "--set", "simulation.rate=100 Hz"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as program:
        assert program.stdout is not None
        assert program.stdout.readline() == "ready\n"
        sleep(delay)
        os.kill(program.pid, signal.SIGINT)
        _, err = program.communicate(timeout=60)
    assert program.returncode == 130
    assert len(err.splitlines()) == 1
    assert err.startswith("ltcgear: ")
