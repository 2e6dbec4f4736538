"""Regimes: borders of contact found as events, whatever brings a train to them."""

import numpy as np
import pytest
from ltcgear.generated.contract import HELD
from ltcgear.runtime.model.function import Kernel
from ltcgear.runtime.simulation.energy_balance import energy_residual
from ltcgear.runtime.simulation.methods.registry import METHODS

from ..models import case

RAMP = ("-loads.input.speed", 'loads.input.speed_over_time = [["0 s", "0 rpm"], ["0.02 s", "300 rpm"]]')
GAP = ('effects.contact = "backlash"', 'stages.psh.mesh.backlash = "0.1 mm"')


def torque(end):
    return ("-loads.output.torque", f'loads.output.torque_over_time = [["0 s", "0 N*m"], ["0.02 s", "{end} N*m"]]')


STARTS = {
    "one flank, ramp": (
        'effects.contact = "one-flank"', 'effects.mesh_stiffness = "mean"', *RAMP, 'loads.output.torque = "0 N*m"',
    ),
    "gap, ramp": (*GAP, *RAMP, 'loads.output.torque = "0 N*m"'),
    "gap, torque": (*GAP, *torque(1000)),
    "gap, torque the other way": (*GAP, *torque(-1000)),
}  # fmt: skip


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("start", STARTS)
def test_teeth_that_just_touch_are_set_going(start, method):
    c = case("psh", *STARTS[start])
    path = c.run(method=method, rtol=1e-6, t_end=0.02, rate=5000.0)
    assert path.status == "done"
    assert path.counts.events == path.expected_events
    contact = c.quantity("mesh_contact", path.x, path.s)
    # From the middle of the ramp on a flank has been pressed.
    assert max(values[len(values) // 2 :].max() for values in contact.values()) == 1
    forces = c.mesh_forces(path)
    assert forces.min() > -1e-6 * forces.max()


@pytest.mark.parametrize("method", ["erk", "cvodes", "sundae"])
@pytest.mark.parametrize("seed", range(6))
def test_any_loads_are_followed(seed, method):
    generator = np.random.default_rng(seed)

    def table(key, unit, values):
        times = [0.0, *np.sort(generator.uniform(0, 0.02, 4))]
        rows = ", ".join(
            f'["{t!r} s", "{v!r} {unit}"]' for t, v in zip(map(float, times), map(float, values), strict=True)
        )
        return f"-loads.{key[0]}.{key[1]}", f"loads.{key[0]}.{key[1]}_over_time = [{rows}]"

    settings = (
        'effects.contact = "backlash"',
        *table(("output", "torque"), "N*m", generator.uniform(-300, 300, 5)),
        *table(("input", "speed"), "rpm", generator.uniform(-3000, 3000, 5)),
    )
    c = case("psh", *settings)
    # At 1e-5 cvodes gives up with one such load in sixty, and the processor's last bits decide with which.
    path = c.run(method=method, rtol=1e-6, t_end=0.02, rate=5000.0)
    assert path.status == "done"
    assert path.counts.events == path.expected_events
    assert abs(energy_residual(c.point, path)) < 1e-2


def test_a_hold_keeps_a_side_and_zero_leaves_it_to_the_state():
    c = case("psh", *GAP)
    names = [name for name, _ in c.library.manifest.parameters]
    hold = names.index("hold.psh.mesh")
    report = [(r.quantity, r.item) for r in c.library.manifest.reports].index(("mesh_force", "psh.mesh"))
    outputs = Kernel(c.library.functions["outputs"])

    def force(x, value):
        p = c.p.copy()
        p[hold] = value
        return float(outputs(x, c.at.s, p)[0][report])

    apart = c.at.x.copy()
    apart[c.state("psh.output.u")] *= -1
    assert force(c.at.x, 0.0) == force(c.at.x, HELD) > 0 == force(c.at.x, -HELD)
    assert force(apart, 0.0) == force(apart, -HELD) == 0 > force(apart, HELD)


def test_samples_are_right_where_a_free_train_turns_back_without_switching():
    settings = ('effects.mesh_stiffness = "mean"', "-loads.input.speed", 'loads.input.torque = "0 N*m"',
                'loads.input.initial_speed = "-27 rpm"')  # fmt: skip
    c = case("psh", *settings)
    coarse, fine = (c.run(method="erk", rtol=1e-9, t_end=0.05, rate=rate) for rate in (1000.0, 8000.0))
    speed = c.state("reference.speed")
    assert coarse.x[:, speed].min() * coarse.x[:, speed].max() < 0
    assert np.abs(coarse.x - fine.x[::8]).max(axis=0)[speed] < 1e-7 * np.abs(fine.x[:, speed]).max()
