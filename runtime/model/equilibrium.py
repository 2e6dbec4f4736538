"""Loaded equilibrium at running speed: start of a simulation and point of linearisation."""

from collections.abc import Mapping

import numpy as np
from ltcgear.generated.contract import CLOSING, PULL
from ltcgear.generated.errors import SolverError
from numpy.typing import NDArray

from .blas import single_threaded
from .continuation import follow
from .dynamic_relaxation import relax
from .function import Kernel
from .library import Library
from .load_tables import Pairs, Signals
from .state_matrix import Equilibrium, dense_jacobian, inertias, mean_levels, pulling, replace_parameter, settled
from .tooth_deflection import Teeth

Vector = NDArray[np.float64]
ROUNDING = 1e-8
"""Deflection [m], [rad] whose force is the scale of unbalanced forces where nothing else acts."""
SETTLED = 1e-14
"""Change [m], [rad] below which an iteration has converged: rounding of lengths of a metre."""
PULLS = (1.0, 1e-3, 1e-6)
"""Tensile stiffness of teeth on the way to the equilibrium, as shares of the full one."""
LOOSE = 4 * np.finfo(float).eps
"""Share of the largest singular value, per degree of freedom, below which a motion has no stiffness but rounding."""
LARGE = 100
"""Degrees of freedom above which sparse elimination is tried first."""
OPEN = 1e-9
"""Unbalance allowed on an unconstrained motion, as a share of the forces acting."""
SLIGHT = 0.1
"""Share of the loads below which an unbalance is reported by size."""


def start_state(library: Library, p: Vector) -> Vector:
    """Return the state of the rigid motion: no deviation, the reference at its speed."""
    names = [state.name for state in library.manifest.states]
    x = np.zeros(len(names))
    if "reference.speed" in names:
        known = [name for name, _ in library.manifest.parameters]
        x[names.index("reference.speed")] = p[known.index("reference.speed")]
    return x


@single_threaded()
def find_equilibrium(
    library: Library, p: Vector, levels: Vector | None = None, tables: Mapping[str, Pairs] | None = None
) -> Equilibrium:
    """Solve for vanishing vibration accelerations with Newton's method on the generated Jacobian.

    Stiffness and errors that vary with the mesh phase are at their means. Loads over time are those just before the
    start: a speed that rises from there on is still constant.

    Parameters
    ----------
    library
        The model.
    p
        Parameters, shape (n_p,).
    levels
        Mesh levels; their means where left out.
    tables
        The model's tables over time, by name.

    Raises
    ------
    SolverError
        If a loaded member is not restrained, the iteration does not converge, or teeth would deflect by more than a
        tooth.
    """
    at, teeth = _seek(library, p, levels, tables), Teeth(library, p)
    if teeth.columns:
        values = Kernel(library.functions["outputs"])(at.x, at.s, settled(library, p))[0]
        wrong = teeth.impossible(teeth.deepest(np.atleast_2d(values)))
        if wrong:
            raise SolverError(f"no equilibrium to begin from: {wrong}")
    return at


def _seek(library: Library, p: Vector, levels: Vector | None, tables: Mapping[str, Pairs] | None) -> Equilibrium:
    """Solve from the state of the rigid motion, by way of closed contacts where there are any."""
    x = start_state(library, p)
    levels = mean_levels(library, x, p) if levels is None else levels
    signals = Signals(library.manifest.signals, tables or {}).before(0.0)
    names = [name for name, _ in library.manifest.parameters]

    def search(x: Vector, pull: float, closing: float = 0.0) -> Vector:
        chosen = replace_parameter(library, pulling(library, p, pull), CLOSING, closing)
        return _newton(library, chosen, x, levels, signals).x

    if CLOSING in names:
        # A bearing within its clearance holds nothing: open the clearance under load.
        x = follow(lambda part, x: search(x, 1.0, part), x)
    if PULL not in names:
        return _newton(library, settled(library, p), x, levels, signals)
    # Nor do teeth that just touch: let them pull until the load has pressed them together, on the other flank
    # too, which lies behind its gap.
    try:
        for share in (*PULLS, 0.0):
            x = search(x, share)
    except SolverError:
        relaxed = _relaxed(library, p, levels, signals)
        if relaxed is None:
            raise
        x = relaxed
    return _newton(library, settled(library, p), x, levels, signals)


def _relaxed(library: Library, p: Vector, levels: Vector, signals: Vector) -> Vector | None:
    """Move members through their clearances until teeth hold them; None if nothing does."""
    position, rate, mass = library.index(""), library.index(".rate"), inertias(library, p)
    rhs, jacobian = Kernel(library.functions["rhs"]), Kernel(library.functions["jac_rhs"])
    s, start, loaded = np.concatenate([levels, signals]), start_state(library, p), settled(library, p)

    def stiffness(x: Vector, p: Vector) -> Vector:
        return -dense_jacobian(library, jacobian(x, s, p, 0.0)[0])[np.ix_(rate, position)] * mass[:, None]

    scale = unit_scale(library, stiffness(start, pulling(library, p)))

    def placed(q: Vector) -> Vector:
        x = start.copy()
        x[position] = scale * q
        return x

    def balance(q: Vector) -> tuple[Vector, Vector]:
        x = placed(q)
        return rhs(x, s, loaded)[0][rate] * mass * scale, stiffness(x, loaded) * np.outer(scale, scale)

    first = float(np.linalg.norm(balance(np.zeros(len(position)))[0]))
    found = relax(balance, np.zeros(len(position)), 1e-9 * first)
    return None if found is None else placed(found)


def _newton(library: Library, p: Vector, x: Vector, levels: Vector, signals: Vector) -> Equilibrium:
    """Iterate from a start until the forces balance to rounding."""
    position, rate, mass = library.index(""), library.index(".rate"), inertias(library, p)
    if not len(position):
        raise SolverError("nothing can vibrate: every freedom of the scene is held; free a member or add one")
    rhs, jacobian = Kernel(library.functions["rhs"]), Kernel(library.functions["jac_rhs"])
    s = np.concatenate([levels, signals])
    load = np.abs(rhs(start_state(library, p), s, p)[0][rate] * mass)
    best = np.inf
    for iteration in range(60):
        force = np.asarray(rhs(x, s, p)[0][rate] * mass)
        stiffness = -dense_jacobian(library, jacobian(x, s, p, 0.0)[0])[np.ix_(rate, position)] * mass[:, None]
        if not (np.isfinite(force).all() and np.isfinite(stiffness).all()):
            raise SolverError(_unreachable(library, x, s, p))
        residual = _residual(library, force, np.abs(stiffness) @ (np.abs(x[position]) + ROUNDING) + load)
        delta = _solve(library, stiffness, force, x[position], load)
        settled = np.abs(delta).max() <= 1e-7 * np.abs(x[position]).max() + SETTLED
        if residual < 1e-13 or (settled and residual < 1e-8 and residual > 0.3 * best):
            return Equilibrium(x, levels, residual, iteration, signals)
        best = min(best, residual)
        x = _advance(library, x, delta, s, p)
    raise SolverError(
        f"no equilibrium: after 60 Newton steps the forces are out of balance by {residual:.1e} of their size; "
        "check loads, stiffnesses and centre distances"
    )


def _residual(library: Library, force: Vector, size: Vector) -> float:
    """Return the largest force or torque out of balance over the size of what is in balance there.

    A degree of freedom without forces is compared with the largest of its kind.
    """
    kinds = _turning(library)
    for kind in (True, False):
        size[kinds == kind] = np.maximum(size[kinds == kind], 1e-3 * size[kinds == kind].max(initial=0.0))
    return float(np.max(np.divide(np.abs(force), size, out=np.zeros_like(force), where=force != 0)))


def _turning(library: Library) -> NDArray[np.bool_]:
    """Return which deviations are angles."""
    return np.array([library.manifest.states[i].turns for i in library.index("")])


def unit_scale(library: Library, stiffness: Vector) -> Vector:
    """Return what brings the stiffness of every freedom to 1, so that stiff and soft, x and u can be compared."""
    diagonal, kinds = np.abs(np.diag(stiffness)), _turning(library)
    for kind in (True, False):
        largest = diagonal[kinds == kind].max(initial=0.0)
        diagonal[kinds == kind] = np.maximum(diagonal[kinds == kind], np.finfo(float).eps * largest)
    return 1.0 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0))


def _solve(library: Library, stiffness: Vector, force: Vector, place: Vector, load: Vector) -> Vector:
    """Solve one Newton step, of least length along motions without stiffness; members driven along these are named.

    A motion may be unconstrained: gears that turn together, a member within its clearance. There the forces must
    balance, but for rounding: that of a length of ``OPEN`` times ``ROUNDING``, and of the springs' own forces.
    """
    scale = unit_scale(library, stiffness)
    if len(force) > LARGE:
        quick = _solve_sparse(stiffness * np.outer(scale, scale), force * scale)
        if quick is not None:
            return np.asarray(scale * quick)
    left, singular, right = np.linalg.svd(stiffness * scale[:, None] * scale[None, :])
    loose = singular <= LOOSE * len(force) * singular[0]
    push = np.abs(left[:, loose].T @ (force * scale))
    if loose.any():
        springs = np.abs(stiffness) @ (OPEN * ROUNDING + 1e-14 * np.abs(place))
        bound = np.abs(left[:, loose].T) @ ((OPEN * load + springs) * scale)
        if (push > bound).any():
            part = push.max() / max(float((np.abs(left[:, loose].T) @ (load * scale)).max()), 1e-300)
            raise SolverError(_unrestrained(library, push @ np.abs(right[loose] * scale), part))
    inverse = np.where(loose, 0.0, 1.0 / np.where(loose, 1.0, singular))
    return np.asarray(scale * (right.T @ (inverse * (left.T @ (force * scale)))))


def _solve_sparse(stiffness: Vector, force: Vector) -> Vector | None:
    """Solve by sparse elimination; None if the smallest singular value, estimated, shows an unconstrained motion.

    The 1-norm of the inverse is estimated by Hager's method, usually exact and within a factor of 3; it bounds the
    largest singular value of the inverse but for the root of the size.
    """
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import LinearOperator, onenormest, splu

    size = len(force)
    try:
        factors = splu(csc_array(stiffness))
    except RuntimeError:  # exactly singular
        return None
    inverse = LinearOperator(
        stiffness.shape, factors.solve, lambda b: factors.solve(b, "T"), factors.solve, dtype=np.float64
    )
    smallest = 1.0 / (3.0 * np.sqrt(size) * onenormest(inverse))
    largest = np.sqrt(np.abs(stiffness).sum(axis=0).max() * np.abs(stiffness).sum(axis=1).max())
    return np.asarray(factors.solve(force)) if smallest > LOOSE * size * largest else None


def _unrestrained(library: Library, shares: Vector, part: float) -> str:
    """Name the members that a load can move without limit, and the unbalanced share of the loads if small."""
    states = [library.manifest.states[i] for i in library.index("")]
    chosen = [f"{s.body} ({s.axis})" for s, share in zip(states, shares, strict=True) if share > 0.3 * shares.max()]
    return (
        f"no equilibrium: nothing holds {', '.join(chosen)} against the loads"
        f"{f', which are out of balance there by {part:.1e} of their size' if part < SLIGHT else ''}; "
        "hold a speed or give an initial_speed in [loads], or give a bearing, a coupling or a torsional_support"
    )


def _advance(library: Library, x: Vector, delta: Vector, s: Vector, p: Vector) -> Vector:
    """Take a Newton step, halved until the gears still reach each other."""
    rhs, position = Kernel(library.functions["rhs"]), library.index("")
    for _ in range(40):
        trial = x.copy()
        trial[position] += delta
        if np.isfinite(rhs(trial, s, p)[0]).all():
            return trial
        delta = delta / 2
    raise SolverError(_unreachable(library, trial, s, p))


def _unreachable(library: Library, x: Vector, s: Vector, p: Vector) -> str:
    """Name the meshes whose gears overlap by their base circles."""
    values = Kernel(library.functions["outputs"])(x, s, p)[0]
    named = [
        report.item
        for value, report in zip(values, library.manifest.reports, strict=True)
        if report.quantity == "pressure_angle" and not np.isfinite(value)
    ]
    return (
        f"no equilibrium: a centre distance falls below the base circles' sum{' at ' if named else ''}"
        f"{', '.join(named)}; check center_distance, the stiffness of bearings, and flank (bilateral teeth pull)"
    )
