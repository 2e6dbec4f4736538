"""Force oracle: the elements' forces written by hand, from the paper's notes and plane mechanics alone.

Inertial coordinates, angles and speeds positive counter-clockwise. A body has position ``O`` = (x, y) [m],
angle ``th`` [rad], velocity ``V`` [m/s] and speed ``w`` [rad/s]. In a mesh, body 1 is the central gear
(sun or ring, or gear 1 of a parallel pair), body 2 the planet (or gear 2); sigma = +1 is external and
-1 internal; the flank ``s`` is +1 as printed by Wu et al. 2021 (Appl. Sci. 11:6876), -1 mirrored.
Nothing here is shared with the derivation that it tests.
"""

import numpy as np

SIGMA = {"external": 1.0, "internal": -1.0}


def cross(a, b):
    """z-component of the cross product of two plane vectors."""
    return a[0] * b[1] - a[1] * b[0]


def point_velocity(V, w, arm):
    """Velocity [m/s] of a body's material point at ``arm`` [m] from its centre: V + w z x arm."""
    return np.asarray(V, float) + w * np.array([-arm[1], arm[0]])


def involute(a):
    """Involute function inv a = tan a - a."""
    return np.tan(a) - a


def line_of_centres(kind, r1, r2, O1, O2):
    """Distance d [m], unit vectors e (from 1 to 2) and t (e turned +90 deg), operating pressure angle a.

    cos a = (r1 + r2)/d external (below eq 5), (r1 - r2)/d internal (below eq 21); r are base radii [m].
    """
    gap = np.subtract(O2, O1) * 1.0
    d = np.hypot(*gap)
    e = gap / d
    return d, e, np.array([-e[1], e[0]]), np.arccos((r1 + SIGMA[kind] * r2) / d)


def direction_change(O1, O2, gamma0, turn):
    """Unwrapped Dg = gamma - gamma0 [rad] (eqs 2 and 17), on the branch nearest to ``turn``."""
    wrapped = np.arctan2(O2[1] - O1[1], O2[0] - O1[0])
    branch = np.round((gamma0 + turn - wrapped) / (2.0 * np.pi))
    return wrapped + 2.0 * np.pi * branch - gamma0


def involute_deflection(kind, s, r1, r2, d0, a, Dg, th1, th2):
    """Interference [m] of two involute flanks along the line of action, exact for any centre distance.

    External: s [r1 (th1 - Dg) + r2 (th2 - Dg)] - (r1 + r2)(inv a - inv a0);
    internal: s [r1 (th1 - Dg) - r2 (th2 - Dg)] + (r1 - r2)(inv a - inv a0).
    """
    turned = r1 * (th1 - Dg)
    if kind == "external":
        a0 = np.arccos((r1 + r2) / d0)
        return s * (turned + r2 * (th2 - Dg)) - (r1 + r2) * (involute(a) - involute(a0))
    a0 = np.arccos((r1 - r2) / d0)
    return s * (turned - r2 * (th2 - Dg)) + (r1 - r2) * (involute(a) - involute(a0))


def paper_deflection(kind, s, r1, r2, d, d0, a, Dg, th1, th2):
    """Deflection [m] of eqs 5-7 (external) and 20-23 (internal), with the mirrored flank by ``s``.

    The running pitch radius times cos a, which eqs 5 and 21 print, is the base radius r2.
    """
    if kind == "external":
        slip = th2 - Dg + r1 / r2 * (th1 - Dg)
        return s * r2 * np.tan(slip) - (d - d0) * np.sin(a)
    slip = th2 - Dg - r1 / r2 * (th1 - Dg)
    return -s * r2 * np.tan(slip) + (d - d0) * np.sin(a)


def force_direction(kind, s, e, t, a):
    """Unit vector of the normal force on body 2: eqs 13 and 26 for s = +1."""
    return SIGMA[kind] * np.sin(a) * e + s * np.cos(a) * t


def approach_rate(kind, s, r1, r2, n, V1, w1, V2, w2):
    """Rate [m/s] at which the bodies approach along the line of action, unit force direction ``n``.

    The line touches both base circles; the arms are those contact points seen from the centres. It
    passes body 1 on the side where n has moment s r1, body 2 where it has -s r2 (external), s r2 (internal).
    """
    foot = s * np.array([n[1], -n[0]])
    v1 = point_velocity(V1, w1, r1 * foot)
    v2 = point_velocity(V2, w2, -SIGMA[kind] * r2 * foot)
    return -np.dot(v2 - v1, n)


def mesh(
    kind, law, s, r1, r2, d0, gamma0, turn, k, c, O1, th1, V1, w1, O2, th2, V2, w2,
    *, error=(0.0, 0.0), gap=0.0, pushes_only=False, slope=0.0,
):  # fmt: skip
    """Normal force of a gear pair: N = k deflection + c approach rate (eqs 12 and 25), less an error.

    Parameters
    ----------
    kind, law : 'external' | 'internal', 'involute' | 'paper'.
    s : flank, +1 or -1.
    r1, r2, d0 : base radii and starting centre distance [m].
    gamma0, turn : starting direction angle from O1 to O2, and about how far it has turned since [rad].
    k, c : stiffness [N/m] and damping [N s/m].
    error : what the flanks lack along the line of action [m], and its rate [m/s].
    gap : distance before this flank touches [m].
    pushes_only : the flanks part, and the damper never pulls.
    slope : dk/d th1 [N/(m rad)] where the stiffness follows the angle from the line of centres to body 1.

    Returns
    -------
    dict
        ``force`` [N], ``deflection`` [m], ``F1``, ``F2`` [N] on the centres, ``T1``, ``T2`` [N m].
    """
    d, e, t, a = line_of_centres(kind, r1, r2, O1, O2)
    Dg = direction_change(O1, O2, gamma0, turn)
    if law == "involute":
        delta = involute_deflection(kind, s, r1, r2, d0, a, Dg, th1, th2)
    elif law == "paper":
        delta = paper_deflection(kind, s, r1, r2, d, d0, a, Dg, th1, th2)
    else:
        raise ValueError(f"law {law!r}: choose 'involute' or 'paper'")
    n = force_direction(kind, s, e, t, a)
    delta = delta - error[0] - gap
    damper = c * (approach_rate(kind, s, r1, r2, n, V1, w1, V2, w2) - error[1])
    N = k * delta + damper if not pushes_only else contact_force(k, delta, damper)
    T1, T2 = -s * r1 * N, -SIGMA[kind] * s * r2 * N
    # V = k delta^2 / 2 with k of th1 - Dg: the stored energy turns body 1 back and the line of centres on.
    G = slope * (max(delta, 0.0) if pushes_only else delta) ** 2 / 2.0
    F2 = N * n + G / d * t
    return {"force": N, "deflection": delta, "F1": -F2, "F2": F2, "T1": T1 - G, "T2": T2}


def contact_force(k, delta, damper):
    """Force [N] of flanks that push and never pull: spring k delta and a damper, while delta > 0."""
    return k * delta + max(damper, -k * delta) if delta > 0.0 else 0.0


def offset_point(O, th, V, w, radius, angle):  # noqa: E741 - O is the centre, as in the other elements
    """Position, velocity and arm of the point of a body at ``radius`` [m] and ``angle`` [rad] from its axis."""
    arm = radius * np.array([np.cos(th + angle), np.sin(th + angle)])
    return O + arm, point_velocity(V, w, arm), arm


def pitch_point_friction(kind, s, r1, r2, N, mu, c_t, v0, O1, V1, w1, O2, V2, w2):
    """Tooth friction at the pitch point, eqs 14 and 27 made dissipative, direction eqs 15 and 28.

    Force on body 2 along m, F = -(mu |N| tanh(v_t/v0) + c_t v_t) [N]; v_t [m/s] is body 2's velocity at
    the pitch point less body 1's, along m; N [N], c_t [N s/m], v0 [m/s]. Torques [N m] by the lever arms.
    """
    _, e, t, a = line_of_centres(kind, r1, r2, O1, O2)
    arm1 = r1 / np.cos(a) * e
    arm2 = np.asarray(O1, float) + arm1 - np.asarray(O2, float)
    m = np.cos(a) * e - SIGMA[kind] * s * np.sin(a) * t
    v_t = np.dot(point_velocity(V2, w2, arm2) - point_velocity(V1, w1, arm1), m)
    F2 = -(mu * abs(N) * np.tanh(v_t / v0) + c_t * v_t) * m
    return {"F1": -F2, "F2": F2, "T1": cross(arm1, -F2), "T2": cross(arm2, F2), "v_t": v_t}


def pin(k, c, rho0, C, thC, VC, wC, P, VP):
    """Planet bearing on a carrier, eqs 29-30 (the second cosine of eq 29 read as a sine), with a damper.

    ``rho0`` [m] leads from the carrier's centre to the pin at thC = 0. The spring [N/m] acts on
    P - C - Rot(thC) rho0; the damper [N s/m] on P's velocity less that of the carrier's point now at P.
    Both act at P: ``FP`` [N] on the planet, ``FC`` [N] and ``TC`` [N m] on the carrier at its centre.
    """
    cosine, sine = np.cos(thC), np.sin(thC)
    seat = np.array([cosine * rho0[0] - sine * rho0[1], sine * rho0[0] + cosine * rho0[1]])
    arm = np.subtract(P, C).astype(float)
    FP = -k * (arm - seat) - c * (np.asarray(VP, float) - point_velocity(VC, wC, arm))
    return {"FP": FP, "FC": -FP, "TC": cross(arm, -FP)}


def pin_friction(mu, d_b, c, w0, F, wC, wP):
    """Friction torques (TP, TC) [N m] in a planet bearing: the last line of eq 30 made dissipative.

    TP = -(mu F d_b/2 tanh(w_rel/w0) + c w_rel), w_rel = wP - wC; F [N] is the magnitude of the pin's
    spring force, d_b [m] the bearing's diameter, c [N m s/rad].
    """
    w_rel = wP - wC
    TP = -(mu * F * d_b / 2.0 * np.tanh(w_rel / w0) + c * w_rel)
    return TP, -TP


def ground_bearing(k, c, O, V):  # noqa: E741 - O is the centre, as in the other elements
    """Force [N] on a shaft's centre from its bearing on ground: -k O - c V (eq 31; damper added)."""
    return -k * np.asarray(O, float) - c * np.asarray(V, float)


def coupling(k, c, th1, w1, th2, w2):
    """Torques (T1, T2) [N m] of a torsional spring [N m/rad] and damper [N m s/rad] between two bodies."""
    T1 = k * (th2 - th1) + c * (w2 - w1)
    return T1, -T1


def support(k, c, th, w):
    """Torque [N m] of a torsional spring and damper from a body to ground."""
    return -k * th - c * w
