"""What `rig-2mw` took when it was last looked at: counts and errors of both methods that are compiled whole.

``python -m tests.reference.gate`` writes them anew, after a change that is meant to change them.
"""

import json
from pathlib import Path

from ltcgear.runtime.cli.testing import open_bench
from ltcgear.runtime.studies.accuracy.patience import Patience
from ltcgear.runtime.studies.accuracy.reference import find_reference
from ltcgear.runtime.studies.accuracy.run_errors import value_of
from ltcgear.runtime.studies.accuracy.sweep import Sweep

FILE = Path(__file__).with_name("gate.json")
SCENE, T_END, RATE = "rig-2mw", 0.01, 8192.0
METHODS, RTOLS = ("erk", "rosenbrock"), (1e-4, 1e-7)
COUNTS = ("steps", "rhs", "jacobian", "segments", "events")


def measure():
    """Counts and mesh-force errors of all points, as the file has them."""
    bench = open_bench(SCENE, {})
    reference = find_reference(bench, Patience(60.0), t_end=T_END, rate=RATE)
    sweep = Sweep(METHODS, RTOLS, T_END, RATE, Patience(60.0), budget=0.0)
    return {
        f"{point.method} {point.rtol:g}": {name: point.counts[name] for name in COUNTS}
        | {"error": float(f"{value_of(point.errors, 'mesh_force'):.3g}")}
        for point in sweep.measure(bench, reference)
    }


if __name__ == "__main__":
    lines = [f"  {json.dumps(name)}: {json.dumps(point)}" for name, point in measure().items()]
    FILE.write_text("{\n" + ",\n".join(lines) + "\n}\n", "utf-8")
    print(f"wrote {FILE}")
