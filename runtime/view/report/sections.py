"""Sections of the report below the stages, each with its figures or why it has none."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache, partial
from typing import TYPE_CHECKING, Any

import numpy as np
from ltcgear.generated.errors import LtcgearError, MachineError

from ...analysis.band import RAW, find_band
from ...analysis.lines import Clues, find_clues, name_lines, turns_per_second
from ...analysis.orbits import find_orbit, list_members
from ...analysis.order_spectrum import choose_shaft, find_order_spectrum, shaft_angle
from ...analysis.sharing import find_leads, find_load_share, list_groups
from ...analysis.span import CHANGING, cut, speed_change
from ...analysis.spectrum import find_spectrum
from ...analysis.trace import list_items, phase_of, pick, select_output
from ...analysis.waterfall import STANDING, find_waterfall, mesh_courses
from ...model.ties import order_by_size
from ...results.train_record import read_train
from ..figures.course_figures import draw_speeds, draw_torques, is_changing
from ..figures.load_figures import carrier_turns, draw_forces, draw_shares
from ..figures.orbit_figures import draw_orbits
from ..figures.spectrum_figures import draw_spectrogram, draw_spectrum, draw_waterfall
from .march_figure import draw_steps, draw_switchings
from .pictures import make_picture

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from ...linear.modes import Mode
    from ...results.table import Table

MOST = 8
"""Figures of one kind in a page."""


@dataclass
class Section:
    """A part of the page: what it is called, what is said, and its figures."""

    key: str
    title: str
    text: list[str]
    pictures: list[dict[str, Any]] = field(default_factory=list)
    modes: list[str] = field(default_factory=list)
    tables: list[Table] = field(default_factory=list)
    moves: bool = False

    def draw(self, draw: Callable[[], Figure], caption: str, height: float, **size: Any) -> None:  # noqa: ANN401
        """Add a figure, or the reason why it cannot be drawn."""
        try:
            figure = draw()
        except MachineError:
            raise
        except LtcgearError as error:
            told = f"Not drawn: {error}"
            self.text += [told] if told not in self.text else []
            return
        self.pictures.append(make_picture(figure, f"{self.key}{len(self.pictures)}", caption, height, **size))


def make_sections(dataset: xr.Dataset, modes: tuple[Mode, ...]) -> list[Section]:
    """Draw the figures of a result; call it while figures are ``themed``.

    Parameters
    ----------
    dataset
        The whole record.
    modes
        Modes by which lines are named; none if they are not known.
    """
    makers = (_course, _forces, _shares, _spectra, _waterfall, _orbits, _march)
    return [section for make in makers for section in make(dataset, modes)]


def _course(dataset: xr.Dataset, modes: tuple[Mode, ...]) -> Iterator[Section]:
    """Draw speeds and torques over time, where they change."""
    if is_changing(dataset):
        section = Section("course", "Speed and torque", ["Speeds and torques over the whole record."])
        section.draw(partial(draw_speeds, dataset), "Counter-clockwise is positive.", 3.1)
        section.draw(partial(draw_torques, dataset), "", 3.1)
        yield section


def _forces(dataset: xr.Dataset, modes: tuple[Mode, ...]) -> Iterator[Section]:
    """Draw mesh forces over time, of groups that carry any."""
    loads = {
        group: max(float(np.abs(pick(dataset, "mesh_force", mesh).values).max()) for mesh in meshes)
        for group, meshes in list_groups(dataset).items()
    }
    groups, idle = [name for name, load in loads.items() if load], [name for name, load in loads.items() if not load]
    if loads:
        text = ["Normal forces along the lines of action." + _left_out(groups)]
        text += [f"Without force throughout: {', '.join(idle)}."] if idle else []
        section = Section("forces", "Mesh forces", text)
        for group in groups[:MOST]:
            section.draw(partial(draw_forces, dataset, group), "Above the whole record, below its end.", 4.2)
        yield section


def _left_out(items: list[str]) -> str:
    """Say which items have no figure, because there are too many."""
    return f" Not drawn, for brevity: {', '.join(items[MOST:])}." if len(items) > MOST else ""


def _shares(dataset: xr.Dataset, modes: tuple[Mode, ...]) -> Iterator[Section]:
    """Draw how planets share loads."""
    groups = [name for name, meshes in list_groups(dataset).items() if len(meshes) > 1]
    if not groups:
        return
    text = "How planets share the load of a stage in the second half of the record; 1 is an equal share."
    section = Section("share", "Load share", [text + _left_out(groups)])

    def draw(group: str) -> Figure:
        part = cut(dataset)
        return draw_shares(find_load_share(part, group), carrier_turns(part, read_train(part).stage(group)))

    for group in groups[:MOST]:
        section.draw(partial(draw, group), "Means in the legend; the mesh load factor is the largest.", 4.9)
    yield section


def _spectra(dataset: xr.Dataset, modes: tuple[Mode, ...]) -> Iterator[Section]:
    """Draw spectra of a mesh force of each group of meshes, and of the liveliest accelerations."""
    lively = _liveliest(dataset)
    wanted = [("mesh_force", mesh) for mesh in find_leads(dataset.isel(time=slice(dataset.sizes["time"] // 2, None)))]
    wanted = [*wanted[: MOST - len(lively)], *lively]
    if not wanted:
        return
    section = Section("spectra", "Spectra", [
        "Second half of the record. The strongest lines are numbered and named by what explains them: harmonics of "
        "mesh frequencies (“2 hsp”), sidebands, turns of shafts, or modes of the linearised model where the line dies "
        "away as they do."
    ])  # fmt: skip
    try:
        part = cut(dataset)
    except LtcgearError as error:
        section.text.append(f"Not drawn: {error}")
        yield section
        return
    changing = speed_change(part)
    if changing > CHANGING:
        section.text.append(f"Speeds change by {changing:.0%} there, so spectra are taken over turns of a shaft.")
    clues = find_clues(part, modes)
    section.text += [f"{RAW[0].upper()}{RAW[1:]}."] if clues.band.raw else []
    for quantity, item in wanted:
        section.draw(partial(_spectrum, part, quantity, item, clues, changing > CHANGING), "", 3.1)
    yield section


def _spectrum(part: xr.Dataset, quantity: str, item: str, clues: Clues, turning: bool) -> Figure:
    """Draw the spectrum of an output, over the turns of the fastest rotor where speeds change."""
    signals = list(select_output(part, f"{quantity}:{item}"))
    for signal in signals:
        _refuse_constant(signal)
    end = clues.band.end_hz
    rotor = choose_shaft(part, read_train(part).stage(item)) if turning else None
    if rotor is not None:
        angle = shaft_angle(part, rotor)
        spectrum = find_order_spectrum(signals[0], angle, highest_hz=end)
        each, signals = turns_per_second(angle), []
        clues, end = clues.over(each), float(spectrum.axis[-1])
    else:
        spectrum = find_spectrum(*signals)
    return draw_spectrum(spectrum, name_lines(spectrum, clues, 8, end, signals), end)


def _refuse_constant(signal: xr.DataArray) -> None:
    """Refuse a signal that does not vary, as nothing is to be seen of its spectrum."""
    if not np.ptp(signal.values) > 0.0:
        item = next(str(value.values) for key, value in signal.coords.items() if key != "time")
        raise LtcgearError(f"the {signal.attrs['long_name']} of {item} does not vary")


def _liveliest(dataset: xr.Dataset) -> list[tuple[str, str]]:
    """Return the accelerations of the two members that shake most, no two of one kind."""
    members = list_items(dataset, "acceleration_x")
    if not members:
        return []
    half = dataset.sizes["time"] // 2
    shaking = np.hypot(*(dataset[f"acceleration_{a}"].values[half:].std(axis=0) for a in "xy"))
    train, kinds = read_train(dataset), dict[str, str]()
    for k in order_by_size(shaking, members):
        if shaking[k] > 0:
            kinds.setdefault(train.label(members[k]), members[k])
    return [("acceleration", member) for member in list(kinds.values())[:2]]


def _waterfall(dataset: xr.Dataset, modes: tuple[Mode, ...]) -> Iterator[Section]:
    """Draw a spectrogram and a waterfall of the busiest mesh's force over the whole record."""
    mesh = _busiest(dataset)
    if mesh is None:
        return
    text = f"The force of {mesh}, the busiest mesh (mean force times teeth a second), as its spectrum changes."
    section = Section("waterfall", "Waterfall", [text])

    @cache
    def find() -> tuple[Any, Any, float]:
        _refuse_constant(pick(dataset, "mesh_force", mesh))
        rotor = choose_shaft(dataset)
        speed = None if rotor is None else pick(dataset, "speed", rotor)
        found = find_waterfall(pick(dataset, "mesh_force", mesh), speed)
        return found, mesh_courses(dataset, found), find_band(dataset).end_hz

    section.draw(lambda: draw_spectrogram(*find()), "Brighter is stronger.", 3.3)
    section.draw(lambda: draw_waterfall(*find()), "Spectra one above another.", 3.3)
    yield section


def _busiest(dataset: xr.Dataset) -> str | None:
    """Return the mesh that carries most, times the teeth that it passes a second; None if nothing meshes."""
    leads, time = find_leads(dataset), dataset["time"].values
    if not leads:
        return None
    carried = [float(np.abs(pick(dataset, "mesh_force", mesh).values).mean()) for mesh in leads]
    phases = [phase_of(dataset, mesh) for mesh in leads]
    passed = [0.0 if phase is None else float(np.ptp(phase.values)) for phase in phases]
    rates = np.array(passed) / max(float(time[-1] - time[0]), 1e-300)
    return leads[order_by_size(np.array(carried) * np.maximum(rates, STANDING), leads)[0]]


def _orbits(dataset: xr.Dataset, modes: tuple[Mode, ...]) -> Iterator[Section]:
    """Draw the paths of members that are no planets, floating ones first, then planets."""
    members = list_members(dataset)
    if not members:
        return
    text = (
        "Paths of members' centres in the second half of the record, in axes that turn with the stage's carrier as it "
        "is. A cross is the mean place, a slanted one the loaded equilibrium, a dashed circle a clearance."
    )
    section = Section("orbits", "Orbits", [text])
    try:
        part = cut(dataset)
    except LtcgearError as error:
        section.text.append(f"Not drawn: {error}")
        yield section
        return
    orbits = [find_orbit(part, member, dataset) for member in members]
    resting = [orbit.member for orbit in orbits if max(np.abs(orbit.x).max(), np.abs(orbit.y).max()) == 0.0]
    if resting:
        section.text.append(f"At rest: {', '.join(resting)}.")
    moving = [orbit for orbit in orbits if orbit.member not in resting]
    train = read_train(dataset)
    ordered = sorted(moving, key=lambda orbit: (not orbit.floating, train.is_planet(orbit.member)))
    for orbit in ordered[:MOST]:
        caption = f"RMS distance from the mean place: {orbit.rms * 1e6:.3g} µm"
        section.draw(partial(draw_orbits, [orbit]), caption, 2.6, width=2.6)
        section.pictures[-1] |= {"title": orbit.member + (", floating" if orbit.floating else ""), "legend": []}
    yield section


def _march(dataset: xr.Dataset, modes: tuple[Mode, ...]) -> Iterator[Section]:
    """Draw the integrator's steps and the switchings along time."""
    section = Section("march", "Steps and switchings", [
        "How the integrator went: the size of its steps, and how often stiffness switches or contacts change, as seen "
        "at the samples."
    ])  # fmt: skip
    section.draw(partial(draw_steps, dataset), "Mean between samples.", 2.6)
    section.draw(partial(draw_switchings, dataset), "Changes seen between samples, counted in short spans.", 2.6)
    yield section
