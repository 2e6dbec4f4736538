"""Pages that follow from the code are what the code gives, byte for byte."""

import pytest
from ltcgear.symbolic.describe import effect_page
from ltcgear.symbolic.schema.effects import EFFECTS, Effect, Exclusion

from regenerate import PAGES, ROOT


@pytest.mark.parametrize("name", PAGES)
def test_pages_are_up_to_date(name):
    assert (ROOT / "docs" / name).read_text("utf-8") == PAGES[name](), f"docs/{name} is stale; run `make docs`"


def test_the_page_tells_all_of_the_table(monkeypatch):
    exclusion = Exclusion("gravity", ("on",), "the one carries the other")
    effect = Effect("a", ("x", "y"), "y", "x", "It does.", "Here 2026", {"y": "b"}, {"y": (exclusion,)})
    monkeypatch.setattr(effect_page, "EFFECTS", (*EFFECTS, effect))
    page = effect_page.write_effects()
    for line in (
        "| [a](#a) | `y`, `x` | `x` |",
        "## a\n\nIt does.\n\n- Values: `y`, `x`.\n",
        "- `y` needs b.",
        "- `y` cannot stand beside `gravity = on`: the one carries the other.",
        "- Source: Here 2026.",
    ):
        assert line in page
    assert all(effect.help in page and effect.source in page for effect in EFFECTS)
