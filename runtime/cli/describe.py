"""Commands that tell about scenes and models: scenes, effects, info, check, generate."""

from dataclasses import asdict

import typer
from ltcgear.generated import store
from ltcgear.generated.errors import LtcgearError
from ltcgear.generated.folders import write_unchanged

from ..view.tables import printed, scene_tables
from .app import app
from .opening import compile_model, open_scene, read_run, split_changes
from .options import AsJson, CFolder, Changes, Force, Fresh, MaybeScene, Printed, SceneName, Sources


@app.command()
def scenes(as_json: AsJson = False) -> None:
    """List the shipped scenes."""
    from ltcgear.symbolic.scene.load import load_scene, shipped_scenes

    listed = [{"name": name, "title": load_scene(name).title} for name in shipped_scenes()]
    printed.show_tables(as_json, {"scenes": listed}, scene_tables.list_scenes)


@app.command()
def effects(as_json: AsJson = False) -> None:
    """List the effects a scene can call for."""
    from ltcgear.symbolic.describe.effect_page import list_effects

    printed.show_tables(as_json, {"effects": list_effects()}, scene_tables.list_effects)


@app.command()
def info(scene: SceneName, sources: Sources = False, changes: Changes = None, as_json: AsJson = False) -> None:
    """Describe a scene: freedoms, geometry, motion, forces, loads."""
    from ltcgear.symbolic.describe.overview import survey

    opened = open_scene(scene, changes)
    data = survey(opened.scene, opened.model, opened.artifact.manifest)
    if sources:
        data["sources"] = dict(opened.scene.sources)
    printed.show_tables(as_json, data, scene_tables.list_model)


@app.command()
def check(scene: MaybeScene = None, paper: Printed = False, changes: Changes = None, as_json: AsJson = False) -> None:
    """Check a scene's equations, or those the paper prints. Exit code 1 if a check fails."""
    if paper and scene is not None:
        raise LtcgearError(f"check: both {scene} and --paper were given; give one of them")
    if not paper and scene is None:
        raise LtcgearError("check: give a SCENE, or --paper")
    if paper:
        from ltcgear.symbolic.checks.paper import check_paper

        printed.show(as_json, {"equations": [asdict(verdict) for verdict in check_paper()]}, printed.paper_verdicts)
        return
    from ltcgear.symbolic.assembly import build_model
    from ltcgear.symbolic.checks.all_checks import check_model
    from ltcgear.symbolic.scene.load import load_scene

    results = check_model(build_model(load_scene(scene or "", split_changes(changes))))
    listed = [asdict(result) for result in results]
    passed = all(item["passed"] for item in listed)
    printed.show_tables(as_json, {"passed": passed, "checks": listed}, scene_tables.list_checks)
    if not passed:
        raise typer.Exit(1)


@app.command()
def generate(
    scene: SceneName,
    output: CFolder = None,
    fresh: Fresh = False,
    changes: Changes = None,
    force: Force = False,
    as_json: AsJson = False,
) -> None:
    """Derive, check, emit and compile a scene's C, and keep it in the store.

    -o writes it to a folder, with all that plain C needs to simulate it.
    """
    opened = open_scene(scene, changes, fresh=fresh)
    library = compile_model(opened)
    files = store.files(opened.artifact)
    del files["graphs.casadi"]
    folder = output or store.model_folder(opened.key)
    if output is not None:
        from ..export.plain_c.data import write_data
        from ..export.plain_c.kit import write_kit

        files |= write_kit() | {"data.c": write_data(library, opened.scene.name, read_run(opened, library))}
        write_unchanged(output, files)
    ops = {name: signature.operations for name, signature in opened.artifact.manifest.functions.items()}
    data = {
        "files": [str(folder / name) for name in files],
        "library": str(library.path) if library.path else None,
        "ops": ops,
        "seconds": dict.fromkeys(("derive", "check", "emit"), 0.0) | opened.seconds,
        "key": opened.key,
    }
    printed.show(as_json, data, printed.generated)
