"""The same stage by ltcgear, from an empty store: run as ``python -m benchmarks.peers.our_stage``, it prints JSON.

The caller sets LTCGEAR_CACHE to a new folder. Times include the proof that energies and forces agree, the Jacobian,
the outputs and the energies, none of which PyDy makes.
"""

import json
from time import perf_counter

from ltcgear.generated import store
from ltcgear.runtime.model.building import build
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import content_key, generate
from ltcgear.symbolic.scene.load import load_scene

from .stage import SCENE, SETTINGS


def main() -> None:
    """Derive, check, emit, compile, print."""
    clock = perf_counter()
    model = build_model(load_scene(SCENE, SETTINGS))
    found = {"scene": perf_counter() - clock}
    artifact = generate(model, lambda stage, seconds: found.update({stage: seconds}))
    store.put(content_key(model), artifact)
    clock = perf_counter()
    build(artifact)
    print(json.dumps(found | {"compile": perf_counter() - clock}))


if __name__ == "__main__":
    main()
