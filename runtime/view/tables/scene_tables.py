"""Tables of scenes and models: what is shipped, which effects there are, what a model amounts to, how checks ended."""

from collections.abc import Iterator
from typing import Any

from ...results.table import Table

Data = dict[str, Any]


def list_scenes(data: Data) -> list[Table]:
    """Return the shipped scenes."""
    return [
        Table("Shipped scenes", ("scene", "title"), tuple((item["name"], item["title"]) for item in data["scenes"]))
    ]


def list_effects(data: Data) -> list[Table]:
    """Return the effects."""
    rows = tuple(
        (item["name"], _values(item), "\n".join([item["help"], *_conditions(item)]), item["source"])
        for item in data["effects"]
    )
    return [Table("Effects (the first value is the default)", ("effect", "values", "what it does", "source"), rows)]


def _values(item: Data) -> str:
    """Write the values of an effect, the default first."""
    return " | ".join([item["default"], *(value for value in item["values"] if value != item["default"])])


def _conditions(item: Data) -> Iterator[str]:
    """Write what the values of an effect need and exclude."""
    for value, need in item["needs"].items():
        yield f"{value}: needs {need}"
    for value, exclusions in item["excludes"].items():
        for other in exclusions:
            yield f"{value}: not beside {other['effect']} = {' or '.join(other['values'])}, since {other['reason']}"


def list_model(data: Data) -> list[Table]:
    """Return what a scene amounts to: its size, effects, coordinates, stages, meshes, members, loads and sources."""
    parts = (_size, _acting, _freedoms, _stages, _meshes, _members, _loads, _laws, _sources)
    return [table for table in (part(data) for part in parts) if table.rows]


def _size(data: Data) -> Table:
    """List how large a model is."""
    rows = (
        ("degrees of freedom", str(data["dof"])),
        ("states", str(data["states"])),
        ("parameters", str(data["parameters"])),
        ("switched meshes", str(data["levels"])),
        ("operations", f"{data['ops']['rhs']} right-hand side, {data['ops']['jacobian']} Jacobian"),
        ("Jacobian non-zeros", str(data["jacobian_nnz"])),
        ("effects", ", ".join(f"{k} {v}" for k, v in data["effects"].items())),
    )
    notes = ("no sources given",) if data.get("sources") == {} else ()
    return Table(data["title"], ("", ""), rows, notes)


def _acting(data: Data) -> Table:
    """List the effects that are on and what each does here."""
    rows = tuple((item["effect"], item["value"], item["here"]) for item in data["acting"])
    return Table("Effects that act", ("effect", "value", "what the model has by it"), rows)


def _freedoms(data: Data) -> Table:
    """List the coordinates and why each is there."""
    rows = tuple((row["body"], ", ".join(row["axes"]), row["reason"]) for row in data["freedoms"])
    return Table("Freedoms", ("body", "axes", "why"), rows)


def _stages(data: Data) -> Table:
    """List geometry and mesh frequency of the stages."""
    rows = tuple(
        (name if k == 0 else "", what, value)
        for name, stage in data["stages"].items()
        for k, (what, value) in enumerate(_describe_stage(stage))
    )
    return Table("Stages", ("stage", "", ""), rows)


def _describe_stage(stage: Data) -> Iterator[tuple[str, str]]:
    """Write the numbers of a stage; planets whose tips overlap are told."""
    radii = ", ".join(f"{part} {radius:.3f}" for part, radius in stage["base_radii_mm"].items())
    yield "centre distance", f"{stage['center_distance_mm']:.3f} mm"
    yield "base radii", f"{radii} mm"
    if stage["mesh_frequency_hz"] is not None:
        yield "mesh frequency", f"{stage['mesh_frequency_hz']:.3f} Hz"
    clearance = stage["planet_tip_clearance_mm"]
    if clearance is not None:
        overlap = ": they OVERLAP" if clearance < 0 else ""
        yield "tip clearance of planets", f"{clearance:.3f} mm (full-depth teeth){overlap}"


def _meshes(data: Data) -> Table:
    """List angle, contact ratio, stiffness and static normal force of the meshes."""
    rows = tuple(
        (
            f"{name}.{key}",
            f"{mesh['pressure_angle_deg']:.3f}",
            form(mesh["contact_ratio"], ".3f") + (" given" if mesh["contact_ratio_given"] else ""),
            form(mesh["stiffness_single_n_per_m"], ".4g"),
            form(mesh["stiffness_double_n_per_m"], ".4g"),
            f"{mesh['static_force_n']:.6g}",
        )
        for name, stage in data["stages"].items()
        for key, mesh in stage["meshes"].items()
    )
    columns = ("mesh", "angle deg", "contact ratio", "single N/m", "double N/m", "force N")
    return Table("Meshes (force: static and normal, in each such mesh)", columns, rows)


def _members(data: Data) -> Table:
    """List motion and inertia of the members."""
    rows = tuple(
        (
            name if member["count"] == 1 else f"{name} (each of {member['count']})",
            f"{member['speed_rpm']:.3f}",
            form(data["speed_ratios"].get(name), ".6g"),
            form(member["mass_kg"], ".5g"),
            form(member["inertia_kg_m2"], ".5g"),
        )
        for name, member in data["members"].items()
    )
    return Table("Members", ("member", "r/min", "speed ratio", "mass kg", "inertia kg m^2"), rows)


def _loads(data: Data) -> Table:
    """List the loads: what drives the train and what is driven by it."""
    rows = tuple(
        (name, load["member"], f"{load['speed_rpm']:.3f}", form(load["torque_n_m"], ".6g"),
         form(load["power_kw"], "+.6g"), load["action"])
        for name, load in data["loads"].items()
    )  # fmt: skip
    return Table("Loads (without losses)", ("load", "member", "r/min", "torque N m", "power kW", ""), rows)


def _laws(data: Data) -> Table:
    """List how loads vary."""
    rows = tuple((name, load["law"]) for name, load in data["loads"].items() if load["law"])
    return Table("Loads that vary (above at their largest, or at the speeds listed)", ("load", ""), rows)


def _sources(data: Data) -> Table:
    """List where the numbers come from."""
    return Table("Where the numbers come from", ("number", "source"), tuple(data.get("sources", {}).items()))


def form(value: float | None, spec: str) -> str:
    """Write a number; a dash for one that is not known."""
    return "-" if value is None else format(value, spec)


def list_checks(data: Data) -> list[Table]:
    """Return check results; the notes of all are in --json, those of failures here."""
    rows = tuple(
        (item["name"] + ("" if item["passed"] else f"\n{item['note']}"), "ok" if item["passed"] else "FAILED",
         f"{item['value']:.2g}", f"{item['tolerance']:.2g}")
        for item in data["checks"]
    )  # fmt: skip
    failed = sum(not item["passed"] for item in data["checks"])
    notes = (f"{len(rows) - failed} passed, {failed} failed; --json tells how each was done",)
    return [Table("Checks of the equations", ("check", "", "value", "tolerance"), rows, notes)]


def list_book(data: Data) -> list[Table]:
    """Return what an equation book holds."""
    rows = tuple((item["title"], len(item["sections"]), item["equations"]) for item in data["chapters"])
    checks, paper = data["checks"], data["paper"]
    told = ", ".join(f"{count} {verdict}" for verdict, count in paper.items())
    notes = (
        f"checks: {checks['passed']} passed, {checks['failed']} failed",
        f"the paper's printed equations: {told}",
        f"{data['file']}, {data['bytes'] / 1e3:.0f} kB; key {data['key']}",
    )
    title = f"Equation book of {data['scene']}: {data['equations']} equations"
    return [Table(title, ("chapter", "sections", "equations"), rows, notes)]
