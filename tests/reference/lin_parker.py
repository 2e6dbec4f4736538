"""Published planetary-gear frequencies, with the published models rebuilt by hand.

J. Lin, R. G. Parker, "Analytical characterization of the unique properties of planetary gear free
vibration", ASME J. Vib. Acoust. 121(3), 316-321, 1999: planets equally spaced, carrier at rest.
A. Kahraman, "Natural modes of planetary gear trains", J. Sound Vib. 173(1), 125-130, 1994: torsional.
"""

import numpy as np

MASS = {"carrier": 5.43, "ring": 2.35, "sun": 0.40, "planet": 0.66}
"""Masses [kg]."""

INERTIA = {"carrier": 6.29, "ring": 3.00, "sun": 0.39, "planet": 0.61}
"""I/r^2 [kg]. The radii printed beside them form no mesh; only these quotients enter the matrices."""

K_MESH = {"sun": 5.0e8, "ring": 5.0e8}
"""Mesh stiffnesses k_sp, k_rp [N/m]."""

K_PIN = 1.0e8
"""Planet bearing stiffness k_p [N/m]."""

K_LATERAL = {"carrier": 1.0e8, "ring": 1.0e8, "sun": 1.0e8}
"""Bearing stiffnesses k_c, k_r, k_s [N/m]."""

K_TORSION = {"carrier": 0.0, "ring": 1.0e9, "sun": 0.0}
"""Torsional supports over r^2, k_cu, k_ru, k_su [N/m]."""

ALPHA = np.deg2rad(24.6)
"""Pressure angle [rad] of both meshes."""

PRINTED_SINGLE = {
    3: (0.0, 1475.7, 1930.3, 2658.3, 7462.8, 11775.3),
    4: (0.0, 1536.6, 1970.6, 2625.7, 7773.6, 13071.1),
    5: (0.0, 1567.4, 2006.1, 2614.8, 8065.4, 14253.1),
}
"""Rotational modes [Hz], each once, by the number of planets."""

PRINTED_DOUBLE = {
    3: (743.2, 1102.4, 1896.0, 2276.4, 6986.3, 9647.9),
    4: (727.0, 1091.0, 1892.8, 2342.5, 7189.9, 10437.6),
    5: (710.0, 1072.0, 1888.1, 2425.3, 7382.4, 11172.3),
}
"""Translational modes [Hz], each twice."""

PRINTED_PLANET = (1808.2, 5963.8, 6981.7)
"""Planet modes [Hz], each N - 3 times."""

CENTRAL = ("carrier", "ring", "sun")


def printed(n):
    """All 3 (3 + n) printed frequencies [Hz], sorted, with their multiplicities."""
    return np.sort([*PRINTED_SINGLE[n], *2 * PRINTED_DOUBLE[n], *(n - 3) * PRINTED_PLANET])


def _add(K, k, places, factors):
    """Add a spring k [N/m] whose elongation is the sum of factors times the coordinates at places."""
    row = np.zeros(len(K))
    row[list(places)] = factors
    K += k * np.outer(row, row)


def _add_supports(K):
    """Bearings and torsional supports of the three central members."""
    for i, body in enumerate(CENTRAL):
        at = 3 * i
        K[at, at] += K_LATERAL[body]
        K[at + 1, at + 1] += K_LATERAL[body]
        K[at + 2, at + 2] += K_TORSION[body]


def _add_planet(K, psi, at):
    """Pin, sun mesh and ring mesh of the planet at angle psi [rad], coordinates zeta, eta, u from ``at``."""
    zeta, eta, u = at, at + 1, at + 2
    cosine, sine = np.cos(psi), np.sin(psi)
    _add(K, K_PIN, (0, 1, zeta), (cosine, sine, -1.0))
    _add(K, K_PIN, (0, 1, 2, eta), (-sine, cosine, 1.0, -1.0))
    psi_r, psi_s = psi + ALPHA, psi - ALPHA
    ring = (-np.sin(psi_r), np.cos(psi_r), 1.0, np.sin(ALPHA), -np.cos(ALPHA), -1.0)
    sun = (-np.sin(psi_s), np.cos(psi_s), 1.0, -np.sin(ALPHA), -np.cos(ALPHA), 1.0)
    _add(K, K_MESH["ring"], (3, 4, 5, zeta, eta, u), ring)
    _add(K, K_MESH["sun"], (6, 7, 8, zeta, eta, u), sun)


def matrices(n):
    """Mass [kg] and stiffness [N/m] matrices, 3 (3 + n) square, of the gear at rest with n planets.

    Coordinates: x, y, u of carrier, ring, sun; then zeta (radial), eta (tangential), u of each planet;
    u = r theta, counter-clockwise, r the base radius (for the carrier the planets' circle).
    """
    bodies = [*CENTRAL, *n * ["planet"]]
    M = np.diag(np.ravel([(MASS[b], MASS[b], INERTIA[b]) for b in bodies]))
    K = np.zeros_like(M)
    _add_supports(K)
    for i in range(n):
        _add_planet(K, 2.0 * np.pi * i / n, 9 + 3 * i)
    return M, K


def frequencies(n):
    """Natural frequencies [Hz], sorted, of K q = (2 pi f)^2 M q."""
    M, K = matrices(n)
    scale = 1.0 / np.sqrt(np.diag(M))
    values = np.linalg.eigvalsh(scale[:, None] * K * scale)
    return np.sqrt(np.maximum(values, 0.0)) / (2.0 * np.pi)


def kahraman(n, k1, k2, m_p, m_c, m_s):
    """Torsional natural frequencies [rad/s], sorted, ring fixed: n + 2 of them, the rigid body's 0 included.

    k1 and k2 [N/m] are the ring and the sun mesh; m = I/r^2 [kg] of planet, carrier and sun. r is the
    base radius, for the carrier the planets' circle times cos alpha; m_c contains the planets' own masses.
    """
    equal = np.sqrt((k1 + k2) / m_p)
    square = m_p * m_c * m_s
    linear = n * k2 * m_p * m_c + (k1 + k2) * m_c * m_s + n * (k1 + k2) * m_p * m_s
    constant = n * k1 * k2 * (n * m_p + m_c + 4.0 * m_s)
    pair = np.sqrt(np.roots([square, -linear, constant]).real)
    return np.sort([0.0, *pair, *(n - 1) * [equal]])
