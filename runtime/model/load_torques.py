"""Torques of loads that a scene gives, constant or over time."""

from ltcgear.generated.contract import Manifest


def given_torques(manifest: Manifest) -> dict[str, str]:
    """Return by load the parameter or the signal that is its torque; those that follow a law have none."""
    known = [*(name for name, _ in manifest.parameters), *(signal.name for signal in manifest.signals)]
    given = {item.item: item.law[0] for item in manifest.connections if len(item.law) == 1}
    return dict(sorted(given.items(), key=lambda pair: known.index(pair[1])))
