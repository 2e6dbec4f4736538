"""The topology is what the scene says: who hangs on whom, in what order, and what several members are called."""

import pytest
from ltcgear.runtime.linear.orders import list_sides
from ltcgear.runtime.model.layout import lay_out
from ltcgear.runtime.model.topology import HOUSING, Topology

from ..models import case

RIG = {
    "lsp.ring.bearing": ("lsp.ring", HOUSING),
    "lsp.pin": ("lsp.carrier", "lsp planets"),
    "lsp.sun_planet": ("lsp.sun", "lsp planets"),
    "lsp.ring_planet": ("lsp.ring", "lsp planets"),
    "hsp.sun.bearing": ("hsp.sun", HOUSING),
    "hsp.pin": ("hsp.carrier", "hsp planets"),
    "hsp.sun_planet": ("hsp.sun", "hsp planets"),
    "hsp.ring_planet": ("hsp.ring", "hsp planets"),
    "psh.input.bearing": ("psh.input", HOUSING),
    "psh.output.bearing": ("psh.output", HOUSING),
    "psh.mesh": ("psh.input", "psh.output"),
    "couplings.input_shaft": ("lsp.ring", "motor"),
    "couplings.lsp_hsp": ("lsp.sun", "hsp.carrier"),
    "couplings.hsp_psh": ("hsp.sun", "psh.input"),
    "couplings.output_shaft": ("shaft", "psh.output"),
    "couplings.flange": ("shaft", "generator"),
}


def topology(name, *settings):
    return Topology(case(name, *settings).library.manifest)


def ends(name):
    return {group: link.ends for group, link in topology(name).links.items()}


def test_the_rig_hangs_together_as_its_scene_says():
    """Of couplings, what has an angle of its own comes first: the motor's speed is held."""
    assert ends("rig-2mw") == RIG


def test_a_train_of_two_couplings():
    assert ends("hard-tiny-inertia") == {
        "couplings.first": ("speck", "motor"),
        "couplings.second": ("speck", "rotor"),
    }


def test_members_that_are_held_keep_their_names():
    """The flywheel has no angle of its own and no drive, so that no output tells of it."""
    assert ends("hard-dead-band")["couplings.damper"] == ("pair.output", "flywheel")
    c = case("hard-dead-band")
    assert "flywheel" in {disc.body for disc in lay_out(c.library, c.p).discs}


def test_labels_and_wholes():
    found = topology("rig-2mw")
    assert found.labels["lsp.planet.3"] == "lsp planets"
    assert [found.whole(name) for name in ("lsp planets", "psh.input", "shaft")] == ["lsp", "psh", "shaft"]
    assert found.groups["hsp.pin.2"] == "hsp.pin"
    assert (found.links["couplings.flange"].told, found.links["lsp.pin"].told) == ("flange", "lsp.pin")
    assert (found.links["couplings.flange"].stage, found.links["lsp.pin"].stage) == ("", "lsp")


def test_the_sheet_stands_in_the_order_of_the_shafts():
    c = case("rig-2mw")
    sheet = lay_out(c.library, c.p)
    assert [name for name, _ in sheet.titles] == ["motor", "lsp", "hsp", "psh", "shaft", "generator"]
    planets = [disc for disc in sheet.discs if disc.body.startswith("hsp.planet")]
    carrier = next(disc for disc in sheet.discs if disc.body == "hsp.carrier")
    for planet in planets:
        distance = ((planet.x - carrier.x) ** 2 + (planet.y - carrier.y) ** 2) ** 0.5
        assert distance == pytest.approx(carrier.radius)


def test_passes_count_planets_though_their_pins_stand_elsewhere():
    """A torsional mesh whose pin is out of place has two clocks; the LSP has four planets all the same."""
    moved = 'stages.lsp.position_errors = [{ planet = 2, radial = "20 um", tangential = "50 um" }]'
    c = case("rig-2mw", 'effects.lateral = "off"', 'effects.planet_position_error = "on"', moved)
    assert len(c.library.manifest.clocks) > len({clock.mesh for clock in c.library.manifest.clocks if clock.mesh})
    assert {side.spread for side in list_sides(c.library.manifest, c.p, "lsp")} == {4}
