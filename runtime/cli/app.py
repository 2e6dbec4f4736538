"""The app: its common options, and how errors become one message and an exit code."""

import sys
from typing import Annotated, cast

import typer
from ltcgear.generated.errors import LtcgearError

# Plain help: rich would take "[s]" for markup and drop it.
app = typer.Typer(no_args_is_help=True, add_completion=False, pretty_exceptions_enable=False, rich_markup_mode=None)
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
    try:
        code = app(standalone_mode=False) or 0
        if code == INTERRUPTED:  # what typer makes of a KeyboardInterrupt; older ones abort
            raise KeyboardInterrupt
    except LtcgearError as error:
        print(f"ltcgear: {error}", file=sys.stderr)
        code = error.exit_code
    except UsageError as error:
        error.show()
        code = error.exit_code
    except (KeyboardInterrupt, typer.Abort):
        print("ltcgear: stopped; no file is half-written", file=sys.stderr)
        code = INTERRUPTED
    sys.exit(code)
