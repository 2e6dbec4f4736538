"""Groups of commands, in the order of work."""

from typing import Any

from typer.core import TyperGroup

GROUPS = {
    "Scenes": ("scenes", "effects", "info", "check", "book"),
    "Simulation": ("simulate", "report", "analyse", "export"),
    "Small motions": ("modes", "campbell", "response", "stability"),
    "Many runs": ("sweep", "sensitivity", "cost", "accuracy"),
    "Models for other programs": ("generate", "export-fmu"),
    "Evidence": ("paper", "selftest"),
}
"""Title -> its commands."""


class OrderedCommands(TyperGroup):
    """The commands under the titles of their groups."""

    def list_commands(self, ctx: Any) -> list[str]:  # noqa: ANN401
        """Return the names of all commands, in the order of work."""
        return [name for names in GROUPS.values() for name in names]

    def format_commands(self, ctx: Any, formatter: Any) -> None:  # noqa: ANN401
        """Write the commands of each group, one a line."""
        room = formatter.width - max(map(len, self.list_commands(ctx))) - 6
        for title, names in GROUPS.items():
            with formatter.section(title):
                formatter.write_dl([(name, self.commands[name].get_short_help_str(room)) for name in names])
