"""Gearbox: a scene, and all that is computed of it, in one object."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from ltcgear.generated.errors import CheckError, LtcgearError

from ..results import result as results
from ..simulation.run_settings import ChosenOptions, RunOptions
from .mode_list import ModeList
from .restoring import choose_count, linearise_model
from .simulation_result import SimulationResult

if TYPE_CHECKING:
    import xarray as xr
    from ltcgear.symbolic.mechanics.model import Model
    from ltcgear.symbolic.scene.load import Source
    from ltcgear.symbolic.schema.scene_schema import Scene

    from ..model.library import Library
    from ..results.table import Table

Changes = Mapping[str, str]


class Gearbox:
    """A gearbox.

    Equations are derived, checked and compiled when something asks for them, once: the store keeps the C.

    Parameters
    ----------
    source
        Name of a shipped scene, path of a TOML file, or a scene that ``SceneBuilder`` has built.
    changes
        Dotted key -> value in place of the scene's: ``{"loads.motor.speed": "10 rpm"}``.

    Raises
    ------
    SceneError
        If the scene cannot be read or has defects; the message lists all of them.

    Examples
    --------
    >>> gear = Gearbox("lsp")
    >>> gear.title
    'Low-speed planetary stage of the 2 MW gearbox, alone'
    >>> gear
    <Gearbox lsp: Low-speed planetary stage of the 2 MW gearbox, alone>
    """

    def __init__(self, source: "str | Path | Source | Scene", changes: Changes | None = None) -> None:
        from ltcgear.symbolic.scene.load import load_scene, read_source
        from ltcgear.symbolic.schema.scene_schema import Scene

        self._source, self._changes = None, dict(changes or {})
        if isinstance(source, Scene):
            if changes:
                raise LtcgearError("changes: are for scenes that are read; change the builder's instead")
            self.scene: Scene = source
        else:
            _refuse_result(source)
            self._source = read_source(source)
            self.scene = load_scene(self._source, self._changes)

    def changed(self, changes: Changes) -> "Gearbox":
        """Return the same gearbox with other values, by dotted key; those changed before stay."""
        if self._source is None:
            raise LtcgearError("changes: are for scenes that are read; change the builder's instead")
        return Gearbox(self._source, self._changes | dict(changes))

    @property
    def title(self) -> str:
        """What the scene says it is."""
        return self.scene.title

    @cached_property
    def model(self) -> "Model":
        """Bodies and elements of the scene, with the numbers."""
        from ltcgear.symbolic.assembly import build_model

        return build_model(self.scene)

    @cached_property
    def library(self) -> "Library":
        """The compiled equations of motion."""
        from ltcgear.symbolic.emit.pipeline import obtain

        from ..model.building import build

        return build(obtain(self.model))

    @property
    def warnings(self) -> list[str]:
        """What is doubtful about the scene."""
        from ltcgear.symbolic.describe.advice import warnings
        from ltcgear.symbolic.describe.geometry_report import load_warnings

        return [*warnings(self.scene, self.model), *load_warnings(self.scene)]

    def info(self) -> "list[Table]":
        """Return size, effects, coordinates, geometry, speeds, loads and mesh forces, as tables."""
        from ltcgear.symbolic.describe.overview import survey

        from ..view.tables.scene_tables import list_model

        return list_model(survey(self.scene, self.model, self.library.manifest))

    def check(self) -> "Table":
        """Check the equations: Lagrange against Newton, energies against forces by hand, the laws of physics.

        Raises
        ------
        CheckError
            If a check fails.
        """
        from ltcgear.symbolic.checks.all_checks import check_model

        from ..view.tables.scene_tables import list_checks

        found = check_model(self.model)
        if failed := [check.name for check in found if not check.passed]:
            raise CheckError("\n".join(failed))
        [table] = list_checks({"checks": [asdict(check) for check in found]})
        return table

    def simulate(self, path: str | Path | None = None, **options: Unpack["GearboxOptions"]) -> SimulationResult:
        """Simulate from the loaded equilibrium.

        Parameters
        ----------
        path
            A file, ``NAME.nc``, to which samples go while it runs; in memory only without.
        options
            Settings of the run, see ``RunSettings``; time, rate and tables are the scene's where left out.

        Raises
        ------
        SolverError
            If there is no equilibrium to start from. A failure later on is ``summary["status"]``.
        """
        from ltcgear.symbolic.scene.load import describe_scene

        from ..simulation.recording import record
        from ..simulation.simulate import simulate

        given = self._settings(options)
        about = describe_scene(self.scene, "" if self._source is None else self._source.text, self._changes)
        if path is None:
            return SimulationResult.of(simulate(self.library, self.model.values(), attributes=about, **given))
        record(self.library, self.model.values(), path, attributes=about, **given)
        return read_result(path)

    def _settings(self, options: "GearboxOptions") -> RunOptions:
        """Return the settings of a run, with the scene's where none are given."""
        own = self.scene.simulation
        settings: RunOptions = {"t_end": own.t_end, "rate": own.rate, "tables": self.model.tables}
        settings.update(options)
        return settings

    def modes(self, count: int | None = None, turn: float | None = None) -> ModeList:
        """Find eigenfrequencies, damping and mode shapes at the loaded equilibrium.

        Parameters
        ----------
        count
            How many of the lowest; all where left out, 40 of large trains.
        turn
            Hold the meshes as they stand after so many turns of the reference; at their means where left out.
        """
        from ..linear.modes import find_modes
        from ..linear.naming import describe_modes

        linear = linearise_model(self.library, self.model, turn)
        wanted = choose_count(linear) if count is None else count
        return ModeList(self.title, linear, describe_modes(linear, find_modes(linear, wanted)), turn)

    def sweep(self, vary: str | Sequence[str], path: str | Path, **options: Any) -> "xr.Dataset":  # noqa: ANN401
        """Simulate at many points and keep metrics of each; a file that is there is gone on with.

        Parameters
        ----------
        vary
            Axes: ``KEY=a:b:n``, ``KEY=a:b`` or ``KEY=v1,v2``.
        path
            The file, ``NAME.nc``.
        options
            As ``ltcgear.runtime.sweep`` takes them.

        Returns
        -------
        xarray.Dataset
            One row a point, see the page on sweeps.
        """
        from ltcgear.symbolic.emit.template import Template

        from ..studies.sweep.run_sweep import sweep
        from ..studies.sweep.sweep_file import load_sweep

        if self._source is None:
            raise LtcgearError("sweep: is for scenes that are read from a file or by name; save the scene as TOML")
        axes = [vary] if isinstance(vary, str) else vary
        sweep(Template(self._source, self._changes), axes, path, **options)
        return load_sweep(path)

    def __repr__(self) -> str:
        return f"<Gearbox {self.scene.name}: {self.title}>"

    def _repr_html_(self) -> str:
        """Show the gearbox in a notebook."""
        return "".join(table.to_html() for table in self.info())


class GearboxOptions(ChosenOptions, total=False):
    """Settings of a run as keyword arguments, none of them needed; see ``RunSettings``."""

    t_end: float


def load(source: "str | Path | Source | Scene", changes: Changes | None = None) -> Gearbox:
    """Return a gearbox by the name of a shipped scene, the path of a TOML file, or a scene; see ``Gearbox``."""
    return Gearbox(source, changes)


def read_result(path: str | Path) -> SimulationResult:
    """Read a result file.

    Raises
    ------
    LtcgearError
        If it is missing, damaged or not a result of ltcgear.
    """
    return SimulationResult.of(results.load(path))


def _refuse_result(source: object) -> None:
    """Say what reads a result where a scene is expected."""
    if isinstance(source, str | Path) and Path(source).suffix == ".nc":
        raise LtcgearError(f"{source}: holds results, not a scene; ltcgear.read_result reads it")
