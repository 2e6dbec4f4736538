"""Load shares, transmission errors, durations, rainflow cycles, bearings and orbits, against closed forms."""

import json
import sys

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.analysis import (
    count_cycles,
    cut,
    find_load_duration,
    find_load_share,
    find_orbit,
    find_transmission_error,
    list_bearing_loads,
    select_output,
)
from ltcgear.runtime.analysis.span import speed_change
from ltcgear.runtime.analysis.transmission import harmonics_of

from ..outputs import output, result, times
from ..synthetic import make_dataset

TIME = times()
TURN = 2 * np.pi
WAVE = np.sin(TURN * 8.0 * TIME)


# --- shares


def planets(*forces):
    return result(TIME, mesh_force={f"lsp.sun_planet.{k}": force for k, force in enumerate(forces, start=1)})


def test_shares_of_known_forces():
    found = find_load_share(planets(80.0 + 10.0 * WAVE, 100.0, 120.0 - 10.0 * WAVE, 100.0), "lsp.sun_planet")
    assert found.mean == pytest.approx([0.8, 1.0, 1.2, 1.0])
    assert found.mesh_load_factor == pytest.approx(1.2)
    assert found.highest == pytest.approx([0.9, 1.0, 1.3, 1.0])
    assert found.lowest == pytest.approx([0.7, 1.0, 1.1, 1.0])
    assert found.largest == pytest.approx(1.3)
    assert found.share.sum(axis=1) == pytest.approx(4.0)


def test_shares_on_the_other_flank_are_the_same():
    found = find_load_share(planets(-80.0, -120.0), "lsp.sun_planet")
    assert found.mean == pytest.approx([0.8, 1.2])
    assert found.share[0] == pytest.approx([0.8, 1.2])


def test_where_no_load_is_carried_there_is_no_share():
    gone = np.where(TIME < 0.5, 1.0, 0.0)
    found = find_load_share(planets(90.0 * gone, 110.0 * gone), "lsp.sun_planet")
    assert np.isnan(found.share[TIME >= 0.5]).all()
    assert found.highest == pytest.approx([0.9, 1.1])


def test_groups_without_shares_are_refused():
    with pytest.raises(LtcgearError, match=r"psh.mesh: no group of several meshes; there are lsp.sun_planet"):
        find_load_share(planets(1.0, 1.0), "psh.mesh")
    with pytest.raises(LtcgearError, match="carries no load in the mean"):
        find_load_share(planets(WAVE, -WAVE), "lsp.sun_planet")


# --- transmission error


def sheet(name, one, two, sense, flank, radii, *others):
    """Write the sheet of a stage with one mesh."""
    stage = name.partition(".")[0]
    mesh = {"name": name, "stage": stage, "one": one, "two": two, "sense": sense, "flank": flank, "radii": radii}
    discs = [{"body": body, "stage": stage, "part": body.split(".")[1]} for body in (one, two, *others)]
    return {"sheet": json.dumps({"discs": discs, "meshes": [mesh]})}


def pair(twist_1, twist_2, deflection=0.0, flank=1.0):
    return result(
        TIME, {}, mesh_deflection={"psh.mesh": deflection}, mesh_phase={"psh.mesh": 100.0 * TIME},
        twist={"psh.input": twist_1, "psh.output": twist_2},
    ).assign_attrs(sheet("psh.mesh", "psh.input", "psh.output", 1, flank, [0.25, 0.1]))  # fmt: skip


def test_an_eccentric_gear_shows_once_a_turn():
    """Gear 1 turns evenly at 100/59 Hz, its teeth 50 um out of centre; gear 2 follows: r_2 u_2 = e sin(theta_1)."""
    swing = 50e-6 * np.sin(TURN * 100.0 / 59.0 * TIME)
    found = find_transmission_error(pair(0.0, swing / 0.1), "psh.mesh", "angles")
    assert found.value == pytest.approx(swing, abs=1e-18)
    assert found.peak_to_peak == pytest.approx(100e-6, rel=1e-3)


@pytest.mark.parametrize("flank", [1.0, -1.0])
def test_by_angles_and_by_deflection(flank):
    wave = 20e-6 + 3e-6 * np.cos(TURN * 100.0 * TIME) + 1e-6 * np.cos(TURN * 300.0 * TIME)
    dataset = pair(flank * wave / 0.25, 0.0, 0.5 * wave, flank)
    found = find_transmission_error(dataset, "psh.mesh", "angles")
    assert found.mean == pytest.approx(20e-6)
    assert found.vibration == pytest.approx(np.sqrt(5.0) * 1e-6)
    assert found.harmonics == pytest.approx((3e-6, 0.0, 1e-6, 0.0, 0.0, 0.0), abs=1e-11)
    other = find_transmission_error(dataset, "psh.mesh")
    assert other.definition == "deflection"
    assert other.harmonics[0] == pytest.approx(1.5e-6, rel=1e-6)


def test_a_planets_angles_are_those_against_the_carrier():
    """A carrier that winds up and takes all with it changes nothing."""
    wound = 0.7 * WAVE
    dataset = result(
        TIME, {}, mesh_deflection={"s.ring_planet.2": 0.0},
        twist={"s.carrier": wound, "s.ring": wound + 1e-4, "s.planet.2": wound + 2e-4},
    ).assign_attrs(
        sheet("s.ring_planet.2", "s.ring", "s.planet.2", -1, 1.0, [0.9, 0.3], "s.carrier")
    )  # fmt: skip
    found = find_transmission_error(dataset, "s.ring_planet.2", "angles")
    assert found.value == pytest.approx(0.9e-4 - 0.3 * 2e-4)
    assert np.isnan(found.harmonics).all()


def test_transmission_errors_that_cannot_be_known_are_refused():
    bare = pair(0.0, 0.0).drop_attrs()
    with pytest.raises(LtcgearError, match="does not hold the base radii"):
        find_transmission_error(bare, "psh.mesh", "angles")
    with pytest.raises(LtcgearError, match=r"hsp.mesh: no such mesh; there are psh.mesh"):
        find_transmission_error(bare, "hsp.mesh")
    with pytest.raises(LtcgearError, match="must be by one of deflection, angles"):
        find_transmission_error(bare, "psh.mesh", "guess")


def test_harmonics_of_whole_cycles_are_those_of_the_signal():
    """A periodic window keeps bins orthogonal: nothing of one harmonic is read at another."""
    phase = 100.0 * TIME
    value = 7.0 + 3.0 * np.sin(TURN * phase) + 0.5 * np.cos(3.0 * TURN * phase)
    assert harmonics_of(value, phase, 4) == pytest.approx((3.0, 0.0, 0.5, 0.0), abs=1e-12)


def triangle(periods):
    """Up and down between 0 and 100, evenly."""
    return 100.0 * np.abs(2.0 * np.mod(periods * TIME, 1.0) - 1.0)


def test_the_loads_of_a_triangle_last_alike():
    """A triangle spends equal times in equal bins: what is exceeded falls evenly."""
    found = find_load_duration(output(triangle(4.0), TIME), output(160.0 * TIME, TIME, "mesh_phase"), bins=10)
    assert found.counted == "tooth meshes"
    assert found.seconds == pytest.approx(0.1, abs=2e-3)
    assert found.count == pytest.approx(16.0, abs=0.2)
    assert found.exceeded == pytest.approx(np.arange(160.0, 0.0, -16.0), abs=0.4)
    assert found.seconds.sum() == pytest.approx(TIME[-1])


def test_revolutions_count_where_they_pass():
    """The shaft turns only while the load is high."""
    load = np.where(TIME < 0.5, 10.0, 90.0)
    angle = TURN * 12.0 * np.maximum(TIME - 0.5, 0.0)
    found = find_load_duration(output(load, TIME), output(angle, TIME, "angle", "sun"), bins=2)
    assert found.counted == "turns"
    assert found.count == pytest.approx([0.0, 6.0], abs=0.01)
    assert found.seconds == pytest.approx([0.5, 0.5], abs=1e-3)


# --- rainflow


ASTM = (-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0)


def history(*peaks):
    """A load that goes straight from peak to peak."""
    at = np.linspace(0.0, TIME[-1], len(peaks))
    return output(np.interp(TIME, at, peaks), TIME)


def test_the_example_of_the_standard():
    """ASTM E1049-85 (2017), Fig. 6: ranges 3, 4, 6, 8, 9 with 0.5, 1.5, 0.5, 1.0, 0.5 cycles."""
    at = (np.arange(9) * (TIME.size - 1)) // 8  # peaks fall on samples
    found = count_cycles(output(np.interp(np.arange(TIME.size), at, ASTM), TIME))
    summed = {round(r, 9): float(found.count[np.isclose(found.span, r)].sum()) for r in found.span}
    assert summed == {3.0: 0.5, 4.0: 1.5, 6.0: 0.5, 8.0: 1.0, 9.0: 0.5}
    assert found.mean[np.isclose(found.span, 9.0)] == pytest.approx([0.5])
    assert (found.total, found.largest) == (4.0, 9.0)
    edges, count = found.by_range(9)
    assert edges == pytest.approx(np.arange(10.0))
    assert list(count) == [0.0, 0.0, 0.0, 0.5, 1.5, 0.0, 0.5, 0.0, 1.5]
    assert found.by_range_and_mean()[2].sum() == pytest.approx(4.0)
    cubes = (0.5 * 3.0**3 + 1.5 * 4.0**3 + 0.5 * 6.0**3 + 8.0**3 + 0.5 * 9.0**3) / 7.0
    assert found.equivalent(3.0, 7.0) == pytest.approx(cubes ** (1 / 3))


def test_a_sine_is_its_own_cycles():
    found = count_cycles(output(50.0 + 20.0 * WAVE, TIME))
    assert found.total == pytest.approx(8.0, abs=0.51)
    assert found.span[found.span > 30.0] == pytest.approx(40.0, rel=1e-3)
    # 7.5 cycles of 40, and what is left at the ends: two half cycles of 20.
    assert found.equivalent(5.0, 8.0) == pytest.approx(((7.5 * 40.0**5 + 20.0**5) / 8.0) ** 0.2, rel=1e-3)


def test_ripple_adds_to_the_equivalent_range():
    """By Miner's rule what is added does damage; two loads are ranked by their damage over one count."""
    plain, other = (count_cycles(output(50.0 + size * WAVE, TIME)) for size in (20.0, 17.0))
    rippled = count_cycles(output(50.0 + 20.0 * WAVE + 2.0 * np.sin(TURN * 500.0 * TIME), TIME))
    assert rippled.total > 10.0 * plain.total
    equivalents = [one.equivalent(6.0, 8.0) for one in (other, plain, rippled)]
    damages = [float((one.count * one.span**6.0).sum()) for one in (other, plain, rippled)]
    assert equivalents == sorted(equivalents)
    assert damages == sorted(damages)
    assert np.array(equivalents) ** 6.0 * 8.0 == pytest.approx(damages)


@pytest.mark.parametrize(("exponent", "reference"), [(6.0, 0.0), (0.0, 8.0), (6.0, float("nan"))])
def test_an_equivalent_range_needs_a_count_and_a_slope(exponent, reference):
    with pytest.raises(LtcgearError, match=r"equivalent range: slope .* both must be above zero"):
        count_cycles(output(WAVE, TIME)).equivalent(exponent, reference)


def test_a_constant_load_has_no_cycles():
    found = count_cycles(output(np.ones_like(TIME), TIME))
    assert (found.total, found.largest, found.equivalent(3.0, 8.0)) == (0.0, 0.0, 0.0)
    assert found.by_range()[1].sum() == 0.0


def test_without_the_library_the_cure_is_told(monkeypatch):
    monkeypatch.setitem(sys.modules, "rainflow", None)
    with pytest.raises(LtcgearError, match=r"pip install 'ltcgear\[report\]'"):
        count_cycles(output(WAVE, TIME))


# --- bearings and orbits


def test_bearing_loads_are_those_of_the_magnitude():
    turning = {"psh.input": 30.0 * np.cos(TURN * 8.0 * TIME)}, {"psh.input": 30.0 * np.sin(TURN * 8.0 * TIME)}
    (found,) = list_bearing_loads(result(TIME, bearing_force_x=turning[0], bearing_force_y=turning[1]))
    assert (found.name, found.kind) == ("psh.input", "bearing")
    assert (found.mean, found.rms, found.peak) == pytest.approx((30.0, 30.0, 30.0))
    assert found.vibration == pytest.approx(0.0, abs=1e-9)
    steady = result(TIME, bearing_force_x={"a": 3.0 + WAVE}, bearing_force_y={"a": 0.0})
    (found,) = list_bearing_loads(steady)
    assert found.rms == pytest.approx(np.sqrt(9.5))
    assert found.vibration == pytest.approx(np.sqrt(0.5))
    assert list_bearing_loads(result(TIME, speed={"a": 1.0})) == ()


def test_the_orbit_of_a_circle():
    x, y = 5e-6 + 2e-6 * np.cos(TURN * 8.0 * TIME), -1e-6 + 2e-6 * np.sin(TURN * 8.0 * TIME)
    dataset = result(TIME, {"s.sun.bearing.clearance": 9e-6}, displacement_x={"s.sun": x}, displacement_y={"s.sun": y})
    found = find_orbit(dataset, "s.sun")
    assert found.centre == pytest.approx((5e-6, -1e-6))
    assert (found.rms, found.largest) == pytest.approx((2e-6, 2e-6))
    assert found.static == pytest.approx((7e-6, -1e-6))
    assert found.clearance == 9e-6
    assert found.floating
    assert found.held == "no bearing"
    later = find_orbit(dataset.isel(time=slice(4000, None)), "s.sun", dataset)
    assert later.static == found.static
    assert find_orbit(dataset.isel(time=slice(4000, None)), "s.sun").static is None
    held = dataset.assign(bearing_force_x=(("time", "bearing"), np.zeros((TIME.size, 1))), bearing=["s.sun"])
    assert find_orbit(held, "s.sun").held == "bearing"
    assert not find_orbit(held, "s.sun").floating
    with pytest.raises(LtcgearError, match=r"s.planet: no member that moves sideways; there are s.sun"):
        find_orbit(dataset, "s.planet")


def test_orbits_are_in_axes_that_turn_with_the_carrier_as_it_is():
    """A planet that stays on its pin does not move, however far the carrier is turned against the rigid motion."""
    twist = 0.2 + 0.05 * WAVE
    place, off = 0.3 + 0.4j, 5e-6 - 2e-6j
    planet = (place + off) * np.exp(1j * twist) - place
    sun = 4e-6 * np.exp(1j * twist)
    paths = {"s.planet.1": planet, "s.sun": sun, "t.output": sun}
    dataset = result(
        TIME, {"s.planet.1.x_0": 0.3, "s.planet.1.y_0": 0.4}, twist={"s.sun": 1.0, "s.carrier": twist},
        displacement_x={name: path.real for name, path in paths.items()},
        displacement_y={name: path.imag for name, path in paths.items()},
    )  # fmt: skip
    assert np.abs(planet).min() > 0.05
    found = find_orbit(dataset, "s.planet.1")
    assert found.centre == pytest.approx((5e-6, -2e-6), abs=1e-15)
    assert found.static == pytest.approx((5e-6, -2e-6), abs=1e-15)
    assert found.largest == pytest.approx(0.0, abs=1e-15)
    assert (found.held, found.floating) == ("pin", False)
    assert find_orbit(dataset, "s.sun").centre == pytest.approx((4e-6, 0.0), abs=1e-15)
    assert find_orbit(dataset, "t.output").x == pytest.approx(sun.real, abs=1e-18)
    later = find_orbit(dataset.isel(time=slice(4000, None)), "s.planet.1", dataset)
    assert later.static == pytest.approx((5e-6, -2e-6), abs=1e-15)


# --- spans


def test_spans_are_cut_to_the_second_half_or_as_asked():
    dataset = make_dataset()
    assert cut(dataset)["time"].values[0] == pytest.approx(2.0, abs=1e-3)
    part = cut(dataset, 0.5, 1.0)["time"].values
    assert (part[0], part[-1]) == (0.5, 1.0)


def test_statistics_along_the_motion_belong_to_the_span_they_were_taken_over():
    end = float(make_dataset()["time"].values[-1])
    dataset = make_dataset().assign(
        statistics=(("statistic", "output"), np.zeros((5, 1)), {"from_s": 2.0, "to_s": end})
    )
    assert "statistics" in cut(dataset)
    assert "statistics" not in cut(dataset, 2.0, 3.0)
    assert "statistics" not in cut(dataset, 1.0)
    assert "statistics" not in cut(dataset, 3.0)
    for told in ({}, {"from_s": "soon", "to_s": end}, {"from_s": 2.0}):
        dataset["statistics"].attrs = told
        assert "statistics" not in cut(dataset)


@pytest.mark.parametrize(
    ("span", "message"),
    [
        ((-1.0, 2.0), "the record runs from 0 s to 3.9"),
        ((1.0, 9.0), "the record runs from"),
        ((2.0, 1.0), "the first before the second"),
        ((float("nan"), 1.0), "the record runs from"),
        ((1.0, 1.001), r"9 samples, 64 at least are needed; give 0\.007813 s or more"),
    ],
)
def test_spans_outside_the_record_are_refused(span, message):
    with pytest.raises(LtcgearError, match=message):
        cut(make_dataset(), *span)


def test_samples_that_are_no_numbers_are_refused_with_where_they_begin():
    dataset = make_dataset()
    broken = dataset.assign(
        mesh_force=dataset["mesh_force"].where((dataset["time"] < 3.0) | (dataset["mesh"] != "psh.mesh"))
    )
    with pytest.raises(LtcgearError, match=r"mesh_force:psh.mesh: not a number from 3 s on; .* --to 2\.9998"):
        cut(broken)
    assert cut(broken, 1.0, 2.99)["time"].values[-1] == pytest.approx(2.99, abs=1e-3)


def test_a_change_of_speed_is_seen():
    assert speed_change(make_dataset()) == pytest.approx(0.0)
    ramp = result(TIME, speed={"a": 10.0 * TIME, "b": 1.0})
    assert speed_change(ramp) == pytest.approx(0.8 / 0.9, rel=1e-2)
    assert speed_change(planets(1.0, 1.0)) == 0.0


def test_every_public_name_is_there():
    from ltcgear.runtime import analysis

    for name in analysis.__all__:
        assert callable(getattr(analysis, name))
    assert select_output is analysis.select_output
    with pytest.raises(AttributeError, match="nothing"):
        _ = analysis.nothing
