"""Opening of scenes for the commands: scene -> model -> C -> compiled library."""

from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

from ltcgear.generated.contract import Artifact
from ltcgear.generated.errors import LtcgearError, MachineError
from ltcgear.generated.writing import check_output

from ..results.terminal import tell
from .progress import progress

if TYPE_CHECKING:
    from ltcgear.symbolic.mechanics.model import Model
    from ltcgear.symbolic.scene.load import Source
    from ltcgear.symbolic.schema.scene_schema import Scene

    from ..export.plain_c.data import PlainRun
    from ..model.library import Library
    from ..studies.cost import Variant


@dataclass
class Opened:
    """A scene on its way through the house, with what a result keeps of it and the seconds each stage took.

    ``source`` is what it was read from, ``inputs`` are the tables that others lead.
    """

    scene: "Scene"
    model: "Model"
    artifact: Artifact
    key: str
    about: dict[str, Any]
    source: "Source"
    seconds: dict[str, float] = field(default_factory=dict)
    inputs: tuple[str, ...] = ()


def split_changes(pairs: list[str] | None) -> dict[str, str]:
    """Split KEY=VALUE pairs."""
    split = [pair.partition("=") for pair in pairs or []]
    bad = [key for key, sign, _ in split if not sign or not key]
    if bad:
        raise LtcgearError(f"--set {bad[0]}: write KEY=VALUE, for example loads.motor.speed='10 rpm'")
    return {key: value for key, _, value in split}


def open_scene(
    name: "str | Source", changes: list[str] | None = None, output: Path | None = None, fresh: bool = False,
    steered: bool = False,
) -> Opened:  # fmt: skip
    """Take a scene through all stages up to generated C; what the store holds is not derived again.

    scene -> Model -> (derive -> check -> emit, or the store) -> Artifact; ``output`` is refused where it is a file that
    the scene names; ``steered`` turns its constant loads into
    tables, which are its inputs.
    """
    from ltcgear.symbolic.assembly import build_model
    from ltcgear.symbolic.describe.advice import warnings
    from ltcgear.symbolic.describe.geometry_report import load_warnings
    from ltcgear.symbolic.emit.pipeline import content_key, obtain
    from ltcgear.symbolic.scene.load import describe_scene, load_scene, read_source
    from ltcgear.symbolic.scene.steering import steer_loads

    clock = perf_counter()
    replaced = split_changes(changes)
    source = read_source(name)
    scene = load_scene(source, replaced)
    if output is not None:
        check_output(output, *source.paths)
    led, inputs = steer_loads(scene) if steered else (scene, ())
    model = build_model(led)
    seconds = {"load": perf_counter() - clock}
    for line in [*warnings(scene, model), *load_warnings(scene)]:
        tell(f"warning: {source.label}: {line}")
    about = describe_scene(scene, source.text, replaced)
    artifact = obtain(model, lambda stage, taken: seconds.update({stage: taken}), fresh)
    return Opened(scene, model, artifact, content_key(model), about, source, seconds, inputs)


def compile_model(opened: Opened) -> "Library":
    """Compile and load a generated model; without a compiler this is said in one line."""
    from ..model.building import NO_COMPILER, build

    clock = perf_counter()
    library = build(opened.artifact)
    opened.seconds["compile"] = perf_counter() - clock
    if library.path is None:
        tell(NO_COMPILER)
    return library


def read_run(opened: Opened, library: "Library") -> "PlainRun":
    """Return what a scene simulates, in numbers."""
    from ..export.plain_c.data import PlainRun

    return PlainRun(opened.model.values(), opened.model.tables, opened.scene.simulation.t_end, rate_of(opened, library))


def rate_of(opened: Opened, library: "Library") -> float:
    """Return the sampling rate [Hz] that a scene gives, or that is chosen for it."""
    from ..simulation.sampling_rate import find_rate

    return find_rate(library, opened.model.values(), opened.model.tables, opened.scene.simulation.rate).rate


def open_variants(changes: dict[str, str], opened: Opened) -> "list[Variant]":
    """Build a scene and what it is with each of its effects left out; what is not possible keeps its reason."""
    from ltcgear.symbolic.assembly import build_model
    from ltcgear.symbolic.describe.variants import list_changes
    from ltcgear.symbolic.emit.pipeline import obtain
    from ltcgear.symbolic.scene.load import load_scene

    from ..model.building import build
    from ..studies.cost import Variant

    found = list_changes(opened.scene, opened.model)
    variants = [Variant("all", "", "", compile_model(opened), opened.model.values(), tables=opened.model.tables)]
    with progress(f"build {opened.scene.name}", len(found), "variants") as told:
        for k, item in enumerate(found, start=1):
            key = (item.effect, item.value, item.without)
            try:
                model = build_model(load_scene(opened.source, changes | {f"effects.{item.effect}": item.without}))
                made = Variant(*key, build(obtain(model)), model.values(), tables=model.tables)
            except MachineError:
                raise
            except LtcgearError as error:
                made = Variant(*key, None, {}, str(error))
            variants.append(made)
            told(k)
    return variants
