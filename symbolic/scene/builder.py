"""Scenes in Python: the same tables and keys as in TOML, checked by the same code."""

from copy import deepcopy
from typing import Any

from ..schema.scene_schema import Scene
from .load import make_scene
from .toml import Raw


class SceneBuilder:
    """Put a scene together step by step.

    Every method takes the keys of the TOML table of the same name, with quantities as text, and
    returns the builder; ``build`` checks everything at once.

    Parameters
    ----------
    title
        What the scene is.
    effects
        Effects that differ from their defaults, by name.

    Examples
    --------
    >>> scene = (
    ...     SceneBuilder("two discs on a shaft")
    ...     .rotor("rotor", inertia="4 kg*m^2")
    ...     .rotor("generator", inertia="2 kg*m^2")
    ...     .coupling("shaft", "rotor", "generator", stiffness="1e5 N*m/rad")
    ...     .build()
    ... )
    >>> sorted(scene.rotors)
    ['generator', 'rotor']
    """

    def __init__(self, title: str, **effects: str) -> None:
        self._raw: Raw = {"title": title, "effects": dict(effects)}

    def _add(self, table: str, name: str, entry: dict[str, Any]) -> "SceneBuilder":
        """Put an entry into a table of the scene."""
        self._raw.setdefault(table, {})[name] = entry
        return self

    def planetary(self, name: str, **keys: Any) -> "SceneBuilder":  # noqa: ANN401
        """Add a planetary stage: planets, ring, sun, planet, carrier, sun_planet, ring_planet, pin, ..."""
        return self._add("stages", name, {"kind": "planetary", **keys})

    def pair(self, name: str, **keys: Any) -> "SceneBuilder":  # noqa: ANN401
        """Add a parallel pair: input, output, mesh, ..."""
        return self._add("stages", name, {"kind": "pair", **keys})

    def rotor(self, name: str, **keys: Any) -> "SceneBuilder":  # noqa: ANN401
        """Add an inertia that only turns."""
        return self._add("rotors", name, keys)

    def coupling(self, name: str, one: str, two: str, **keys: Any) -> "SceneBuilder":  # noqa: ANN401
        """Add a torsional coupling between two members."""
        return self._add("couplings", name, {"between": [one, two], **keys})

    def load(self, name: str, member: str, **keys: Any) -> "SceneBuilder":  # noqa: ANN401
        """Add a held speed or a torque on a member."""
        return self._add("loads", name, {"member": member, **keys})

    def simulation(self, **keys: Any) -> "SceneBuilder":  # noqa: ANN401
        """Set the defaults of simulations: t_end, rate."""
        self._raw["simulation"] = keys
        return self

    def gravity(self, x: str, y: str) -> "SceneBuilder":
        """Set the direction and size of gravity (acts when the effect is on)."""
        self._raw["gravity"] = [x, y]
        return self

    def build(self, name: str = "scene") -> Scene:
        """Check the scene and freeze it.

        Raises
        ------
        SceneError
            If it has defects; all of them are listed.
        """
        return make_scene(deepcopy(self._raw), name=name, label=name)
