"""Modes of a gearbox, which list and draw themselves."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, overload

if TYPE_CHECKING:
    from ..linear.modes import Mode
    from ..linear.system import Linear
    from ..results.table import Table


class ModeList(Sequence["Mode"]):
    """Modes at the loaded equilibrium, by frequency.

    Parameters
    ----------
    title
        What they are modes of.
    linear
        The linear system.
    modes
        Its modes.
    turn
        Turns of the reference after which the meshes are held; None at their means.
    """

    def __init__(self, title: str, linear: "Linear", modes: "Sequence[Mode]", turn: float | None) -> None:
        self.title, self.linear, self.turn, self._modes = title, linear, turn, tuple(modes)

    @overload
    def __getitem__(self, index: int) -> "Mode": ...
    @overload
    def __getitem__(self, index: slice) -> "Sequence[Mode]": ...
    def __getitem__(self, index: int | slice) -> "Mode | Sequence[Mode]":
        return self._modes[index]

    def __len__(self) -> int:
        return len(self._modes)

    def __iter__(self) -> "Iterator[Mode]":
        return iter(self._modes)

    @property
    def frequencies_hz(self) -> list[float]:
        """The eigenfrequencies [Hz]."""
        return [mode.frequency_hz for mode in self]

    def table(self) -> "Table":
        """Return eigenfrequencies, damping and what moves."""
        from ..model.topology import Topology
        from ..view.tables.mode_tables import list_modes, tabulate_modes

        meshes = "at their mean stiffness" if self.turn is None else f"as they stand after {self.turn:g} turns"
        freedoms = len(self.linear.positions)
        data = {"meshes": meshes, "modes": list_modes(self), "freedoms": freedoms, "lowest": len(self) < freedoms}
        [table] = tabulate_modes(data, Topology(self.linear.library.manifest).labels)
        return table

    def draw(self, path: str | Path, numbers: Sequence[int] | None = None) -> Path:
        """Draw mode shapes into a picture, or as a page of HTML on which they move.

        Parameters
        ----------
        path
            ``.png``, ``.svg``, ``.pdf`` or ``.html``.
        numbers
            Which of them, from 1; the first 6 where left out, all on a page.
        """
        path, every = Path(path), list(range(1, len(self) + 1))
        if path.suffix == ".html":
            from ..view.figures.shape_page import write_page

            return write_page(self.linear, list(self), sorted(set(numbers or every)), self.title, path)
        from ..view.figures.shape_figures import draw_shapes

        return draw_shapes(self.linear, list(self), list(numbers or every[:6]), self.title, path)

    def __repr__(self) -> str:
        low, high = min(self.frequencies_hz, default=0.0), max(self.frequencies_hz, default=0.0)
        return f"<ModeList of {self.title}: {len(self)} modes from {low:.4g} to {high:.4g} Hz>"

    def _repr_html_(self) -> str:
        """Show the modes in a notebook."""
        return self.table().to_html()
