"""
Your own solver
===============

``Dynamics`` gives the equations of motion as a right-hand side and a Jacobian in NumPy.
Here SciPy and SUNDIALS integrate them, and their mesh forces are set beside those of
``simulate``. What happens where teeth come, go and part is explained in
:doc:`/own-solver`.
"""

# %%
# A right-hand side
# -----------------
# The shipped scene ``lsp`` is the low-speed planetary stage of the 2 MW gearbox, alone.

import matplotlib.pyplot as plt
import numpy as np
from ltcgear.runtime import Dynamics, build, simulate
from ltcgear.symbolic import SceneBuilder, build_model, generate, load_scene
from scipy.integrate import solve_ivp
from sksundae.cvode import CVODE


def opened(scene, t_end, rate):
    """Build a scene; return its equations of motion, and ``simulate``'s instants."""
    model = build_model(scene)
    library, numbers = build(generate(model)), (model.values(), model.tables)
    options = {"t_end": t_end, "rate": rate, "rtol": 1e-8, "raw": True}
    result = simulate(library, numbers[0], tables=numbers[1], **options)
    return Dynamics(library, *numbers), result.dataset


RTOL = 1e-7
dynamics, wanted = opened(load_scene("lsp"), t_end=0.05, rate=8192.0)
x0 = dynamics.x0
print(len(x0), "states:", *dynamics.states[:4], "...")
print("largest rate at rest", np.abs(dynamics.rhs(0.0, x0)).max())
print("entries of the Jacobian", dynamics.jac_sparse(0.0, x0).nnz, "of", x0.size**2)

# %%
# SciPy, from jump to jump
# ------------------------
# ``hold`` keeps the tooth pairs that are in contact and returns when the next one comes
# or goes. A leg up to there is smooth. Outputs are read while it is held: at a switching
# they jump.


def march(dynamics, times, integrate):
    """Return the outputs at some times, and the number of legs."""
    t, x, rows, legs = 0.0, dynamics.x0, [], 0
    while t < times[-1]:
        until = min(dynamics.hold(t, x), times[-1])
        last = until == times[-1]
        inside = times[(t <= times) & (times <= until if last else times < until)]
        t, x, found = integrate(dynamics, t, until, x, inside)
        rows.append(dynamics.outputs(inside[: len(found)], found))
        legs += 1
    dynamics.release()
    return np.concatenate(rows), legs


def scipy_leg(dynamics, t, until, x, inside, **options):
    """Integrate a leg with solve_ivp; an event ends it early."""
    leg = solve_ivp(
        dynamics.rhs,
        (t, until),
        x,
        dense_output=True,
        events=dynamics.events,
        rtol=RTOL,
        atol=RTOL * dynamics.sizes,
        **options,
    )
    assert leg.success, leg.message
    # The time of an event is the next leg's.
    inside = inside[inside < leg.t[-1]] if leg.status == 1 else inside
    return (
        leg.t[-1],
        leg.y[:, -1],
        leg.sol(inside).T if inside.size else np.zeros((0, x.size)),
    )


def explicit(*leg):
    """Integrate with an explicit method of order 8."""
    return scipy_leg(*leg, method="DOP853")


def implicit(dynamics, *leg):
    """Integrate with an implicit method and the generated Jacobian."""
    return scipy_leg(dynamics, *leg, method="Radau", jac=dynamics.jac_sparse)


times = wanted["time"].values
forces = wanted["mesh_force"].values
columns = dynamics.columns("mesh_force")


def compare(name, found, wanted, legs):
    """Print by how much mesh forces are off, over the largest."""
    off = np.abs(found - wanted).max() / np.abs(wanted).max()
    print(f"{name}: {legs} legs, mesh forces off by {off:.1e}")
    assert off < 1e-4


outputs, legs = march(dynamics, times, explicit)
compare("DOP853", outputs[:, columns], forces, legs)
outputs, legs = march(dynamics, times, implicit)
compare("Radau", outputs[:, columns], forces, legs)

# %%
# SUNDIALS
# --------
# scikit-sundae's functions write into arrays that they are given. CVODE may step beyond
# the end of a leg and read the solution there from its polynomial: what is held is smooth
# beyond it too.


def sundae_leg(dynamics, t, until, x, inside):
    """Integrate a leg with CVODE's BDF and the generated Jacobian."""

    def rhs(t, x, rate):
        rate[:] = dynamics.rhs(t, x)

    def jac(t, x, rate, matrix):
        matrix[:] = dynamics.jac(t, x)

    options = {"rtol": RTOL, "atol": RTOL * dynamics.sizes, "max_num_steps": 10_000}
    solver = CVODE(rhs, jacfn=jac, **options)
    grid = np.unique([t, *inside, (t + until) / 2, until])
    leg = solver.solve(grid, x)
    assert leg.success, leg.message
    return until, leg.y[-1], leg.y[np.searchsorted(grid, inside)]


found, legs = march(dynamics, times, sundae_leg)
compare("CVODE", found[:, columns], forces, legs)

# %%
# The picture shows one sun-planet mesh. Where a second tooth pair comes into contact, the
# force jumps.

mesh = dynamics.columns("mesh_force:lsp.sun_planet.1")
figure, axes = plt.subplots(layout="constrained")
axes.plot(times, forces[:, columns.index(mesh[0])] / 1e3, label="simulate")
axes.plot(times, found[:, mesh] / 1e3, linestyle="--", label="CVODE")
axes.set(title="A sun-planet mesh of lsp", xlabel="time [s]", ylabel="mesh force [kN]")
axes.legend()
plt.show()

# %%
# Teeth that part
# ---------------
# With backlash a parallel pair rattles where its torque changes sign. When teeth part and
# meet no kinematics tells: ``events`` ends a leg there, and ``hold`` goes over to the
# other side. The torque is a table over time, read by ``rhs``. At 610 rpm no sample falls
# on a jump: there a force has two values, and two solvers may give one each.

pair = (
    SceneBuilder("A pair that rattles", contact="backlash")
    .pair(
        "pair",
        module="3 mm",
        pressure_angle="20 deg",
        input={"teeth": 30, "support": "rigid", "inertia": "0.004 kg*m^2"},
        output={"teeth": 40, "support": "rigid", "inertia": "0.012 kg*m^2"},
        mesh={
            "stiffness": "2e8 N/m",
            "double_factor": 1.6,
            "damping_ratio": 0.03,
            "backlash": "60 um",
        },
    )
    .load("drive", "pair.input", speed="610 rpm")
    .load(
        "brake",
        "pair.output",
        torque_over_time=[["4 ms", "-100 N*m"], ["5 ms", "60 N*m"], ["8 ms", "-100 N*m"]],
    )
    .build()
)
rattling, wanted = opened(pair, t_end=0.02, rate=20_000.0)
times, forces = wanted["time"].values, wanted["mesh_force"].values
outputs, legs = march(rattling, times, explicit)
columns = rattling.columns("mesh_force")
compare("DOP853", outputs[:, columns], forces, legs)

figure, axes = plt.subplots(layout="constrained")
for column, force in zip(columns, forces.T, strict=True):
    flank = (
        "other flank" if rattling.output_names[column].endswith(".back") else "loaded flank"
    )
    axes.plot(1e3 * times, force / 1e3, label=f"simulate, {flank}")
    axes.plot(1e3 * times, outputs[:, column] / 1e3, "--", label=f"DOP853, {flank}")
axes.set(title="Torque that changes its sign", xlabel="time [ms]", ylabel="mesh force [kN]")
axes.legend()
plt.show()
