"""The stage view's geometry, against statics: arrows push as torques and bearings say, and teeth stand in gaps."""

import json
from base64 import b64decode
from math import cos, sin, tau

import numpy as np
import pytest
from ltcgear.generated.contract import BACK
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.view.report.film import choose_windows, magnify, make_track, pack
from ltcgear.runtime.view.report.page import _motion as move
from ltcgear.runtime.view.report.panels import make_panels, nice
from ltcgear.runtime.view.report.stage import arrow, pose_stage, transform

from reports import load_run

TORQUE = 1.06e4
"""Load on the rig's output shaft [N m], printed in section 4.1 of Wu et al. 2021."""


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    """The rig's result, panels and track."""
    result = load_run(tmp_path_factory.mktemp("rig"), "rig-2mw", 0.4)
    panels = make_panels(result.dataset)
    return result, panels, make_track(result.dataset)


def stage(panels, name):
    return next(panel for panel in panels if panel.name == name)


def wheel(panel, body):
    return next(item for item in panel.wheels if item.body == body)


def moment(panel, contact, body):
    """Moment [m] about a gear of a unit force at the pitch point along the arrow, by the cross product."""
    at = wheel(panel, body)
    return (contact.x - at.x) * sin(contact.direction) - (contact.y - at.y) * cos(contact.direction)


def test_the_arrow_turns_the_output_as_the_load_calls_for(rig):
    """The pinion of the last stage hands the printed load on: the arrow's moment is that torque, as the speed turns."""
    result, panels, track = rig
    panel = stage(panels, "psh")
    force = track.force[:, track.meshes.index("psh.mesh")].mean()
    torque = force * moment(panel, panel.contacts[0], "psh.output")
    speed = float(result.rotor["psh.output"].speed.mean())
    assert abs(torque) == pytest.approx(TORQUE, rel=0.02)
    assert torque * speed > 0  # it drives


def test_arrows_on_a_planet_balance_its_moments(rig):
    """Nothing but the meshes turns a planet, so their mean moments cancel; each alone would be far from that."""
    _, panels, track = rig
    half = len(track.time) // 2
    for name in ("lsp", "hsp"):
        panel = stage(panels, name)
        for planet in [item.body for item in panel.wheels if item.part == "planet"]:
            found = [
                float(track.force[half:, track.meshes.index(c.name)].mean()) * moment(panel, c, planet)
                for c in panel.contacts
                if c.two == planet
            ]
            assert len(found) == 2
            assert abs(sum(found)) < 0.02 * abs(found[0]), planet


def test_arrows_on_a_floating_sun_balance(rig):
    """Teeth alone hold the floating sun of the LSP: the forces on it add up to nothing, and to its torque."""
    _, panels, track = rig
    panel = stage(panels, "lsp")
    mean = {c: float(track.force[:, track.meshes.index(c.name)].mean()) for c in panel.contacts if c.one == "lsp.sun"}
    total = sum(-force * np.exp(1j * contact.direction) for contact, force in mean.items())
    assert abs(total) < 1e-3 * min(mean.values())
    torques = [-force * moment(panel, contact, "lsp.sun") for contact, force in mean.items()]
    assert min(torques) * max(torques) > 0  # all turn it the same way


def test_pins_take_what_meshes_push(rig):
    """In the fixed LSP the pin's mean force is the sum of both arrows on its planet."""
    result, panels, track = rig
    panel = stage(panels, "lsp")
    for k in (1, 2, 3, 4):
        pushed = sum(
            float(track.force[:, track.meshes.index(c.name)].mean()) * np.exp(1j * c.direction)
            for c in panel.contacts
            if c.two == f"lsp.planet.{k}"
        )
        pin = result.pin[f"lsp.pin.{k}"]
        held = float(pin.force_x.mean()) + 1j * float(pin.force_y.mean())
        assert min(abs(held - pushed), abs(held + pushed)) < 0.01 * abs(pushed)


@pytest.mark.parametrize("sample", [0, 1234, -1])
def test_teeth_stand_in_gaps(rig, sample):
    """At any time a tooth of gear 1 near the line of centres points between two teeth of gear 2."""
    _, panels, track = rig
    for panel in panels:
        for contact in panel.contacts:
            one, two = wheel(panel, contact.one), wheel(panel, contact.two)
            sigma = -1 if one.part == "ring" else 1
            gamma = track.angle(panel.frame, sample) + np.arctan2(two.y - one.y, two.x - one.x)
            facing = gamma + (np.pi if sigma > 0 else 0)
            beyond = (gamma - track.angle(one.body, sample) - one.offset) * one.teeth / tau
            arc = (round(beyond) - beyond) * tau / one.teeth * one.radius  # of the tooth, past the line of centres
            places = facing - sigma * arc / two.radius - track.angle(two.body, sample) - two.offset
            assert abs((places * two.teeth / tau) % 1 - 0.5) < 0.05, contact.name


def test_teeth_are_as_many_as_the_paper_prints(rig):
    """Table 2 of Wu et al. 2021."""
    teeth = {item.body: item.teeth for panel in rig[1] for item in panel.wheels if item.teeth}
    assert [teeth[f"lsp.{part}"] for part in ("sun", "planet.3", "ring")] == [22, 48, 118]
    assert [teeth[f"hsp.{part}"] for part in ("sun", "planet.3", "ring")] == [17, 50, 118]
    assert [teeth[f"psh.{part}"] for part in ("input", "output")] == [59, 21]


def test_what_carriers_carry_is_drawn_against_the_carrier(rig):
    """The wound-up train turns the HSP's carrier by degrees; planets are drawn microns off their pins."""
    result, panels, track = rig
    assert float(abs(result.rotor["hsp.carrier"].twist).max()) > 0.05
    assert np.abs(result.dataset["displacement_x"].sel(member="hsp.planet.2")).max() > 0.02
    planets = [k for k, body in enumerate(track.bodies) if body.startswith("hsp.planet")]
    assert np.hypot(track.dx[:, planets], track.dy[:, planets]).max() < 5e-4
    # The rest is what the pin's stiffness makes of its force (Table 6 row 1 of the HSP), within its damping.
    panel = stage(panels, "hsp")
    assert magnify(track, panels) * np.hypot(track.dx, track.dy).max() < 0.1 * panel.reach


def test_the_bearing_of_the_output_takes_what_its_mesh_pushes(rig):
    """Size and line of the bearing's mean force are the arrow's; teeth of outer gears push apart, a ring's pull in."""
    result, panels, track = rig
    panel = stage(panels, "psh")
    contact = panel.contacts[0]
    pushed = track.force[:, track.meshes.index(contact.name)].mean() * np.exp(1j * contact.direction)
    bearing = result.bearing["psh.output"]
    held = float(bearing.force_x.mean()) + 1j * float(bearing.force_y.mean())
    assert min(abs(held - pushed), abs(held + pushed)) < 0.01 * abs(pushed)
    for panel in panels:
        for contact in panel.contacts:
            one, two = wheel(panel, contact.one), wheel(panel, contact.two)
            along = (two.x - one.x) * cos(contact.direction) + (two.y - one.y) * sin(contact.direction)
            assert along * (-1 if one.part == "ring" else 1) > 0, contact.name


def test_other_flanks_push_the_other_way(tmp_path_factory):
    """With backlash the back flank's arrow turns gear 2 against the front one's; only one of them pushes at a time."""
    result = load_run(tmp_path_factory.mktemp("start"), "start-up", 0.2)
    panels = make_panels(result.dataset)
    panel, track = stage(panels, "pair"), make_track(result.dataset)
    front, back = panel.contacts
    assert back.name == front.name + BACK
    assert moment(panel, front, "pair.output") == pytest.approx(-moment(panel, back, "pair.output"), rel=1e-6)
    assert not np.any(track.touching.all(axis=1))
    shown = pose_stage(track, panels, int(np.argmin(track.touching[:, 0])), 1.0)[panels.index(panel)]
    assert shown["contacts"][0]["open"]


def test_torsional_scenes_are_drawn_on_base_circles(tmp_path_factory):
    """Where nothing moves sideways the force is along the tangent of the base circles, which touch."""
    result = load_run(tmp_path_factory.mktemp("bounce"), "hard-bounce", 0.001)
    panels = make_panels(result.dataset)
    track = make_track(result.dataset)
    contact = panels[0].contacts[0]
    assert abs(cos(contact.direction)) < 1e-9
    assert magnify(track, panels) == 1.0
    assert track.bodies == []


def test_frames_carry_forces_to_seven_digits_and_shifts_to_their_step(rig):
    _, _, track = rig
    for window in choose_windows(track):
        packed = pack(track, window)
        forces = np.frombuffer(b64decode(packed["force"]), "<f4").reshape(len(track.meshes), window.count)
        assert np.allclose(forces.T, track.force[window.samples], rtol=1e-7)
        for name, table in (("dx", track.dx), ("dy", track.dy), ("twist", track.twist)):
            steps = np.frombuffer(b64decode(packed[name]["data"]), "<i2").reshape(-1, window.count).T
            read = np.array(packed[name]["middle"]) + np.array(packed[name]["step"]) * steps
            error = np.abs(read - table[window.samples])
            assert (error <= 0.51 * np.array(packed[name]["step"]) + 1e-18).all()
            assert (np.array(packed[name]["step"]) <= np.ptp(table[window.samples], axis=0) / 65000 + 1e-17).all()
        phi = np.frombuffer(b64decode(packed["phi"]), "<f8")
        assert phi == pytest.approx(track.phi[window.samples] - track.phi[window.samples][0])


def test_windows_hold_the_close_up_and_all_the_record(rig):
    _, _, track = rig
    close, whole = choose_windows(track)
    assert close.stride == 1
    assert close.first + close.count == len(track.time)
    assert whole.first == 0
    assert track.time[whole.samples][-1] > track.time[-1] - whole.stride * track.time[1]
    middle = choose_windows(track, 0.2)[0]
    assert track.time[middle.samples].mean() == pytest.approx(0.2, abs=2e-4)
    start = choose_windows(track, 0.0)[0]
    assert (start.first, start.count) == (0, close.count)


def test_poses_are_drawn_with_y_up():
    assert transform(3 + 2j, np.pi / 2) == "translate(3.00 -2.00) rotate(-90.00)"
    assert arrow(20.0).startswith("M0 0H13.00M20.00 0l-7.00")
    assert arrow(-20.0).startswith("M0 0H-13.00M-20.00 0l7.00")
    assert [nice(v) for v in (0.7, 1.0, 4.9, 5.0, 230.0, 0.0, float("nan"))] == [0.5, 1.0, 2.0, 5.0, 200.0, 1.0, 1.0]


def test_a_result_without_its_meshes_is_refused_in_one_sentence(rig):
    """Results of before the sheet told the train: everything but their stage view can still be read."""
    dataset = rig[0].dataset.copy()
    sheet = json.loads(dataset.attrs["sheet"])
    del sheet["meshes"]
    dataset.attrs["sheet"] = json.dumps(sheet)
    with pytest.raises(LtcgearError, match=r"the result's drawing does not fit its data: 'meshes' is missing"):
        move(dataset)
