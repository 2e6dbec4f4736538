"""Scenes on their way through the house: scene -> model -> C -> library."""

import sys
from dataclasses import dataclass, field
from time import perf_counter
from typing import TYPE_CHECKING, Any

from ltcgear.generated.contract import Artifact
from ltcgear.generated.errors import LtcgearError

from ..progress import progress

if TYPE_CHECKING:
    from ltcgear.symbolic.model import Model
    from ltcgear.symbolic.schema import Scene

    from ..cost import Variant
    from ..library import Library


@dataclass
class Opened:
    """A scene on its way through the house, with what a result keeps of it and the seconds each stage took."""

    scene: "Scene"
    model: "Model"
    artifact: Artifact
    key: str
    about: dict[str, Any]
    seconds: dict[str, float] = field(default_factory=dict)


def split_changes(pairs: list[str] | None) -> dict[str, str]:
    """Split KEY=VALUE pairs."""
    split = [pair.partition("=") for pair in pairs or []]
    bad = [key for key, sign, _ in split if not sign or not key]
    if bad:
        raise LtcgearError(f"--set {bad[0]}: write KEY=VALUE, for example loads.motor.speed='10 rpm'")
    return {key: value for key, _, value in split}


def open_scene(name: str, changes: list[str] | None = None, fresh: bool = False) -> Opened:
    """Take a scene through all stages up to generated C; what the store holds is not derived again.

    scene -> Model -> (derive -> check -> emit, or the store) -> Artifact
    """
    from ltcgear.symbolic.advice import warnings
    from ltcgear.symbolic.build import build_model
    from ltcgear.symbolic.pipeline import content_key, obtain
    from ltcgear.symbolic.report import load_warnings
    from ltcgear.symbolic.scene import describe_scene, load_scene, read_scene_text

    clock = perf_counter()
    replaced = split_changes(changes)
    scene = load_scene(name, replaced)
    model = build_model(scene)
    seconds = {"load": perf_counter() - clock}
    for line in [*warnings(scene, model), *load_warnings(scene)]:
        print(f"ltcgear: warning: {name}: {line}", file=sys.stderr)
    about = describe_scene(scene, read_scene_text(name), replaced)
    artifact = obtain(model, lambda stage, taken: seconds.update({stage: taken}), fresh)
    return Opened(scene, model, artifact, content_key(model), about, seconds)


def compile_model(opened: Opened) -> "Library":
    """Compile and load a generated model; without a compiler this is said in one line."""
    from ..library import NO_COMPILER, build

    clock = perf_counter()
    library = build(opened.artifact)
    opened.seconds["compile"] = perf_counter() - clock
    if library.path is None:
        print(NO_COMPILER, file=sys.stderr)
    return library


def open_variants(name: str, changes: dict[str, str], opened: Opened) -> "list[Variant]":
    """Build a scene and what it is with each of its effects left out; what is not possible keeps its reason."""
    from ltcgear.symbolic.build import build_model
    from ltcgear.symbolic.pipeline import obtain
    from ltcgear.symbolic.scene import load_scene
    from ltcgear.symbolic.variants import list_changes

    from ..cost import Variant
    from ..library import build

    found = list_changes(opened.scene, opened.model)
    variants = [Variant("all", "", "", compile_model(opened), opened.model.values(), tables=opened.model.tables)]
    with progress(f"build {opened.scene.name}", len(found), "variants") as told:
        for k, item in enumerate(found, start=1):
            key = (item.effect, item.value, item.without)
            try:
                model = build_model(load_scene(name, changes | {f"effects.{item.effect}": item.without}))
                made = Variant(*key, build(obtain(model)), model.values(), tables=model.tables)
            except LtcgearError as error:
                made = Variant(*key, None, {}, str(error))
            variants.append(made)
            told(k)
    return variants
