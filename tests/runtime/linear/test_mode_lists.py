"""Lists of modes are whole: rigid motions, repeated modes, large trains."""

import numpy as np
import pytest
from ltcgear.generated.errors import SolverError
from ltcgear.runtime.linear import eigen
from ltcgear.runtime.linear.modes import find_modes
from ltcgear.runtime.linear.naming import describe_modes
from ltcgear.runtime.linear.system import linearise
from ltcgear.runtime.model import equilibrium
from ltcgear.runtime.model.building import build
from ltcgear.runtime.model.equilibrium import find_equilibrium
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.scene.load import shipped_scenes

from reference import lin_parker

from ..models import Case, case, make_case, raw_scene


def linear_of(c):
    return linearise(c.point)


def rotors(inertias, couplings):
    """Rotors a, b, ...; couplings as (one, two, stiffness)."""
    return {
        "title": "rotors",
        "rotors": {name: {"inertia": f"{value} kg*m^2"} for name, value in inertias.items()},
        "couplings": {f"{a}{b}": {"between": [a, b], "stiffness": f"{k} N*m/rad"} for a, b, k in couplings},
    }


@pytest.mark.parametrize("name", shipped_scenes())
def test_there_are_as_many_modes_as_freedoms(name):
    linear = linear_of(case(name))
    modes = find_modes(linear)
    assert len(modes) == len(linear.positions)
    assert [mode.group for mode in modes] == sorted(mode.group for mode in modes)
    for mode in modes:
        assert mode.multiplicity == sum(other.group == mode.group for other in modes)


@pytest.mark.parametrize("name", ["rig-2mw", "lin-parker-5", "hard-friction", "hard-tiny-inertia"])
def test_shapes_are_eigenvectors_and_left_vectors_are_their_duals(name):
    linear = linear_of(case(name))
    modes = [mode for mode in find_modes(linear) if mode.kind != "rigid"]
    size, top = linear.scale[linear.kept], np.abs(linear.scaled()).max()
    for mode in modes:
        error = (linear.matrix @ mode.shape - mode.eigenvalue * mode.shape) / size
        assert np.abs(error).max() < 1e-12 * top * np.abs(mode.shape / size).max()
    duals = np.array([mode.left.conj() for mode in modes]) @ np.array([mode.shape for mode in modes]).T
    assert np.abs(duals - np.eye(len(modes))).max() < 1e-7


@pytest.mark.parametrize("factor", [0.4, 3.0])
@pytest.mark.parametrize("n", [3, 4, 5])
def test_radii_change_nothing_where_the_quotients_stay(n, factor):
    """Base radii times a factor, inertias and torsional supports times its square, leave the matrices by hand."""
    raw = raw_scene(f"lin-parker-{n}")
    stage = raw["stages"]["gear"]

    def grow(part, key, power):
        number, unit = part[key]["value"].split()
        part[key] = f"{float(number) * factor**power:.17g} {unit}"

    grow(stage, "center_distance", 1)
    for name in ("sun", "ring", "planet"):
        grow(stage[name], "base_radius", 1)
    for name in ("sun", "ring", "planet", "carrier"):
        grow(stage[name], "inertia", 2)
    grow(stage["ring"]["torsional_support"], "stiffness", 2)
    modes = find_modes(linear_of(make_case(raw)))
    by_hand = lin_parker.frequencies(n)
    assert [mode.frequency_hz for mode in modes][1:] == pytest.approx(by_hand[1:], rel=2e-6)
    assert modes[0].kind == "rigid"


# --- rigid motions


def test_trains_that_do_not_touch_have_rigid_motions_of_their_own():
    raw = rotors(dict.fromkeys("abcde", 2.0), [("a", "b", 700.0), ("c", "d", 900.0)])
    linear = linear_of(make_case(raw))
    modes = find_modes(linear)
    rigid = [mode for mode in modes if mode.kind == "rigid"]
    assert len(modes) == 5
    moving = {tuple(name for name, u in zip("abcde", mode.shape[linear.positions], strict=True) if u) for mode in rigid}
    assert moving == {("a", "b"), ("c", "d"), ("e",)}
    assert {mode.name for mode in describe_modes(linear, rigid)} == {"a, b as one", "c, d as one", "e free"}


def test_braked_trains_that_do_not_touch_keep_rigid_motions_and_decays():
    """Two motions with one zero eigenvalue each, and a decay each."""
    raw = rotors(dict.fromkeys("abcd", 2.0), [("a", "b", 700.0), ("c", "d", 900.0)])
    for name, drag in zip("abcd", (0.4, 0.6, 0.1, 0.2), strict=True):
        raw["rotors"][name]["drag"] = f"{drag} N*m*s/rad"
    modes = find_modes(linear_of(make_case(raw)))
    assert [mode.kind for mode in modes] == ["rigid"] * 2 + ["torsional"] * 4
    assert [mode.eigenvalue.real for mode in modes[2:4]] == pytest.approx([-0.075, -0.25], rel=1e-5)


def test_rotors_that_touch_nothing_are_rigid():
    """No eigenvalue says which frequency is small."""
    modes = find_modes(linear_of(make_case(rotors({"a": 2.0, "b": 3.0}, []))))
    assert [mode.kind for mode in modes] == ["rigid", "rigid"]


def test_a_heavy_rotor_on_a_soft_spring_is_not_rigid():
    """Its frequency is below 1e-6 of the highest, but its spring strains: sqrt(k/J) in closed form."""
    raw = rotors({"heavy": 1e6, "left": 1e-6, "right": 1e-6}, [("left", "right", 1e9)])
    raw["rotors"]["heavy"]["torsional_support"] = {"stiffness": "4e6 N*m/rad"}
    modes = find_modes(linear_of(make_case(raw)))
    assert [mode.kind for mode in modes] == ["rigid", "torsional", "torsional"]
    assert modes[1].frequency_hz * 2 * np.pi == pytest.approx(2.0, rel=1e-6)
    assert modes[1].frequency_hz < 1e-6 * modes[2].frequency_hz


def test_a_matrix_that_is_not_finite_is_refused_by_its_freedoms():
    linear = linear_of(case("lin-parker-3"))
    matrix = linear.matrix.copy()
    row = linear.rates[linear.names.index("gear.sun.x")]
    matrix.data[matrix.indptr[row]] = np.nan
    object.__setattr__(linear, "matrix", matrix)
    with pytest.raises(SolverError, match=r"gear\.sun\.x"):
        find_modes(linear)


# --- large trains


@pytest.fixture(scope="module")
def long(module_patch):
    """A train of 90 members, on CasADi's virtual machine."""
    module_patch.setattr("ltcgear.runtime.model.building.store.compiler", lambda: None)
    from benchmarks.modes import long_train

    scene = long_train(14, 5)
    model = build_model(scene)
    return Case(scene, model, build(obtain(model)))


@pytest.fixture(scope="module")
def module_patch():
    from regenerate import ROOT

    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(ROOT)
        yield patch


def same(one, two):
    assert [mode.frequency_hz for mode in one] == pytest.approx([mode.frequency_hz for mode in two], rel=1e-9)
    assert [mode.damping_ratio for mode in one] == pytest.approx([mode.damping_ratio for mode in two], rel=1e-6)
    assert [mode.kind for mode in one] == [mode.kind for mode in two]


def test_the_lowest_modes_are_those_of_the_dense_method(long, monkeypatch):
    linear = linear_of(long)
    everything = find_modes(linear)
    monkeypatch.setattr(eigen, "_all", None)  # not to be called
    few = find_modes(linear, 20)
    assert len(few) == 20
    same(few, everything[:20])
    for one, two in zip(few, everything, strict=False):
        if two.multiplicity == 1:
            shapes = [mode.shape / mode.shape[np.abs(two.shape).argmax()] for mode in (one, two)]
            assert np.abs(shapes[0] - shapes[1]).max() < 1e-6 * np.abs(shapes[1]).max()
    duals = np.array([mode.left.conj() for mode in few]) @ np.array([mode.shape for mode in few]).T
    assert np.abs(duals - np.eye(20)).max() < 1e-9


def test_a_copy_that_was_overlooked_is_noticed(long, monkeypatch):
    """One of two conjugate pairs of a repeated eigenvalue is lost: the dense method is asked in the end."""
    linear = linear_of(long)
    right = eigen._about
    lost, asked = [], []

    def forgetful(matrix, shift, wanted, *rest):
        values, vectors = right(matrix, shift, wanted, *rest)
        if wanted < 20:
            return values, vectors
        groups = eigen._groups(values)
        again = [k for k in np.argsort(np.abs(values)) if (groups == groups[k]).sum() > 1 and values[k].imag > 0]
        near = [k for k in range(len(values)) if abs(values[k] - values[again[0]].conj()) < 1e-6 * abs(values[k])]
        gone = [again[0], near[0]]
        lost.append(values[gone])
        return np.delete(values, gone), np.delete(vectors, gone, axis=1)

    everything = eigen._all
    monkeypatch.setattr(eigen, "_about", forgetful)
    monkeypatch.setattr(eigen, "_all", lambda *arguments: asked.append(1) or everything(*arguments))
    same(find_modes(linear, 20), find_modes(linear)[:20])
    assert len(lost) == 4  # right and left vectors, two tries
    assert len(asked) == 2  # in place of the tries, and for what is compared


def test_a_free_long_train_keeps_its_rigid_motion(module_patch):
    from benchmarks.modes import long_train

    scene = long_train(10, 4).model_copy(update={"loads": {}})
    model = build_model(scene)
    c = Case(scene, model, build(obtain(model)))
    linear = linear_of(c)
    assert len(linear.kept) > eigen.LARGE
    few = find_modes(linear, 12)
    assert [mode.kind for mode in few].count("rigid") == 1
    same(few, find_modes(linear)[:12])


def test_the_equilibrium_by_sparse_elimination_is_that_of_singular_values(long, monkeypatch):
    sparse = find_equilibrium(long.library, long.p)
    called = []
    right = equilibrium._solve_sparse
    monkeypatch.setattr(equilibrium, "_solve_sparse", lambda *arguments: called.append(1) or right(*arguments))
    monkeypatch.setattr(equilibrium, "LARGE", 10**6)
    dense = find_equilibrium(long.library, long.p)
    assert not called
    position = long.library.index("")
    assert np.abs(sparse.x - dense.x)[position].max() < 1e-9 * np.abs(dense.x[position]).max()


def test_sparse_elimination_leaves_loose_motions_to_singular_values():
    stiffness = np.diag([1.0, 2.0, 3.0])
    assert equilibrium._solve_sparse(stiffness, np.ones(3)) == pytest.approx([1, 1 / 2, 1 / 3])
    for small in (0.0, 1e-16):
        stiffness[2, 2] = small
        assert equilibrium._solve_sparse(stiffness, np.ones(3)) is None


def test_who_is_loose_in_a_long_train_is_named(module_patch):
    from benchmarks.modes import long_train

    scene = long_train(10, 4)
    loads = {"drive": scene.loads["brake"].model_copy(update={"member": "stage1.carrier"})}
    model = build_model(scene.model_copy(update={"loads": loads}))
    library = build(obtain(model))
    assert len(library.index("")) > equilibrium.LARGE
    with pytest.raises(SolverError, match=r"nothing holds .*stage\d+.* against the loads.*torsional_support"):
        find_equilibrium(library, library.parameters(model.values()))
