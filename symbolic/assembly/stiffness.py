"""Mesh stiffness of the model: constant, two levels, or a profile over the mesh phase."""

from ltcgear.generated.contract import NOT_NEGATIVE, SHARE

from ..gears import gear_geometry, mesh_stiffness
from ..mechanics.model import LEVEL, SLOPE, STIFFNESS, Profile
from ..schema.mesh_schema import TRANSITION
from .draft import Draft, MeshPlace


def bind_stiffness(draft: Draft, at: MeshPlace, bind: dict[str, str]) -> float:
    """Bind the stiffness of a mesh by the scene's effect and return its mean over a pitch [N/m]."""
    chosen, geometry = draft.scene.effects["mesh_stiffness"], at.geometry
    if chosen == "table" and at.mesh.stiffness_table is not None:
        series = mesh_stiffness.table_series(at.mesh.stiffness_table, at.mesh.harmonics)
        _follow(draft, at, "series", draft.series(f"{at.name}.stiffness", series, "N/m", NOT_NEGATIVE), bind)
        return series[0]
    single, double = mesh_stiffness.levels(*geometry)
    if double is None:
        bind["k"] = draft.stiffness(f"{at.name}.stiffness", single)
        return single
    share = gear_geometry.single_share(*geometry)
    mean = single * share + double * (1 - share)
    computed = mesh_stiffness.is_computed(at.mesh)
    if chosen in ("mean", "table"):
        bind["k"] = draft.stiffness(f"{at.name}.stiffness", mean)
    elif chosen == "smooth":
        width = draft.number(f"{at.name}.transition", min(at.mesh.transition or TRANSITION, share, 1 - share), "")
        _follow(draft, at, "smooth", (*_levels(draft, at, single, double, share), width), bind)
    elif chosen == "fourier":
        series = (
            mesh_stiffness.computed_series(*geometry, backwards=at.backwards)
            if computed
            else mesh_stiffness.two_level_series(single, double, share, at.mesh.harmonics)
        )
        _follow(draft, at, "series", draft.series(f"{at.name}.stiffness", series, "N/m", NOT_NEGATIVE), bind)
    elif chosen == "computed" and computed:
        draft.number(f"{at.name}.single_share", share, "", bounds=SHARE)
        arcs = mesh_stiffness.arcs(*geometry, backwards=at.backwards)
        names = [f"{at.name}.stiffness_{part}_{i}" for part in ("single", "double") for i in range(3)]
        numbers = tuple(draft.number(name, value, "N/m") for name, value in zip(names, arcs, strict=True))
        _follow(draft, at, "arcs", (f"{at.name}.single_share", *numbers), bind)
        at.switched = True
    else:
        bind["k_1"], bind["k_2"], _ = _levels(draft, at, single, double, share)
        bind["level"] = LEVEL
        at.switched = True
    return mean


def _levels(draft: Draft, at: MeshPlace, single: float, double: float, share: float) -> tuple[str, str, str]:
    """Register the two levels of eq 9 and the share of single contact."""
    return (
        draft.stiffness(f"{at.name}.stiffness_single", single),
        draft.stiffness(f"{at.name}.stiffness_double", double),
        draft.number(f"{at.name}.single_share", share, "", bounds=SHARE),
    )


def _follow(draft: Draft, at: MeshPlace, kind: str, numbers: tuple[str, ...], bind: dict[str, str]) -> None:
    """Bind a stiffness that varies with the mesh phase, or with gear 1's own rolling under ``stiffness_torque``."""
    draft.profiles.append(Profile(at.label, "stiffness", kind, numbers))
    bind["k"] = STIFFNESS
    if draft.on("stiffness_torque") and kind != "arcs":
        bind |= {"k_d": SLOPE, "z_1": f"{at.name}.teeth_1"}
