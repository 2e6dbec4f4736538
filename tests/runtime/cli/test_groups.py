"""Groups of commands: every command is in one of them, and help shows them in the order of work."""

from itertools import chain

import pytest
from ltcgear.runtime.cli.commands import app
from ltcgear.runtime.cli.groups import GROUPS
from typer.main import get_command


def test_every_command_is_in_one_group():
    assert sorted(chain(*GROUPS.values())) == sorted(get_command(app).commands)


@pytest.mark.parametrize("flag", ["-h", "--help"])
def test_help_tells_groups_in_order(run, flag):
    code, out, err = run(flag)
    lines = [line.strip() for line in out.splitlines()]
    places = [lines.index(f"{title}:") for title in GROUPS]
    assert (code, err, places) == (0, "", sorted(places))
    for names, start, end in zip(GROUPS.values(), places, [*places[1:], None], strict=True):
        assert [line.split()[0] for line in lines[start + 1 : end] if line] == list(names)
    assert run("simulate", flag)[0] == 0
