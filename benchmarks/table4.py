"""Stiffness computed from the teeth beside the paper's Table 4; writes the table of docs/stiffness.md.

Run as ``python -m benchmarks.table4``.
"""

from pathlib import Path

from ltcgear.runtime.results.table import Table
from ltcgear.symbolic.gears import gear_geometry, mesh_stiffness
from ltcgear.symbolic.scene.load import load_scene
from ltcgear.symbolic.scene.validate import meshes
from ltcgear.symbolic.schema.mesh_schema import Mesh
from ltcgear.symbolic.schema.scene_schema import Planetary

PAGE = Path(__file__).resolve().parents[1] / "docs" / "stiffness.md"
BEGIN, END = "<!-- table4 -->\n", "<!-- end -->\n"
COLUMNS = (
    "mesh", "width mm", "computed single, double 1e9 N/m", "ratio", "printed ratio", "printed K 1e8 N m/rad",
    "K of that width 1e8, on gear 1 / gear 2", "width for printed K mm, on gear 1 / gear 2",
)  # fmt: skip


def rows() -> list[dict[str, float | str | tuple[float, float]]]:
    """Return one row for every planetary mesh of the rig (its parallel pair is helical, which is not computed)."""
    scene = load_scene("rig-2mw")
    found: list[dict[str, float | str | tuple[float, float]]] = []
    for name, stage in scene.stages.items():
        if not isinstance(stage, Planetary) or stage.planet.disc is None:
            continue
        width = stage.planet.disc.width
        for key, mesh, one, two, sigma in meshes(stage):
            single, double = mesh_stiffness.levels(stage, Mesh(face_width=f"{width} m"), one, two, sigma)
            radii = gear_geometry.base_radius(stage, one), gear_geometry.base_radius(stage, two)
            printed = mesh.torsional_stiffness or 0.0
            found.append(
                {
                    "mesh": f"{name}.{key}",
                    "width": width,
                    "single": single,
                    "double": double or single,
                    "printed_ratio": mesh.double_factor or 1.0,
                    "printed": printed,
                    "torsional": (single * radii[0] ** 2, single * radii[1] ** 2),
                    "fitting": tuple(width * printed / (single * r**2) for r in radii),
                }
            )
    return found


def table() -> str:
    """Return the table in Markdown."""
    lines = []
    for row in rows():
        single, double, torsional, fitting = (row[k] for k in ("single", "double", "torsional", "fitting"))
        lines.append(
            (row["mesh"], f"{row['width'] * 1e3:.0f}", f"{single / 1e9:.2f}, {double / 1e9:.2f}",
             f"{double / single:.2f}", f"{row['printed_ratio']:.2f}", f"{row['printed'] / 1e8:.2f}",
             f"{torsional[0] / 1e8:.2f} / {torsional[1] / 1e8:.2f}",
             f"{fitting[0] * 1e3:.0f} / {fitting[1] * 1e3:.0f}")
        )  # fmt: skip
    return Table("", COLUMNS, tuple(lines)).to_markdown()


def main() -> None:
    """Print the table and put it into the page."""
    made = table()
    print(made)
    before, rest = PAGE.read_text("utf-8").split(BEGIN)
    PAGE.write_text(before + BEGIN + made + END + rest.split(END)[1], "utf-8")


if __name__ == "__main__":
    main()
