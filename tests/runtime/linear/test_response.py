"""Frequency response against a closed form, against time simulation, and against what every linear system keeps."""

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.linear.inputs import find_paths, list_torques
from ltcgear.runtime.linear.modes import find_modes
from ltcgear.runtime.linear.response import MOTION, choose_frequencies, find_peaks, respond
from ltcgear.runtime.linear.system import linearise

from ..models import case, make_case

TWO_PI = 2 * np.pi


def linear_of(c):
    return linearise(c.point)


# --- one gear pair: m x'' + c (x' - e') + k (x - e) = 0 along the line of action


def pair(speed="120 rpm", **effects):
    """A pair that only turns, its input held: one freedom of the mass I_2 / r_2^2."""
    wheel = {"support": "rigid", "inertia": "0.02 kg*m^2"}
    return make_case(
        {
            "title": "pair that only turns",
            "effects": {"mesh_stiffness": "mean", "lateral": "off", **effects},
            "stages": {
                "gear": {
                    "kind": "pair", "module": "3 mm", "pressure_angle": "20 deg",
                    "input": wheel | {"teeth": 25}, "output": wheel | {"teeth": 40},
                    "mesh": {"stiffness": "3e8 N/m", "damping": "4000 N*s/m"},
                }
            },
            "loads": {
                "drive": {"member": "gear.input", "speed": speed},
                "brake": {"member": "gear.output", "torque": "300 N*m"},
            },
        }
    )  # fmt: skip


def test_one_pair_has_the_closed_form():
    linear, k, c = linear_of(pair()), 3e8, 4e3
    radius = 40 * 3e-3 / 2 * np.cos(np.deg2rad(20))
    m = 0.02 / radius**2
    f = np.sqrt(k / m) / TWO_PI * np.array([0.01, 0.5, 0.99, 1.0, 1.3, 20.0])
    w = TWO_PI * f
    spring = k + 1j * w * c
    below = spring - m * w**2
    error = respond(linear, "gear.mesh", f)
    assert error.of(MOTION, "gear.mesh") == pytest.approx(spring / below, rel=1e-9)
    assert error.of("mesh_force", "gear.mesh") == pytest.approx(spring * m * w**2 / below, rel=1e-9)
    ripple = respond(linear, "brake", f)
    assert abs(ripple.of("mesh_force", "gear.mesh")) == pytest.approx(abs(spring / below) / radius, rel=1e-9)


# --- against time simulation


ERROR = 1e-8  # [m]: small enough for what is not linear to stay below 1e-4


SPEEDS = {"psh": (400.0, 686.9, 980.0), "lsp": (60.0, 117.0, 235.9)}
"""Mesh frequencies [Hz]: below, in and beside a resonance."""


def steady_amplitudes(c, frequency, slowest):
    """Mesh forces and motions at a frequency after transients have died out, as complex amplitudes against time."""
    periods, samples = 20, 64
    rate = frequency * samples
    settled = np.ceil(frequency * slowest) / frequency
    path = c.run(t_end=settled + periods / frequency, rate=rate, method="erk", rtol=1e-10)
    last = slice(-periods * samples, None)
    wave = np.exp(-1j * TWO_PI * frequency * path.time[last]) * 2 / (periods * samples)
    found = c.outputs(path.x[last], path.s[last])
    kinds = ("mesh_force", "pin_force_x", "bearing_force_y", "coupling_torque")
    return {key: wave @ values for key, values in found.items() if key[0] in kinds}


@pytest.mark.parametrize(("name", "hertz"), [(name, hertz) for name, some in SPEEDS.items() for hertz in some])
def test_a_small_error_does_what_a_run_shows(name, hertz):
    """All meshes of a group have the error at once, each at its own phase: responses add up."""
    plain = case(name, "effects.mesh_stiffness = 'mean'")
    stage, group = {"psh": ("psh", "mesh"), "lsp": ("lsp", "sun_planet")}[name]
    teeth = {"psh": 59, "lsp": 118}[name]
    load = {"psh": "input", "lsp": "ring"}[name]
    sense = -1 if plain.p[[n for n, _ in plain.library.manifest.parameters].index("reference.speed")] < 0 else 1
    rpm = sense * 60 * hertz / teeth
    c = case(
        name, "effects.mesh_stiffness = 'mean'", "effects.transmission_error = 'on'",
        f"loads.{load}.speed = '{rpm!r} rpm'", f"stages.{stage}.{group}.transmission_error.amplitudes = ['{ERROR} m']",
    )  # fmt: skip
    linear = linear_of(c)
    modes = find_modes(linear)
    slowest = 25 / min(abs(mode.eigenvalue.real) for mode in modes)
    found = steady_amplitudes(c, hertz, slowest)
    number = dict(zip([n for n, _ in c.library.manifest.parameters], c.p, strict=True))
    expected = {}
    for mesh in [m for m in find_paths(linear) if m.startswith(f"{stage}.{group}")]:
        response = respond(linear, mesh, np.array([hertz]))
        ahead = ERROR * np.exp(1j * TWO_PI * number[f"{mesh}.phase"])
        for (quantity, item, _), value in zip(response.outputs, response.values[0], strict=True):
            expected[quantity, item] = expected.get((quantity, item), 0) + ahead * value
    everything = max(map(abs, found.values()))
    for key, value in found.items():
        largest = max(abs(found[other]) for other in found if other[0] == key[0])
        # What the planets' symmetry leaves to be zero is rounding.
        assert abs(expected[key] - value) < max(1e-3 * largest, 1e-7 * everything), key


# --- what every linear system keeps


def undamped(*settings):
    return case("lin-parker-4", *settings)


def test_at_rest_and_undamped_the_response_is_reciprocal():
    """Motion at one mesh by a force at another is the other's by the one (Maxwell, Betti)."""
    linear = linear_of(undamped())
    names, f = list(find_paths(linear)), np.array([500.0, 1700.0, 9000.0])
    paths = find_paths(linear)
    for one, two in ((names[0], names[1]), (names[0], names[-1]), (names[2], names[5])):
        there = respond(linear, one, f).of(MOTION, two) / paths[one].stiffness
        back = respond(linear, two, f).of(MOTION, one) / paths[two].stiffness
        assert there == pytest.approx(back, rel=1e-9)
        assert abs(there).max() > 0


@pytest.mark.parametrize("settings", [(), ("effects.mesh_law = 'paper'",), ("effects.lateral = 'off'",)])
def test_the_push_of_a_level_is_that_of_the_work(settings):
    """Two routes to one vector: what a level does to the rates, and the mass matrix with the deflection's gradient."""
    linear = linear_of(case("rig-2mw", *settings))
    size = linear.scale[linear.kept]
    paths = find_paths(linear)
    assert set(linear.library.manifest.levels) <= set(paths)
    for mesh in linear.library.manifest.levels:
        path, push = paths[mesh], np.zeros(len(linear.kept))
        push[linear.rates] = -np.linalg.solve(linear.mass, path.deflection[linear.positions])
        bound = 1e-3 if settings and "paper" in settings[0] else 1e-10
        assert np.linalg.norm((push - path.push) / size) < bound * np.linalg.norm(push / size)
        assert path.stiffness > 0


def test_friction_pushes_across_the_line_of_action():
    """The friction of a mesh follows its normal force, which the work does not see."""
    c = case(
        "psh",
        "effects.mesh_friction = 'pitch-point'",
        "stages.psh.mesh.friction = {coefficient = 0.1, speed = '1 mm/s'}",
    )
    linear = linear_of(c)
    path = find_paths(linear)["psh.mesh"]
    push = np.zeros(len(linear.kept))
    push[linear.rates] = -np.linalg.solve(linear.mass, path.deflection[linear.positions])
    state = [linear.names.index(f"psh.output.{axis}.rate") for axis in "xy"]
    both = np.array([push[state], path.push[state]])
    across = both[1] - both[0]
    assert across @ both[0] == pytest.approx(0, abs=1e-6 * float(both[0] @ both[0]))
    assert 0 < np.linalg.norm(across) <= 0.1001 * np.linalg.norm(both[0])


# --- choosing and finding


def test_frequencies_show_every_resonance():
    linear = linear_of(case("lsp"))
    modes = find_modes(linear)
    f = choose_frequencies(modes)
    for mode in modes:
        assert np.abs(f - mode.eigenvalue.imag / TWO_PI).min() < 1e-9 * mode.frequency_hz
    assert choose_frequencies(modes, 10.0, 20.0)[[0, -1]] == pytest.approx([10.0, 20.0])
    response = respond(linear, "lsp.sun_planet.1", f)
    column = response.outputs.index(("mesh_force", "lsp.sun_planet.1", "N"))
    for place, mode in find_peaks(response, column, modes)[:3]:
        assert abs(f[place] - modes[mode].frequency_hz) < abs(modes[mode].eigenvalue.real) / TWO_PI


def test_a_peak_is_named_after_the_mode_that_gives_most_of_it():
    """What excites, written in right vectors alone (no left ones): the largest part at every peak."""
    linear = linear_of(case("psh"))
    modes = find_modes(linear)
    response = respond(linear, "output", choose_frequencies(modes))
    shapes = np.array([mode.shape for mode in modes])
    amounts = np.linalg.solve(np.concatenate([shapes, shapes.conj()]).T, response.push)[: len(modes)]
    named = set()
    for column in range(len(response.outputs)):
        for place, mode in find_peaks(response, column, modes):
            iw = 1j * TWO_PI * response.frequency[place]
            parts = [
                abs(response.rows[column] @ m.shape * a / (iw - m.eigenvalue))
                for m, a in zip(modes, amounts, strict=True)
            ]
            assert mode == int(np.argmax(parts))
            named.add(mode)
    assert len(named) > 2


def test_without_damping_resonances_are_kept_off():
    linear = linear_of(undamped())
    modes = find_modes(linear)
    f = choose_frequencies(modes)
    own = np.array([mode.frequency_hz for mode in modes if mode.frequency_hz > 0])
    assert np.abs(f[:, None] / own - 1).min(axis=0) == pytest.approx(2.5e-6, rel=1e-3)
    response = respond(linear, next(iter(find_paths(linear))), f)
    assert np.isfinite(response.values).all()


def test_a_train_that_is_driven_by_torque_answers_as_a_free_body_at_low_frequency():
    """Far below all elastic modes a ripple accelerates the whole train: the shaft passes on what is behind it."""
    raw = {
        "title": "two rotors",
        "rotors": {"a": {"inertia": "2 kg*m^2"}, "b": {"inertia": "3 kg*m^2"}},
        "couplings": {"shaft": {"between": ["a", "b"], "stiffness": "1e6 N*m/rad"}},
        "loads": {"motor": {"member": "a", "torque": "0 N*m", "initial_speed": "30 rpm"}},
    }
    response = respond(linear_of(make_case(raw)), "motor", np.array([0.01, 1.0]))
    assert abs(response.of("coupling_torque", "shaft")) == pytest.approx([0.6, 0.6], rel=1e-3)


@pytest.mark.parametrize("ends", [(0.0, 1.0), (-1.0, 1.0), (2.0, 1.0), (float("nan"), 1.0), (1.0, float("inf"))])
def test_ends_that_are_no_range_are_refused(ends):
    with pytest.raises(LtcgearError, match="0 < from < to"):
        choose_frequencies(find_modes(linear_of(case("psh"))), *ends)


def test_what_does_not_excite_is_refused_with_the_nearest_name():
    linear = linear_of(case("lsp"))
    assert list_torques(linear) == ["sun"]
    with pytest.raises(LtcgearError, match=r"did you mean lsp.sun_planet.1"):
        respond(linear, "lsp.sun_plan.1", np.array([1.0]))
    with pytest.raises(LtcgearError, match="loads with a torque: sun"):
        respond(linear, "ring", np.array([1.0]))
