"""Errors of runs, of perturbations that are known."""

from dataclasses import replace
from math import log10, pi, sqrt

import numpy as np
import pytest
from ltcgear.runtime.studies.accuracy.run_errors import KINDS, ComparedSamples, find_errors, take_samples, value_of
from ltcgear.runtime.studies.selftest.case import Bench

from ..models import case

RATE = 4096.0
TIME = np.arange(4096) / RATE
PHASE = 40 * TIME
SWING = np.sin(2 * pi * PHASE)
OTHER = np.cos(2 * pi * 3 * PHASE)
SUNS = ("a.sun_planet.1", "a.sun_planet.2")


def samples(one=0.0, two=0.0, bearing=0.0, twist=0.0, state=0.0, dead=0.0):
    """Two planets' mesh forces of 100 and 80 N with swings of 10 and 8, a bearing, a member; and what is added."""
    forces = {SUNS[0]: 100 + 10 * SWING + one, SUNS[1]: 80 + 8 * SWING + two}
    bearings = {"b": (30 + 5 * SWING) + 1j * (40 + 5 * OTHER) + bearing, "c": 1e-9 * OTHER + dead}
    return ComparedSamples(
        np.zeros((len(TIME), 1)), {"x": SWING + state, "y": SWING},
        {"mesh_force": forces, "bearing_force": bearings, "transmission_error": {"m": 1e-3 * (2 + SWING) + twist}},
        dict.fromkeys(SUNS, PHASE), [list(SUNS)],
    )  # fmt: skip


def test_the_same_run_has_no_errors():
    found = find_errors(samples(), samples())
    assert {kind: value_of(found, kind) for kind in KINDS} == dict.fromkeys(KINDS, 0.0)
    assert found["apart"] == 0.0


def test_errors_are_those_that_were_put_in():
    found = find_errors(samples(), samples(two=0.16 * OTHER, bearing=0.1 * SWING, twist=1e-5, state=0.2 * OTHER))
    mesh = found["mesh_force"]
    assert mesh["item"] == SUNS[1]
    assert mesh["rms_over_vibration"] == mesh["value"] == pytest.approx(0.16 / 8, rel=1e-6)
    assert mesh["peak_over_vibration"] == pytest.approx(0.16 / (8 / sqrt(2)), rel=1e-3)
    assert mesh["rms_over_mean"] == pytest.approx(0.16 / sqrt(2) / 80, rel=1e-6)
    assert mesh["peak_over_mean"] == pytest.approx(0.16 / 80, rel=1e-3)
    bearing = found["bearing_force"]
    assert bearing["item"] == "b"
    assert bearing["value"] == pytest.approx((0.1 / sqrt(2)) / 5, rel=1e-6)  # 5 = sqrt(5^2 / 2 + 5^2 / 2)
    assert bearing["rms_over_mean"] == pytest.approx((0.1 / sqrt(2)) / 50, rel=1e-6)  # 30 and 40 make 50
    assert value_of(found, "transmission_error") == pytest.approx(1e-5 / (1e-3 / sqrt(2)), rel=1e-6)
    assert found["states"] == {"value": pytest.approx(0.2 / sqrt(2), rel=1e-6), "item": "x"}


def test_load_share_and_spectrum():
    found = find_errors(samples(), samples(one=-1 + 0.1 * SWING, two=1.0))
    assert value_of(found, "load_share") == pytest.approx(1 / 90, rel=1e-6)
    assert found["spectrum"]["value"] == pytest.approx(20 * log10(10.1 / 10), rel=1e-3)
    assert (found["spectrum"]["item"], found["spectrum"]["order"]) == (SUNS[0], 1)


def test_forces_that_cancel_are_no_vibration():
    """Bearing c carries rounding alone, and an error of its own size must not count."""
    assert value_of(find_errors(samples(), samples(dead=1e-9 * SWING)), "bearing_force") == 0.0


def test_samples_on_a_jump_are_left_out():
    here = np.isin(np.arange(len(TIME)), (100, 2000))
    run = samples(one=np.where(here, 50.0, 0.0))
    assert value_of(find_errors(samples(), run), "mesh_force") > 0.1
    jumped = replace(run, levels=here[:, None].astype(float))
    found = find_errors(samples(), jumped)
    assert value_of(found, "mesh_force") == value_of(found, "spectrum") == 0.0
    assert found["apart"] == 2 / len(TIME)


def bench_of(name, *settings):
    found = case(name, *settings)
    return Bench(found.library, found.model.values(), found.model.tables)


def test_a_trajectory_is_read_by_name():
    bench = bench_of("hsp")
    path = bench.run("erk", t_end=0.02, rate=RATE, rtol=1e-5)
    scale = bench.point.scale
    i = case("hsp").state("hsp.sun.u")
    x = path.x.copy()
    x[:, i] += 0.25 * scale[i]
    one, two = take_samples(bench, path), take_samples(bench, replace(path, x=x))
    found = find_errors(one, two)
    assert found["states"] == {"value": pytest.approx(0.25), "item": "hsp.sun.u"}
    assert found["transmission_error"]["item"] == "hsp.sun"
    assert all("planet" not in name for name in one.signals["transmission_error"])
    assert found["mesh_force"]["item"].startswith("hsp.sun_planet")  # the sun does not mesh with the ring
    assert {"hsp.pin.1", "hsp.sun"} <= set(one.signals["bearing_force"])
