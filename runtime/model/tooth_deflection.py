"""Limits of mesh deflection: where the force law ceases to hold, and what no tooth can give.

The law of a mesh is linear (a stiffness over the mesh phase), which teeth are only while they bend by far less than
they are thick. Lengths along the line of action go by the base pitch p_b = 2 pi r_b / z, about three modules
(p_b = pi m cos(alpha), 2.95 m at 20 degrees; ISO 53). A tooth takes up half of it, p_b / 2, its gap the other half:
a flank that has gone further has gone through the tooth.
"""

from collections.abc import Iterator, Mapping

import numpy as np
from ltcgear.generated.contract import Connection
from numpy.typing import NDArray

from .library import Library
from .parameter_values import name_values

Vector = NDArray[np.float64]

THICKNESS = 0.5
"""Deflection over base pitch that uses up the tooth thickness (geometry)."""
STRAINED = 0.07 / (np.pi * np.cos(np.radians(20)))
"""Deflection over base pitch beyond which a run is warned about: 0.07 modules, the most that VDI 2736 part 2 allows
teeth of plastic. Teeth of steel break before, at about 0.02 modules (derived): where root stress, 4 F / (b m), is
1000 N/mm^2 (ISO 6336-5, case-hardened) and the stiffness of a pair 14 N/(mm um) (ISO 6336-1)."""
FEWEST = 3
"""Teeth that a gear has at least: where a model knows none, its base pitch is at most that of so few."""


class Teeth:
    """What the teeth of a model's meshes may deflect by.

    Parameters
    ----------
    library, p
        Model and parameters.

    Attributes
    ----------
    meshes
        Meshes, and their flanks that are not loaded, whose deflection is told.
    columns
        Where among the outputs.
    pitch
        Base pitches [m], those of the fewest teeth where the model does not know them, shape (meshes,).
    known
        Whether the model knows all teeth.
    """

    def __init__(self, library: Library, p: Vector) -> None:
        reports = library.manifest.reports
        self.columns = [i for i, report in enumerate(reports) if report.quantity == "mesh_deflection"]
        self.meshes = tuple(reports[i].item for i in self.columns)
        numbers = name_values(library.manifest, p)
        meshes = {item.item: item for item in library.manifest.connections if item.kind == "mesh"}
        found = [_base_pitch(numbers, meshes[mesh]) for mesh in self.meshes]
        self.pitch, self.known = np.array([pitch for pitch, _ in found]), all(known for _, known in found)
        self._pulls = not any(report.quantity == "mesh_contact" for report in reports)

    def deepest(self, values: Vector) -> Vector:
        """Return how far outputs (m, n_y) have teeth deflect at most [m], shape (meshes,); 0 where they part."""
        found = values[:, self.columns]
        return np.asarray(np.fmax.reduce(np.abs(found) if self._pulls else found, axis=0, initial=0.0))

    def impossible(self, deepest: Vector) -> str:
        """Say which deflection is beyond a tooth, and what to do; ``""`` where none is."""
        share = deepest / self.pitch
        if not (share > THICKNESS).any():
            return ""
        worst = int(share.argmax())
        pitch = f"the base pitch, {THICKNESS * self.pitch[worst]:.3g} m"
        limit = pitch if self.known else f"that of a gear of {FEWEST} teeth, {THICKNESS * self.pitch[worst]:.3g} m"
        return (
            f"{self.meshes[worst]}: a deflection of {deepest[worst]:.3g} m, above half of {limit}, "
            "goes through the whole tooth; check loads, stiffness and errors of the mesh"
        )

    def strained(self, deepest: Vector) -> Iterator[str]:
        """Yield which deflections are beyond what teeth are made for."""
        for mesh, depth, pitch in zip(self.meshes, deepest.tolist(), self.pitch.tolist(), strict=True):
            if STRAINED * pitch < depth <= THICKNESS * pitch:
                yield (
                    f"{mesh}: deflects by up to {depth:.3g} m, {depth / pitch:.1%} of its base pitch, where teeth "
                    f"break or are no springs of constant stiffness ({STRAINED:.1%} is 0.07 modules); check loads, "
                    "stiffness and errors of the mesh"
                )


def count_teeth(mesh: Connection, numbers: Mapping[str, float]) -> tuple[int, int]:
    """Return the teeth of both gears of a mesh, zeros where the model does not know them.

    Only those of gear 1 are a parameter. Gears that mesh have one base pitch 2 pi r_b / z, which gives the others.
    """
    teeth = abs(numbers.get(mesh.teeth, 0.0))
    one, two = (numbers[name] for name in mesh.radii)
    return round(teeth), round(teeth * two / one)


def _base_pitch(numbers: Mapping[str, float], mesh: Connection) -> tuple[float, bool]:
    """Return a base pitch [m], and whether it is of teeth that are known."""
    radii = [numbers[name] for name in mesh.radii]
    teeth = abs(numbers.get(mesh.teeth, 0.0))
    return (2 * np.pi * radii[0] / teeth, True) if teeth else (2 * np.pi * min(radii) / FEWEST, False)
