"""Result of a gearbox's simulation, which draws itself and writes its report."""

from pathlib import Path
from typing import TYPE_CHECKING, Self

from ltcgear.generated.errors import LtcgearError

from ..results.result import Result
from .restoring import find_background

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..results.table import Table


class SimulationResult(Result):
    """A simulation: its data and summary, see ``Result``; with figures and a report."""

    @classmethod
    def of(cls, result: Result) -> Self:
        """Return a result that can be drawn."""
        return cls(result.dataset, result.summary)

    def table(self) -> "Table":
        """Return statistics of the mesh forces along the motion."""
        from ..view.tables.run_tables import list_forces

        tables = list_forces(self.summary)
        if not tables:
            raise LtcgearError("this result has no statistics of mesh forces: it has no mesh, or its run did not end")
        return tables[0]

    def plot(self, meshes: str | None = None) -> "Figure":
        """Draw mesh forces over time.

        Parameters
        ----------
        meshes
            Their group, such as ``lsp.sun_planet``; the first where left out.

        Returns
        -------
        matplotlib.figure.Figure
            The figure; ``figure.savefig("forces.svg")`` writes it.
        """
        from ..analysis.sharing import list_groups
        from ..view.figures.load_figures import draw_forces

        groups = list_groups(self.dataset)
        if not groups:
            raise LtcgearError("this result has no meshes, so there are no mesh forces to draw")
        if meshes is not None and meshes not in groups:
            raise LtcgearError(f"no meshes {meshes!r}; there are {', '.join(groups)}")
        return draw_forces(self.dataset, meshes or next(iter(groups)))

    def report(self, path: str | Path, at: float | None = None, modes: bool = True) -> Path:
        """Write one page of HTML: stages in motion, figures, tables, the scene. It needs no network.

        Parameters
        ----------
        path
            The page, ``NAME.html``.
        at
            Time in the middle of the close-up [s]; the record's end where left out.
        modes
            Show mode shapes.
        """
        from ..view.report.page import write_report

        return write_report(self, Path(path), find_background(self, modes), at)

    def __repr__(self) -> str:
        told = self.summary
        scene = self.dataset.attrs.get("scene") or "no scene"
        return f"<SimulationResult of {scene}: {told['simulated_s']:g} s by {told['method']}, {told['status']}>"

    def _repr_html_(self) -> str:
        """Show the result in a notebook."""
        from html import escape

        table = self.table().to_html() if self.summary["forces"] else ""
        return f"<p>{escape(repr(self)[1:-1])}</p>{table}"
