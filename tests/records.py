"""A record made by hand: two methods, a gap, an error too near the reference."""

from ltcgear.runtime.studies.accuracy.cheapest import list_cheapest

COUNTS = {"steps": 10, "rhs": 60, "jacobian": 0, "rejected": 0, "segments": 1, "events": 2, "regimes": 0}


def point(method, rtol, error, seconds, **changes):
    """A point that ran."""
    return {
        "method": method, "rtol": rtol, "reason": None, "trusted": error > 1e-7, "counts": COUNTS, "seconds": seconds,
        "errors": {"mesh_force": {"value": error, "item": "a.mesh"}, "bearing_force": None, "apart": 0.0},
        "rounds": 7, "integrator": {"min": seconds, "median": 1.1 * seconds},
        "user": {"min": 2 * seconds, "median": 3 * seconds}, "ns_call": 1e9 * seconds / 60,
        "real_time_factor": 0.5 / seconds,
    } | changes  # fmt: skip


def gap(method, rtol, reason):
    """A point that did not run."""
    return {
        "method": method, "rtol": rtol, "reason": reason, "trusted": False, "counts": {}, "seconds": None,
        "errors": {}, "rounds": 0,
    }  # fmt: skip


def make_record(**changes):
    """The record; errors fall with the tolerance, but for one of cvodes."""
    phases = dict.fromkeys(
        ("start", "derive", "check", "emit", "compile", "equilibrium", "integrate", "write", "total"), 0.5
    )
    record = {
        "format": 1, "scene": "made", "title": "Made by hand", "model": "m", "numbers": "n", "preset": "quick",
        "t_end": 0.5, "rate": 8192.0, "measure": "mesh_force", "ns_rhs": 100.0, "auto": "erk",
        "machine": {"processor": "x", "cores": 2, "load": 0.1, "compiler": "cc", "flags": "-O3", "versions": {}},
        "reference": {
            "runs": [{"method": m, "rtol": 1e-13, "seconds": 1.0} for m in ("erk", "rosenbrock")],
            "uncertainty": {"mesh_force": {"value": 1e-10, "item": "a.mesh"}}, "measure": "mesh_force", "floor": 1e-9,
            "reason": None, "failures": [], "exact": None, "reading": 1e-9,
        },
        "points": [
            point("erk", 1e-3, 2e-2, 1.0), point("erk", 1e-5, 5e-4, 2.0), point("erk", 1e-7, 1e-5, 4.0),
            point("erk", 1e-9, 1e-8, 9.0), point("cvodes", 1e-3, 9e-3, 3.0), point("cvodes", 1e-5, 2e-4, 1.5),
            point("cvodes", 1e-7, 1e-4, 3.5), gap("cvodes", 1e-9, "more than 3 s for 0.1 s of 0.5 s"),
        ],
        "notes": ["Least of 7 runs."], "phases": {"cold": phases, "warm": phases, "reason": None},
    } | changes  # fmt: skip
    return record | {"best": list_cheapest(record)}
