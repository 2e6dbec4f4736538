"""Topology of the train: which bodies each connection joins."""

import numpy as np
from ltcgear.generated.contract import Manifest

from .library import Library

HOUSING = "housing"
ENDS = {"sun_planet": "sun", "ring_planet": "ring", "pin": "carrier"}
"""What stands at the other end of a planet's elements."""


def list_ends(library: Library) -> dict[str, list[str]]:
    """Return by family of elements the two things it joins."""
    manifest = library.manifest
    found: dict[str, list[str]] = {}
    for report in manifest.reports:
        if report.quantity in ("mesh_force", "pin_force_x"):
            stage, part = report.item.split(".")[:2]
            orbiting = [f"{stage}.{ENDS[part]}", f"{stage} planets"] if part in ENDS else None
            found[f"{stage}.{part}"] = orbiting or [f"{stage}.input", f"{stage}.output"]
        elif report.quantity == "bearing_force_x":
            found[f"{report.item}.bearing"] = [report.item, HOUSING]
        elif report.quantity == "support_torque":
            found[f"{report.item}.torsional_support"] = [report.item, HOUSING]
    return found | _couplings(library)


def _couplings(library: Library) -> dict[str, list[str]]:
    """Return what couplings join: members whose deviations their torques follow, and one that has none of its own."""
    manifest = library.manifest
    pattern = library.graphs["outputs"].jac_sparsity(0, 0)
    rows, columns = (np.array(part) for part in pattern.get_triplet())
    found = {}
    for i, report in enumerate(manifest.reports):
        if report.quantity == "coupling_torque":
            seen = [label(manifest.states[k].body) for k in columns[rows == i]]
            names = [name for name in dict.fromkeys(seen) if name]
            found[f"couplings.{report.item}"] = [*names, *[_lead(manifest)] * 2][:2]
    return found


def _lead(manifest: Manifest) -> str:
    """Name the member that has no deviation of its own: the reference, or the one whose speed is held."""
    drives = [report.item for report in manifest.reports if report.quantity == "drive_torque"]
    if manifest.reference == "torque":
        return next(state.body for state in manifest.states if state.name == "reference.speed")
    return drives[0] if len(drives) == 1 else "a held member"


def label(body: str) -> str:
    """Return a body's name; the planets of a stage share one."""
    return f"{body.split('.')[0]} planets" if ".planet." in body else body


def whole(name: str) -> str:
    """Return the stage of a member, or the rotor's own name."""
    return name.replace(" ", ".").split(".")[0]
