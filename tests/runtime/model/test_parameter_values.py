"""Values and tables: what no model knows, what is missing and what cannot be is refused, by name, everywhere."""

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.export.solver.dynamics import Dynamics
from ltcgear.runtime.model.equilibrium import find_equilibrium
from ltcgear.runtime.model.load_tables import Signals
from ltcgear.runtime.model.parameter_values import MOST_FAULTS
from ltcgear.runtime.simulation.recording import record
from ltcgear.runtime.simulation.sampling_rate import find_rate
from ltcgear.runtime.simulation.simulate import simulate

from ..models import case

OPTIONS = {"t_end": 0.01, "rate": 4096.0}
LOAD, MASS, SPRING = "loads.output.torque", "psh.input.inertia", "psh.input.bearing.stiffness"
OVER_TIME = "loads.step.torque_over_time"


def entries(c, values, tables, folder):
    """Every way into a run or a linearisation, by name."""
    return {
        "simulate": lambda: simulate(c.library, values, tables=tables, **OPTIONS),
        "record": lambda: record(c.library, values, folder / "run.nc", tables=tables, **OPTIONS),
        "Dynamics": lambda: Dynamics(c.library, values, tables),
        "find_rate": lambda: find_rate(c.library, values, tables, None),
        "linearise": lambda: find_equilibrium(c.library, c.library.parameters(values), tables=tables),
    }


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("psh.input.inertai", 1.0, r'psh\.input\.inertai: .*did you mean "psh\.input\.inertia"\?'),
        (7, 1.0, r"7: the model has no such parameter; leave it out"),
        (LOAD, None, r"loads\.output\.torque = None: must be a finite number \[N\*m\]"),
        (LOAD, np.nan, r"loads\.output\.torque = nan: must be a finite number"),
        (LOAD, -np.inf, "must be a finite number"),
        (LOAD, True, r"loads\.output\.torque = True: must be a finite number"),
        (LOAD, "3 N*m", r"'3 N\*m': must be a finite number"),
        (LOAD, np.ones(2), r"loads\.output\.torque = array.*: must be a finite number"),
        (LOAD, 10**400, r"loads\.output\.torque = 1000.*: must be a finite number"),
        (LOAD, 1j, r"loads\.output\.torque = 1j: must be a finite number"),
        (MASS, -1.0, r"psh\.input\.inertia = -1\.0: must be greater than zero \[kg\*m\^2\]"),
        (MASS, 0.0, r"psh\.input\.inertia = 0\.0: must be greater than zero"),
        (SPRING, -1.0, r"psh\.input\.bearing\.stiffness = -1\.0: must not be negative \[N/m\]"),
        ("psh.mesh.base_radius_1", 0.0, r"base_radius_1 = 0\.0: must be greater than zero \[m\]"),
        ("psh.mesh.single_share", 1.0, r"single_share = 1\.0: must lie between 0 and 1"),
    ],
)  # fmt: skip
def test_numbers_that_cannot_be_are_refused_by_name(tmp_path, name, value, message):
    c = case("psh")
    for way, enter in entries(c, c.model.values() | {name: value}, None, tmp_path).items():
        with pytest.raises(LtcgearError, match=message):
            pytest.fail(f"{way}: {enter()}")
    assert not list(tmp_path.iterdir())


def test_what_is_missing_is_named_and_all_faults_are_told_at_once():
    c = case("psh")
    values = c.model.values()
    with pytest.raises(LtcgearError, match=r"torque is missing; begin with the model's values \(model\.values\(\)\)"):
        c.library.parameters({k: v for k, v in values.items() if k != LOAD})
    with pytest.raises(LtcgearError, match=rf"and {len(values) - MOST_FAULTS} more$"):
        c.library.parameters({})
    with pytest.raises(LtcgearError, match=r"values: NoneType, must be names with numbers"):
        c.library.parameters(None)


def test_what_a_study_may_ask_for_is_taken():
    """No spring at all, dampers that drive, numbers of NumPy: unusual, but they mean something."""
    c = case("psh")
    values = c.model.values() | {SPRING: 0, "psh.mesh.damping": -1.0, LOAD: np.float32(3.0), MASS: np.int64(2)}
    found = dict(zip((name for name, _ in c.library.manifest.parameters), c.library.parameters(values), strict=True))
    assert [found[name] for name in (SPRING, "psh.mesh.damping", LOAD, MASS)] == [0.0, -1.0, 3.0, 2.0]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"loads.step.torqe_over_time": [(0, 0)]}, r'torqe_over_time: the model has no such table; did you mean'),
        ({OVER_TIME: None}, r"tables: loads\.step\.torque_over_time is missing; begin with .* \(model\.tables\)"),
        ({OVER_TIME: []}, r"torque_over_time: shape \(0,\), must be rows of time \[s\] and value"),
        ({OVER_TIME: 3.0}, r"shape \(\), must be rows"),
        ({OVER_TIME: [(0, 1, 2)]}, r"shape \(1, 3\), must be rows"),
        ({OVER_TIME: [(0, 1), (1,)]}, r"loads\.step\.torque_over_time: .*must be rows"),
        ({OVER_TIME: [(0, 1), (1, np.nan)]}, r"row 2: \(1, nan\) must be finite"),
        ({OVER_TIME: [(0, 1), (2, 1), (1, 1)]}, r"row 3: times must ascend, but 1 follows 2; sort the rows"),
        ({OVER_TIME: [(0, 1), (0, 2)]}, r"row 2: times must ascend, but 0 follows 0"),
        ({OVER_TIME: [("0", "1")]}, r"loads\.step\.torque_over_time: .*real numbers"),
        ({OVER_TIME: [(True, False)]}, "real numbers"),
        ({OVER_TIME: [(0.0, 1e300), (1e-300, -1e300)]}, r"row 2: the value changes by inf a second"),
    ],
)  # fmt: skip
def test_tables_that_cannot_be_are_refused_by_name_and_row(tmp_path, change, message):
    c = case("start-up")
    tables = {k: v for k, v in (dict(c.model.tables) | change).items() if v is not None}
    for way, enter in entries(c, c.model.values(), tables, tmp_path).items():
        with pytest.raises(LtcgearError, match=message):
            pytest.fail(f"{way}: {enter()}")
    assert not list(tmp_path.iterdir())


def test_a_model_without_tables_says_so_and_one_row_is_a_constant():
    with pytest.raises(LtcgearError, match=r"tables: speed: the model has no such table; leave it out"):
        Signals((), {"speed": [(0.0, 1.0)]})
    signals = case("start-up").library.manifest.signals
    one = Signals(signals, {signal.table: [(1.0, 5.0)] for signal in signals})
    assert set(one.at(0.0)) == {0.0, 5.0}  # slopes and values
