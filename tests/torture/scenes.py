"""Attack by scenes: mutated ones are refused with one message, or run to numbers that hold."""

import os
import re
import signal
import tomllib
from copy import deepcopy
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from ltcgear.generated import store
from ltcgear.runtime.model.building import build
from ltcgear.runtime.model.equilibrium import find_equilibrium
from ltcgear.runtime.model.library import Library
from ltcgear.runtime.results.result import Result
from ltcgear.runtime.simulation.simulate import WRONG as OPEN_BALANCE
from ltcgear.runtime.simulation.simulate import simulate
from ltcgear.symbolic import build_model, load_scene
from ltcgear.symbolic.describe.advice import warnings
from ltcgear.symbolic.describe.geometry_report import load_warnings
from ltcgear.symbolic.emit.pipeline import content_key, generate
from ltcgear.symbolic.mechanics.model import Model
from ltcgear.symbolic.scene.load import SHIPPED, describe_scene, read_source, restore_scene, shipped_scenes
from ltcgear.symbolic.schema.effects import EFFECTS

from .mutations import TEXTS, Mutator, damage, places, write_toml
from .outcome import RIGHT, STOPPED, Verdict
from .outcome import WRONG as BAD_NUMBERS
from .process import Case

ROOT = Path(__file__).resolve().parents[2]
COUNT, SECONDS = 3000, 20.0
T_END, PATIENCE = 0.02, 0.7
"""Time that is simulated [s]; seconds after which Ctrl-C stops a run."""
DERIVED = 0.15
"""Part of the scenes of new structure whose equations are derived, for their equilibrium."""
STILL = ("lateral", "mesh_law", "damping")
"""Effects that excite no motion."""
REST = 1e-3
"""How far a mean mesh force may be from statics where nothing excites a motion."""


@cache
def sources() -> tuple[dict[str, Any], ...]:
    """Return the scenes that are mutated: those shipped, those on pages, and one with data for every effect."""
    from ..runtime.everything import RAW

    texts = [(SHIPPED / f"{name}.toml").read_text(encoding="utf-8") for name in shipped_scenes()]
    for page in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))):
        texts += re.findall(r"^```toml\n(.*?)^```$", page.read_text("utf-8"), re.DOTALL | re.MULTILINE)
    return (*(tomllib.loads(text) for text in texts), RAW)


def prepare() -> None:
    """Load all of them, so that what is read once is read."""
    for name in shipped_scenes():
        content_key(build_model(load_scene(name)))
    generate(build_model(load_scene("psh")))


def make_case(seed: int, number: int) -> Case:
    """Return a mutated scene as a case."""
    generator = np.random.default_rng([seed, number])
    mutator = Mutator(generator)
    raw, changes = deepcopy(mutator.one(sources())), dict[str, str]()
    way = generator.random()
    if way < 0.1:
        name, data = "--set", write_toml(raw).encode("utf-8", "surrogatepass")
        for _ in range(int(generator.integers(1, 4))):
            key = ".".join(map(str, mutator.one(places(raw))))
            changes[mutator.one([key, key, key, key + ".x", *TEXTS])] = mutator.one(
                [*TEXTS, "1", "5e3 N*m", "on", "[]"]
            )
    elif way < 0.2:
        name, data = "bytes", damage(write_toml(raw).encode(), generator)
    else:
        name, data = " ".join(mutator.mutate(raw)), write_toml(raw).encode("utf-8", "surrogatepass")
    derived = bool(generator.random() < DERIVED)
    return Case(f"scene: {name}", lambda folder: attack(folder, data, changes, derived), SECONDS)


def attack(folder: Path, data: bytes, changes: dict[str, str], derived: bool) -> Verdict:
    """Take a scene as far as it goes."""
    (folder / "scene.toml").write_bytes(data)
    (folder / "changes.txt").write_text(repr(changes), "utf-8", "surrogatepass")
    source = read_source("scene.toml")
    scene = load_scene(source, changes)
    model = build_model(scene)
    told = [*warnings(scene, model), *load_warnings(scene)]
    kept = describe_scene(scene, source.text, changes)
    if restore_scene(kept["scene_json"]) != scene:
        return Verdict(BAD_NUMBERS, "the scene that a result keeps is another")
    artifact = store.get(content_key(model))
    if artifact is not None:
        return _simulated(scene, model, build(artifact), told)
    if not derived:
        return Verdict(RIGHT, "accepted")
    bare = Library((made := generate(model)).manifest, None, {}, made)
    library = Library(bare.manifest, None, bare.graphs, made)
    at = find_equilibrium(library, library.parameters(model.values()), tables=model.tables)
    return Verdict(RIGHT, "equilibrium") if np.isfinite(at.x).all() else Verdict(BAD_NUMBERS, "equilibrium not finite")


def _simulated(scene: Any, model: Model, library: Library, told: list[str]) -> Verdict:
    """Simulate a little, stopped by Ctrl-C where that takes too long; look at what comes out."""
    signal.signal(signal.SIGALRM, lambda number, frame: os.kill(os.getpid(), signal.SIGINT))
    signal.setitimer(signal.ITIMER_REAL, PATIENCE)
    try:
        result = simulate(library, model.values(), t_end=T_END, rate=scene.simulation.rate, tables=model.tables)
    except KeyboardInterrupt:
        return Verdict(STOPPED, "before the first step")
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
    status, told = result.summary["status"], [*told, *result.summary["warnings"]]
    if status != "done":
        return Verdict(STOPPED, status)
    reason = _absurd(result, scene) if not told else ""
    reason = reason or _unequal(result, scene, library, model)
    return Verdict(BAD_NUMBERS, f"{reason}; warnings: {told}") if reason else Verdict(RIGHT, "simulated")


def _absurd(result: Result, scene: Any) -> str:
    """Say what cannot be about a run that nothing was said against."""
    data = result.dataset
    for name in ("state", "mesh_force", "mesh_deflection", "speed"):
        if name in data and not np.isfinite(data[name].values).all():
            return f"{name} is not finite"
    if not abs(result.summary["energy_residual"]) < OPEN_BALANCE:
        return f"energy balance open by {result.summary['energy_residual']}"
    if "mesh_deflection" in data:
        for mesh in data["mesh"].values.tolist():
            most = float(np.abs(data["mesh_deflection"].sel(mesh=mesh).values).max())
            module = scene.stages[mesh.split(".")[0]].module
            if module is not None and most > module:
                return f"{mesh} is deflected by {most:.3g} m, more than a module"
    return ""


def _unequal(result: Result, scene: Any, library: Library, model: Model) -> str:
    """Say how mean mesh forces differ from statics where nothing excites a motion."""
    if model.tables or any(scene.effects[e.name] != e.without for e in EFFECTS if e.name not in STILL):
        return ""
    p = library.parameters(model.values())
    at = find_equilibrium(library, p, tables=model.tables)
    wanted = np.array(library.functions["outputs"](at.x, at.s, p)).ravel()
    columns = [(i, r.item) for i, r in enumerate(library.manifest.reports) if r.quantity == "mesh_force"]
    largest = max((abs(wanted[i]) for i, _ in columns), default=0.0)
    for i, mesh in columns:
        found = float(result.dataset["mesh_force"].sel(mesh=mesh).values.mean())
        if abs(found - wanted[i]) > REST * largest + 1e-6:
            return f"{mesh}: mean force {found:.6g} N, statics {wanted[i]:.6g} N"
    return ""
