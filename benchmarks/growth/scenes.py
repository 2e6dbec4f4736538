"""Trains of any size: planetary stages in series, of which each sun drives the next carrier."""

from ltcgear.symbolic.scene.builder import SceneBuilder
from ltcgear.symbolic.schema.scene_schema import Scene

SUN, PLANET, RING = 100.0, 20.0, 140.0
"""Base radii [mm]: planets so small that twelve find room round the sun."""
DISTANCE = 127.7
"""Centre distance [mm], base radii over the cosine of 20 deg."""
BEARING = {"stiffness": "1e9 N/m", "damping_ratio": 0.03}
MESH = {"stiffness": "5e8 N/m", "damping_ratio": 0.05}


def train(planets: int, stages: int) -> Scene:
    """Put a train together; all numbers are assumed, and the same in every stage.

    Parameters
    ----------
    planets
        Planets of each stage.
    stages
        Planetary stages in series, with fixed rings; the first carrier is driven at 2 rpm,
        so that eight stages, each 2.4 times as fast as the one before, end at 2200 rpm.
    """
    scene = SceneBuilder(f"{stages} stages of {planets} planets", mesh_stiffness="mean")
    for k in range(1, stages + 1):
        scene.planetary(f"stage{k}", **stage_keys(planets))
    for k in range(1, stages):
        ends = f"stage{k}.sun", f"stage{k + 1}.carrier"
        scene.coupling(f"shaft{k}", *ends, stiffness="1e7 N*m/rad", damping_ratio=0.02)
    scene.load("drive", "stage1.carrier", speed="2 rpm").load("brake", f"stage{stages}.sun", torque="-5 N*m")
    return scene.build()


def stage_keys(planets: int) -> dict[str, object]:
    """Return the keys of one stage."""
    return {
        "planets": planets,
        "center_distance": f"{DISTANCE} mm",
        "ring": {"base_radius": f"{RING} mm", "support": "fixed"},
        "sun": _member(SUN, "5 kg", "0.03 kg*m^2"),
        "carrier": {"support": "bearing", "bearing": BEARING, "mass": "20 kg", "inertia": "0.3 kg*m^2"},
        "planet": {"base_radius": f"{PLANET} mm", "mass": "0.5 kg", "inertia": "2e-4 kg*m^2"},
        "sun_planet": MESH,
        "ring_planet": MESH,
        "pin": BEARING,
    }


def _member(radius: float, mass: str, inertia: str) -> dict[str, object]:
    """Return the keys of a member on a bearing."""
    own = {"base_radius": f"{radius} mm", "mass": mass, "inertia": inertia}
    return {**own, "support": "bearing", "bearing": BEARING}
