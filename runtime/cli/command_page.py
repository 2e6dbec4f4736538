"""Page docs/commands.md, written from the command line itself."""

from collections.abc import Iterator
from itertools import chain
from typing import Any

from typer.main import get_command

from .groups import GROUPS

HEAD = """# Commands

`ltcgear COMMAND -h` prints what stands here. SCENE is the name of a shipped scene (`ltcgear scenes`) or a TOML
file.

- With `--json` a command prints one JSON object and nothing else on standard output; messages go to standard error.
- Exit codes: 0 done, 1 a check failed, 2 bad input, or a machine without room or memory, 3 the solver or the compiler
  failed, 130 stopped by Ctrl-C.
- A reader that goes away (`| head`) changes nothing: the command goes on and ends with its own code. Where standard
  output itself cannot be written, files are, and the code is 2.
- C that was made once is kept in a store. It may be removed at any time; what is missing is made again.

This page is written by `make docs` from the commands.

## Environment variables

| variable | what it does |
|---|---|
| `CC` | The C compiler, with arguments if need be (`ccache gcc`, `gcc -m64`); else `cc`, `gcc` or `clang`. |
| `LTCGEAR_CFLAGS` | Flags given to the compiler after ltcgear's own ([any processor](arithmetic.md)). |
| `LTCGEAR_COMPILE_SECONDS` | Seconds after which a compiler is ended, `inf` for never. |
| `LTCGEAR_CACHE` | The folder of the store, which only you may write. |
| `TMPDIR` | Where `accuracy` keeps a store while it measures, and libraries their files; nothing else needs it. |
| `COLUMNS`, `NO_COLOR` | Width of tables, 40 at least, and their colour. |

Without `LTCGEAR_CACHE` the store is in your cache folder (`XDG_CACHE_HOME`, else `~/.cache`); compilers keep their own
temporary files there too. Without `LTCGEAR_COMPILE_SECONDS` a compiler has 300 s and one for each kilobyte of C, about
a hundred times what it [takes](growth.md). `MPLBACKEND` has no effect: figures are files.

## All commands

| for | command | what it does |
|---|---|---|
"""
FLAG_TEXT = {True: "on", False: "off"}


def write_commands() -> str:
    """Return the page as Markdown."""
    from .commands import app

    commands: dict[str, Any] = get_command(app).commands  # type: ignore[attr-defined]
    rows = [
        f"| {f'{title} | ' if k == 0 else '| '}[{name}](#{name}) | {_cell(_summary(commands[name]))} |\n"
        for title, names in GROUPS.items()
        for k, name in enumerate(names)
    ]
    return HEAD + "".join(rows) + "".join(_section(name, commands[name]) for name in chain(*GROUPS.values()))


def _summary(command: Any) -> str:  # noqa: ANN401
    """Return the first sentence of a command's help."""
    return " ".join(command.help.split()).split(". ")[0].rstrip(".") + "."


def _section(name: str, command: Any) -> str:  # noqa: ANN401
    """Write what there is to say about one command."""
    arguments = [item for item in command.params if item.param_type_name == "argument"]
    usage = " ".join([f"ltcgear {name}", *(_metavar(item) for item in arguments), "[OPTIONS]"])
    rows = "".join(_row(item) for item in command.params)
    text = " ".join(command.help.split())
    return f"\n## {name}\n\n    {usage}\n\n{text}\n\n| given | default | meaning |\n|---|---|---|\n{rows}"


def _metavar(argument: Any) -> str:  # noqa: ANN401
    """Return how an argument stands in the usage, in brackets where it may be left out."""
    text = (argument.metavar or argument.name.upper()).strip("[]")
    return text if argument.required else f"[{text}]"


def _row(parameter: Any) -> str:  # noqa: ANN401
    """Write one argument or option."""
    if parameter.param_type_name == "argument":
        given = f"`{_metavar(parameter)}`"
    else:
        taken = "" if parameter.is_flag else f" {parameter.metavar or 'VALUE'}"
        given = ", ".join(f"`{option}{taken}`" for option in _options(parameter))
    return f"| {_cell(given)} | {_cell(_default(parameter))} | {_cell(_meaning(parameter))} |\n"


def _meaning(parameter: Any) -> str:  # noqa: ANN401
    """Return the help, and whether an option may be given again where the help does not say it."""
    text = parameter.help or ""
    told = " again" in text or not getattr(parameter, "multiple", False)
    return str(text) if told else f"{text} May be given again."


def _options(option: Any) -> Iterator[str]:  # noqa: ANN401
    """List the spellings of an option, the short one first."""
    yield from sorted([*option.opts, *option.secondary_opts], key=len)


def _default(parameter: Any) -> str:  # noqa: ANN401
    """Write what holds where nothing is given."""
    shown, value = parameter.show_default, parameter.default
    if isinstance(shown, str):
        return shown
    if parameter.required:
        return "must be given"
    if value is None or isinstance(value, bool):
        return "none" if value is None else FLAG_TEXT[value]
    return f"`{value}`"


def _cell(text: str) -> str:
    """Keep bars from ending a table's cell."""
    return text.replace("|", "\\|")
