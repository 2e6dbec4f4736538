"""Profile oracle: what a mesh's stiffness and error are over the mesh phase, written by hand.

The phase tau counts tooth pitches; single contact begins where tau is whole and lasts for ``share`` of a pitch.
Every function returns a value and its slope over tau. Nothing here is shared with what it tests.
"""

from math import comb

import numpy as np

PI = 4 * np.arctan(np.longdouble(1))


def step(z):
    """Step from 0 to 1 of degree 13, level with six derivatives at both ends, in Bernstein's form; its slope."""
    if z <= 0 or z >= 1:
        return float(z >= 1), 0.0
    return sum(comb(13, k) * z**k * (1 - z) ** (13 - k) for k in range(7, 14)), 12012 * z**6 * (1 - z) ** 6


def wrapped(y, period=1):
    """``y`` shifted by whole periods to half a period about zero."""
    return y - period * np.round(y / period)


def smooth_levels(tau, k1, k2, share, width):
    """k1 about the middle of single contact, k2 elsewhere, with steps of ``width`` pitches between."""
    y = wrapped(tau - np.longdouble(share) / 2)
    up, slope = step((abs(y) - np.longdouble(share) / 2) / width + 0.5)
    return k1 + (k2 - k1) * up, (k2 - k1) * slope / width * np.sign(y)


def wave(tau, mean, cosines, sines):
    """A Fourier series of period one."""
    turns = [2 * PI * n for n in range(1, len(cosines) + 1)]
    terms = list(zip(turns, cosines, sines, strict=True))
    value = mean + sum(a * np.cos(w * tau) + b * np.sin(w * tau) for w, a, b in terms)
    return value, sum((w * (b * np.cos(w * tau) - a * np.sin(w * tau)) for w, a, b in terms), np.longdouble(0))


def square_terms(k1, k2, share, count):
    """Mean, cosine and sine terms of k1 while frac(tau) < share, else k2: integrals of each level over its part."""
    single, double = [(0.0, k1), (share, k1)], [(share, k2), (1.0, k2)]
    return _terms([single, double], count)


def polygon_terms(pairs, count):
    """Mean, cosine and sine terms of the polygon through ``pairs``, closed by its first point a pitch later."""
    points = [*pairs, (pairs[0][0] + 1.0, pairs[0][1])]
    return _terms([points[i : i + 2] for i in range(len(points) - 1)], count)


def _terms(pieces, count):
    """Fourier integrals of straight pieces ((x, y), (x, y)), each by parts."""
    mean, cosines, sines = 0.0, np.zeros(count), np.zeros(count)
    for (x0, y0), (x1, y1) in pieces:
        if x1 == x0:
            continue
        mean, rise = mean + (x1 - x0) * (y0 + y1) / 2, (y1 - y0) / (x1 - x0)
        for i in range(count):
            w = 2 * np.pi * (i + 1)
            for x, y, sign in ((x1, y1, 2), (x0, y0, -2)):
                cosines[i] += sign * (y * np.sin(w * x) / w + rise * np.cos(w * x) / w**2)
                sines[i] += sign * (-y * np.cos(w * x) / w + rise * np.sin(w * x) / w**2)
    return mean, cosines, sines


def tooth_window(tau, tooth, teeth, share):
    """Share of the load on one tooth, 1 while it carries alone; it comes and goes over double contact."""
    y = wrapped(tau - tooth, teeth)
    come, coming = step(y / (1 - share) + 1)
    go, going = step((y - share) / (1 - share))
    return come - go, (coming - going) / (1 - share)
