"""Derivatives of means and RMS of runs: against differences of runs, and against scaling laws."""

import numpy as np
import pytest
from ltcgear.generated.contract import CONTINUOUS, REGIME
from ltcgear.generated.errors import LtcgearError, SolverError
from ltcgear.runtime.model.equilibrium import find_equilibrium
from ltcgear.runtime.model.operating_point import OperatingPoint
from ltcgear.runtime.simulation.run_settings import RunSettings
from ltcgear.runtime.studies.sensitivity.adjoint import differentiate_output
from ltcgear.runtime.studies.sensitivity.course import follow_course
from ltcgear.runtime.studies.sensitivity.ranking import list_influences
from ltcgear.runtime.studies.sensitivity.worth import find_output, find_worth, quadrature

from ..models import TORQUE_DRIVEN, case

EXACT, SMALL = 1e-4, 1e-6
"""Relative error of derivatives; share of the measure for 100 % of a parameter below which none is compared."""
COASTING = (
    "-loads.input.speed",
    'loads.input.torque = "-2.9e4 N*m"',
    'loads.input.initial_speed = "-639 rpm"',
)
SMOOTH = ('effects.mesh_stiffness = "smooth"', "stages.psh.mesh.transition = 0.1")
HAMMERING = (
    "-loads.input.speed_over_time",
    'loads.input.speed = "1150 rpm"',
    "-loads.flywheel.speed_over_time",
    'loads.flywheel.speed = "-1150 rpm"',
    "-loads.output.torque_over_time",
    'loads.output.torque = "70.4769 N*m"',
    'stages.pair.mesh.transmission_error.amplitudes = ["20 um"]',
)
"""The dead band at a constant speed, with an error so large that teeth part and meet on both flanks."""


def differentiate(c, output, **options):
    measure, start = options.pop("measure", "rms"), options.pop("start")
    settings = RunSettings(**{"method": "erk", "rtol": 1e-9, "tables": c.model.tables} | options)
    place = find_output(c.library.manifest, output)
    return differentiate_output(c.point, place, settings, measure=measure, start=start)


def measured(c, p, output, measure, start, t_end):
    """The measure of a run from the equilibrium of other parameters, at a tight tolerance."""
    at = find_equilibrium(c.library, p, tables=c.model.tables)
    course = follow_course(
        OperatingPoint(c.library, p, at), RunSettings(t_end, None, "erk", 1e-11, tables=c.model.tables)
    )
    return find_worth(course, find_output(c.library.manifest, output), measure, start).value


def difference(c, i, h, *run, sides=(1, -1)):
    """dJ/dp by central differences extrapolated once, or towards one side by parabolas."""

    def at(step):
        p = c.p.copy()
        p[i] += step
        return measured(c, p, *run)

    if sides == (1, -1):
        coarse, fine = ((at(step) - at(-step)) / (2 * step) for step in (h, h / 2))
        return (4 * fine - coarse) / 3
    here, step = measured(c, c.p, *run), sides[0] * h
    return (4 * at(step / 2) - at(step) - 3 * here) / step


@pytest.mark.parametrize(
    ("name", "settings", "run", "chosen", "step"),
    [
        (
            "psh", (), ("mesh_force:psh.mesh", "rms", 0.01, 0.03),
            ("mesh.single_share", "reference.speed", "mesh.stiffness_double", "output.inertia", "input.mass",
             "bearing.damping", "output.torque", "mesh.base_radius_2"),
            1e-4,
        ),
        (
            "psh", COASTING, ("mesh_force:psh.mesh", "vibration", 0.005, 0.02),
            ("mesh.single_share", "reference.speed", "mesh.stiffness_single", "input.inertia", "input.torque"), 2e-5,
        ),
        (
            "psh", SMOOTH, ("mesh_force:psh.mesh", "vibration", 0.005, 0.02),
            ("mesh.single_share", "mesh.transition", "mesh.phase", "reference.speed", "mesh.stiffness_single"), 2e-5,
        ),
        (
            "lsp", (), ("mesh_force:lsp.ring_planet.2", "vibration", 0.01, 0.03),
            ("sun_planet.single_share", "ring_planet.stiffness_double", "reference.speed", "planet.mass",
             "sun_planet.2.phase"),
            2e-5,
        ),
        (
            "hard-dead-band", HAMMERING, ("mesh_force:pair.mesh", "rms", 0.005, 0.012),
            ("backlash", "transmission_error_cos_1", "reference.speed", "output.inertia", "mesh.phase",
             "mesh.stiffness", "damper.damping"),
            1e-7,
        ),
        (
            "hard-dead-band", (*HAMMERING, 'effects.mesh_damping = "on"', "stages.pair.mesh.damping_ratio = 0.1"),
            ("mesh_force:pair.mesh", "rms", 0.005, 0.012),
            ("backlash", "transmission_error_cos_1", "reference.speed", "output.inertia", "mesh.damping"), 1e-7,
        ),
        (
            "psh", (), ("mesh_force:psh.mesh", "max", 0.01, 0.03),
            ("mesh.single_share", "reference.speed", "mesh.stiffness_double", "output.inertia", "output.torque"), 1e-5,
        ),
        (
            "psh", SMOOTH, ("mesh_force:psh.mesh", "min", 0.005, 0.02),
            ("mesh.single_share", "mesh.transition", "reference.speed", "mesh.stiffness_single"), 1e-4,
        ),
        (
            "lsp", (), ("mesh_force:lsp.sun_planet.2", "min", 0.01, 0.03),
            ("sun_planet.single_share", "sun_planet.stiffness_double", "reference.speed", "planet.mass"), 1e-5,
        ),
        (
            "lsp", (), ("pin_force_x:lsp.pin.1", "max", 0.01, 0.03),
            ("sun_planet.single_share", "sun_planet.stiffness_double", "reference.speed", "planet.mass"), 1e-5,
        ),
        (
            "hard-dead-band", HAMMERING, ("mesh_force:pair.mesh", "max", 0.005, 0.012),
            ("backlash", "transmission_error_cos_1", "reference.speed", "output.inertia", "mesh.stiffness"), 1e-7,
        ),
        (
            "start-up", (), ("coupling_torque:slow", "rms", 0.1, 0.14),
            ("breakdown_torque", "slow.stiffness", "generator.inertia", "slow.damping"), 1e-4,
        ),
    ],
)  # fmt: skip
def test_derivatives_are_those_of_differences(name, settings, run, chosen, step):
    c = case(name, *settings)
    output, measure, start, t_end = run
    found = differentiate(c, output, measure=measure, start=start, t_end=t_end)
    assert found.value == pytest.approx(measured(c, c.p, *run), rel=1e-7)
    wanted = [i for i, (n, _) in enumerate(c.library.manifest.parameters) if n.endswith(chosen)]
    assert len(wanted) >= len(chosen)
    for i in wanted:
        size = abs(c.p[i]) or 1.0
        expected = difference(c, i, step * size, *run)
        error = abs(found.gradient[i] - expected)
        parameter = c.library.manifest.parameters[i][0]
        assert error <= EXACT * abs(expected) + SMALL * found.value / size, (parameter, found.gradient[i], expected)


@pytest.mark.parametrize(
    ("measure", "mesh", "side"),
    [("max", "sun_planet.1", "start"), ("max", "ring_planet.1", "inside"), ("min", "ring_planet.1", "end")],
)
def test_extremes_are_found_beside_jumps_and_between(measure, mesh, side):
    """A force jumps up with its own stiffness, and bends where another's jumps."""
    c = case("lsp")
    course = follow_course(c.point, RunSettings(0.03, None, "erk", 1e-9))
    place = find_output(c.library.manifest, f"mesh_force:lsp.{mesh}")
    worth = find_worth(course, place, measure, 0.01)
    assert worth.instant.side == side
    path = c.run(method="erk", rtol=1e-9, t_end=0.03, rate=5e5)
    y = c.quantity("mesh_force", path.x, path.levels)[f"lsp.{mesh}"][path.time >= 0.01]
    seen = y.max() if measure == "max" else y.min()
    assert worth.value == pytest.approx(seen, rel=1e-4)
    assert (worth.value - seen) * (1 if measure == "max" else -1) > -1e-9 * abs(seen)


def test_a_phase_on_its_border_has_the_derivative_of_one_that_has_gone_on():
    c, run = case("psh"), ("mesh_force:psh.mesh", "rms", 0.01, 0.02)
    found = differentiate(c, run[0], start=run[2], t_end=run[3])
    i = [name for name, _ in c.library.manifest.parameters].index("psh.mesh.phase")
    assert "psh.mesh.phase" in found.one_sided
    ahead, behind = (difference(c, i, 1e-4, *run, sides=(side,)) for side in (1, -1))
    assert found.gradient[i] == pytest.approx(ahead, rel=1e-4)
    assert abs(behind - ahead) > 0.05 * abs(ahead)


@pytest.mark.parametrize("settings", [(), TORQUE_DRIVEN])
def test_forces_scale_with_all_that_is_heavy_and_stiff(settings):
    """Masses, stiffnesses, dampers and torques all up by one part: every force too, and no motion changes."""
    c = case("rig-2mw", *settings)
    found = differentiate(c, "mesh_force:psh.mesh", measure="vibration", start=0.01, t_end=0.03)
    scaled = ("kg", "kg*m^2", "N/m", "N*m/rad", "N*s/m", "N*m*s/rad", "N*m", "N")
    shares = [
        found.gradient[i] * c.p[i] / found.value
        for i, (_, unit) in enumerate(c.library.manifest.parameters)
        if unit in scaled
    ]
    assert np.abs(shares).max() > 0.1
    assert sum(shares) == pytest.approx(1.0, abs=1e-6)


def test_whole_turns_do_not_matter():
    """A mean over many turns of the input, of a run from whose angle turns are taken off."""
    c = case("psh", 'loads.input.speed = "-6000 rpm"')
    run = ("mesh_force:psh.mesh", "vibration", 0.031, 0.045)
    found = differentiate(c, run[0], measure=run[1], start=run[2], t_end=run[3])
    for name in ("reference.speed", "psh.mesh.single_share"):
        i = [name for name, _ in c.library.manifest.parameters].index(name)
        assert found.gradient[i] == pytest.approx(difference(c, i, 1e-6 * c.p[i], *run), rel=1e-3)


def test_a_jump_on_the_edge_of_the_window_is_told():
    c = case("psh", 'loads.input.speed = "-6000 rpm"')
    found = differentiate(c, "mesh_force:psh.mesh", start=0.01, t_end=0.0145)  # a turn, 59 pitches
    assert found.edges == [0.01]
    assert differentiate(c, "mesh_force:psh.mesh", start=0.0101, t_end=0.0145).edges == []


def test_measures_are_those_of_simulations():
    c = case("psh")
    path = c.run(method="erk", rtol=1e-8, t_end=0.05, rate=2e5)
    y = c.quantity("mesh_force", path.x, path.levels)["psh.mesh"][path.time >= 0.025]
    for measure, expected in (("mean", y.mean()), ("rms", np.sqrt((y**2).mean())), ("vibration", y.std())):
        found = measured(c, c.p, "mesh_force:psh.mesh", measure, 0.025, 0.05)
        assert found == pytest.approx(expected, rel=2e-3 if measure == "vibration" else 1e-4)


def test_quadrature_is_exact_for_polynomials():
    points = (1 - np.cos(np.pi * np.arange(13) / 12)) / 2
    for power in range(13):
        assert quadrature(12) @ points**power == pytest.approx(1 / (power + 1), rel=1e-13)


def test_chaos_is_refused():
    c = case("hard-dead-band", *HAMMERING)
    with pytest.raises(SolverError, match=r"chaotic.*simulate less time"):
        differentiate(c, "mesh_force:pair.mesh", start=0.05, t_end=0.1)


def test_what_cannot_be_measured_is_refused():
    c = case("psh")
    for wanted, reason in (
        ("mesh_phase:psh.mesh", "grows with time"),
        ("mesh_force:psh.msh", "nearest: psh.mesh"),
        ("force:psh.mesh", "no such quantity"),
    ):
        with pytest.raises(LtcgearError, match=reason):
            find_output(c.library.manifest, wanted)


def test_an_output_that_is_a_step_is_refused():
    with pytest.raises(LtcgearError, match=r"mesh_contact:pair\.mesh: it jumps"):
        differentiate(case("hard-dead-band", *HAMMERING), "mesh_contact:pair.mesh", start=0.0, t_end=0.001)


def test_ranking_puts_sizes_first_and_leaves_out_what_is_whole():
    c = case("rig-2mw")
    manifest = c.library.manifest
    rows = list_influences(manifest, c.p, 2.0, np.arange(1.0, len(c.p) + 1))
    kinds = [row.kind for row in rows]
    assert kinds == sorted(kinds, reverse=True)
    sizes = [abs(row.relative) for row in rows if row.kind == "size"]
    assert (np.diff(sizes) <= 1e-9 * max(sizes)).all()  # largest first; ties stand by name
    left_out = {name.rsplit(".", 1)[-1] for name, _ in manifest.parameters} - {
        row.parameter.rsplit(".", 1)[-1] for row in rows
    }
    assert left_out == {"origin", "speed_ratio", "teeth_1", "cycles", "flank"}
    assert REGIME not in CONTINUOUS
