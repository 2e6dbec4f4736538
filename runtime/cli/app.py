"""Command line application: common options, and errors as one message and an exit code."""

import io
import sys
from typing import Annotated, cast

import typer
from ltcgear.generated.errors import LtcgearError, MachineError
from ltcgear.generated.text import write_out

from ..results.terminal import tell
from .groups import OrderedCommands
from .machine_faults import find_fault
from .streams import outlets

# Plain help: rich would take "[s]" for markup and drop it.
app = typer.Typer(
    cls=OrderedCommands, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 120},
    no_args_is_help=True, add_completion=False, pretty_exceptions_enable=False, rich_markup_mode=None,
)  # fmt: skip
#: What typer raises for a command line that it cannot read; BadParameter alone of the family is public.
UsageError = cast(type[typer.BadParameter], typer.BadParameter.__base__)
INTERRUPTED = 130


class InterruptedRunError(LtcgearError):
    """The user stopped a simulation; what it had computed is kept."""

    exit_code = INTERRUPTED


def _version(wanted: bool) -> None:
    """Print the version and stop."""
    if wanted:
        from importlib.metadata import version

        print(f"ltcgear {version('ltcgear')}")
        raise typer.Exit


@app.callback()
def common(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and stop.")
    ] = False,
) -> None:
    """Gearbox dynamics from written equations: scenes to C to simulations and eigenfrequencies."""


def main() -> None:
    """Run the command line; errors become one message and an exit code."""
    with outlets() as output:
        code = _run()
        output.flush()
        if output.fault is not None:
            tell(f"standard output cannot be written: {output.fault.strerror}; make room, or send it somewhere else")
            code = code or MachineError.exit_code
    sys.exit(code)


def _run() -> int:
    """Run a command and return its exit code."""
    try:
        code = int(app(standalone_mode=False) or 0)
        if code == INTERRUPTED:  # what typer makes of a KeyboardInterrupt; older ones abort
            raise KeyboardInterrupt
    except LtcgearError as error:
        return _refuse(str(error), error.exit_code)
    except UsageError as error:
        shown = io.StringIO()
        error.show(shown)
        print(write_out(shown.getvalue(), keep="\n"), end="", file=sys.stderr)
        return error.exit_code
    except (KeyboardInterrupt, typer.Abort):
        return _refuse("stopped; no file is half-written", INTERRUPTED)
    except (ImportError, MemoryError, OSError, RuntimeError) as error:
        fault = find_fault(error)
        if fault is None:
            raise
        return _refuse(fault, MachineError.exit_code)
    return code


def _refuse(message: str, code: int) -> int:
    """Tell why a command ends, and return its exit code."""
    tell(message)
    return code
