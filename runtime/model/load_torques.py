"""Torques of loads that a scene gives, constant or over time."""

from ltcgear.generated.contract import Manifest


def given_torques(manifest: Manifest) -> dict[str, str]:
    """Return by load the parameter or the signal that is its torque; those that follow a law have none."""
    known = [*(name for name, _ in manifest.parameters), *(signal.name for signal in manifest.signals)]
    named = {item.item: f"{item.group}.torque" for item in manifest.connections if item.kind == "load"}
    places = {name: place for place, name in enumerate(known)}
    given = {load: name for load, name in named.items() if name in places}
    return dict(sorted(given.items(), key=lambda pair: places[pair[1]]))
