"""The program as it is typed: started anew, under an environment and limits of its own."""

import os
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path

from .outcome import Done

PROGRAM = Path(sys.executable).with_name("ltcgear")


def start(
    folder: Path, *arguments: object, environment: Mapping[str, str | None] | None = None, seconds: float = 60.0,
    limits: Callable[[], None] | None = None, redirect: str = "", launcher: tuple[str, ...] = (),
) -> Done:  # fmt: skip
    """Run ltcgear as a shell does.

    Parameters
    ----------
    environment
        Variables that differ from this process's; None takes one away.
    limits
        Called in the program's process before it begins.
    redirect
        What the shell makes of its standard streams, as ``>&-``.
    launcher
        What starts it, in place of its own script.
    """
    settings = {**os.environ, **(environment or {})}
    kept = {name: value for name, value in settings.items() if value is not None}
    command = [*(launcher or (str(PROGRAM),)), *map(str, arguments)]
    began = time.monotonic()
    with subprocess.Popen(
        ["/bin/sh", "-c", f'exec "$@" {redirect}', "sh", *command], cwd=folder, env=kept, stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=limits,
    ) as program:  # fmt: skip
        try:
            out, err = program.communicate(timeout=seconds)
            code: int | None = program.returncode
        except subprocess.TimeoutExpired:
            program.kill()
            out, err = program.communicate()
            code = None
    return Done(code, out.decode(errors="replace"), err.decode(errors="replace"), time.monotonic() - began)
