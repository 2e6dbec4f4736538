"""Newton's and Euler's laws of a whole scene by hand, in inertial coordinates: forces to accelerations."""

import numpy as np

from .hand_gearing import L, on_disc
from .hand_model import turned


def newton(model, motions, forces):
    """Accelerations (body, axis), and the torques that hold angles.

    Every body has its own mass, inertia and forces; what carries others along takes over their inertia
    forces and loads by virtual power, sum over bodies of (F - m A) V* + (T - I w') w* = 0.
    """
    free = [(n, axis) for n in model.members if model.lateral(n) for axis in "xy"]
    turning = [(n, "u") for n in model.members if model.leader[n] == n]
    row = {key: i for i, key in enumerate(free + turning)}
    M, Q = np.zeros((len(row), len(row))), np.zeros(len(row), L)
    for name, member in model.members.items():
        mass, inertia = on_disc(member)
        force = forces.get(name, np.zeros(3, L))
        u = row[model.leader[name], "u"]
        M[u, u] += inertia or 0.0
        Q[u] += force[2]
        J, bound = _velocities(model, name, motions, row)
        if J is not None:
            M += mass * (J.T @ J).astype(float)
            Q += J.T @ (force[:2] - mass * bound)
    moving = [i for (name, axis), i in row.items() if axis != "u" or name not in model.held]
    result = np.zeros(len(row), L)
    result[moving] = np.linalg.solve(M[np.ix_(moving, moving)], Q[moving].astype(float))
    holding = M @ result - Q
    return (
        {key: result[i] for key, i in row.items() if i in moving},
        {name: holding[i] for (name, axis), i in row.items() if axis == "u" and name in model.held},
    )


def _velocities(model, name, motions, row):
    """dV/d(rates) of a centre that moves, shape (2, rows), and its acceleration at constant rates."""
    J, bound = np.zeros((2, len(row)), L), np.zeros(2, L)
    mover = model.frame[name] if model.seated(name) else name
    if model.lateral(mover):
        J[0, row[mover, "x"]] = J[1, row[mover, "y"]] = 1.0
    elif not model.seated(name):
        return None, bound
    if model.seated(name):
        arm = motions[name].O - motions[mover].O
        J[:, row[model.leader[mover], "u"]] += turned(arm)
        bound = -(motions[mover].w ** 2) * arm
    return J, bound


def kinetic(model, motions):
    """Kinetic energy [J]."""
    total = 0.0
    for name, member in model.members.items():
        mass, inertia = on_disc(member)
        if model.lateral(name) or model.seated(name):
            total += mass * (motions[name].V @ motions[name].V) / 2
        if not model.fixed(member):
            total += inertia * motions[name].w ** 2 / 2
    return total
