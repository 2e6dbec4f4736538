"""Loading scenes: from files, shipped ones by name, and from the JSON that results keep."""

import os

import pytest
from ltcgear.generated.errors import SceneError
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.scene.load import LARGEST_FILE, SHIPPED, load_scene, make_scene, restore_scene, shipped_scenes
from ltcgear.symbolic.schema.effects import DEFAULTS, EFFECTS, contradictions

from ...runtime.models import raw_scene


@pytest.mark.parametrize("name", shipped_scenes())
def test_a_scene_survives_its_json(name):
    scene = load_scene(name)
    again = restore_scene(scene.model_dump_json())
    assert again == scene
    assert again.sources == scene.sources
    assert build_model(again).values() == build_model(scene).values()
    assert build_model(again).structure() == build_model(scene).structure()


def test_a_scene_with_everything_survives_its_json():
    changes = {
        "gravity": '["1 m/s^2", "-9.81 m/s^2"]',
        "effects.gravity": "on",
        "stages.lsp.planet_angles": '["0 deg", "90 deg", "180 deg", "270 deg"]',
        "stages.lsp.pin.friction": "0.01",
        "stages.lsp.pin.diameter": "0.3 m",
        "stages.lsp.sun_planet.friction": '{coefficient = 0.05, damping = "3 N*s/m"}',
        "stages.lsp.ring.drag": "0.1 N*m*s/rad",
        "stages.lsp.line_of_centres": "33.3 deg",
    }
    scene = load_scene("lsp", changes)
    assert restore_scene(scene.model_dump_json()) == scene


@pytest.mark.parametrize("text", ["", "{", "[]", "3", "null", "{}", '{"name": 1}', "[" * 100_000])
def test_a_kept_scene_that_is_none_is_refused(text):
    with pytest.raises(SceneError, match="kept scene: is not what ltcgear writes"):
        restore_scene(text)


def test_a_kept_scene_that_was_spoilt_is_refused():
    text = load_scene("lsp").model_dump_json().replace('"planetary"', '"planetry"')
    with pytest.raises(SceneError, match=r"stages\.lsp\.kind: 'planetry'"):
        restore_scene(text)


def test_a_scene_is_immutable():
    scene = load_scene("lsp")
    with pytest.raises(ValueError, match="frozen"):
        scene.title = "other"


def test_make_scene_leaves_its_argument_alone():
    tree = raw_scene("lsp")
    make_scene(tree)
    assert tree == raw_scene("lsp")


def test_wide_profile_shifts_are_solved():
    changes = {"stages.psh.input.profile_shift": 1.9, "stages.psh.output.profile_shift": 1.9}
    assert build_model(load_scene("psh", {key: str(value) for key, value in changes.items()})).values()


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.name)
def test_every_effect_takes_its_values(effect):
    more = {"stages.lsp.sun_planet.friction.coefficient": "0.05", "stages.lsp.pin.friction_damping": "1 N*m*s/rad"}
    for value in effect.values:
        if list(contradictions(DEFAULTS | {effect.name: value})):
            continue
        scene = load_scene("lsp", more | {f"effects.{effect.name}": value})
        assert scene.effects == DEFAULTS | {effect.name: value}
        assert build_model(scene).effects[effect.name] == value


def refused(path, match, changes=None):
    with pytest.raises(SceneError, match=match) as caught:
        load_scene(path, changes)
    assert str(path)[:40] in str(caught.value)
    assert "\n  " in str(caught.value) or "\n" not in str(caught.value)
    return str(caught.value)


@pytest.fixture
def write(tmp_path):
    def writer(data):
        path = tmp_path / "my gear.toml"
        path.write_bytes(data if isinstance(data, bytes) else data.encode())
        return path

    return writer


FILES = {
    "empty": (b"", "title: is missing"),
    "syntax": (b"title = \n", r"not valid TOML: Invalid value \(at line 1"),
    "key twice": (b"a = 1\na = 2\n", "not valid TOML: Cannot overwrite a value"),
    "unit without quotes": (b"module = 16 mm\n", r"not valid TOML: .*at line 1"),
    "binary": (bytes(range(256)) * 8, "cannot be read as UTF-8 text"),
    "UTF-16": ("title = 'x'".encode("utf-16"), "cannot be read as UTF-8 text"),
    "Latin-1": ("title = 'Größe'".encode("latin-1"), "cannot be read as UTF-8 text"),
    "zero bytes": (b"title\0= 'x'", "not valid TOML"),
    "nested lists": (b"a = " + b"[" * 50_000, "line 1: nested too deeply"),
    "nested tables": (b"a." * 3000 + b"b = 1", "nested too deeply"),
    "huge integer": (b"a = " + b"9" * 6000, "line 1: a key or number has more than 200 characters"),
    "huge file": (b"#" * (LARGEST_FILE + 1), "more than 1000000 bytes"),
    "another program's file": (b"[package]\nname = 'x'\n", "package: unknown key"),
}


@pytest.mark.parametrize("kind", FILES)
def test_a_file_that_is_no_scene_is_refused(kind, write):
    data, reason = FILES[kind]
    refused(write(data), reason)


@pytest.mark.parametrize("change", [lambda b: b"\xef\xbb\xbf" + b, lambda b: b.replace(b"\n", b"\r\n")])
def test_files_from_other_systems_are_read(write, change):
    path = write(change((SHIPPED / "lsp.toml").read_bytes()))
    scene = load_scene(path)
    assert scene.name == "my gear"
    assert scene.stages == load_scene("lsp").stages


def test_a_folder_is_refused(tmp_path):
    refused(tmp_path, "is a folder")


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
def test_an_unreadable_file_is_refused(write):
    path = write("title = 'x'")
    path.chmod(0)
    refused(path, "Permission denied")


def test_a_file_that_cannot_be_opened_is_refused(write, monkeypatch):
    path = write("title = 'x'")

    def forbidden(self, *args, **kwargs):
        raise PermissionError(13, "Permission denied", str(self))

    monkeypatch.setattr(type(path), "open", forbidden)
    refused(path, "cannot be read: Permission denied")


@pytest.mark.parametrize("name", ["nosuch", "no/such/file.toml", "", "a" * 5000, "a\0b", "lsp.toml/x"])
def test_a_scene_that_is_not_there_is_refused(name):
    with pytest.raises(SceneError) as caught:
        load_scene(name)
    assert len(str(caught.value)) < 1000
    assert "\0" not in str(caught.value)


@pytest.mark.parametrize(("name", "near"), [("rig2mw", "rig-2mw"), ("lsp.toml", "lsp"), ("lin-parker", "lin-parker-")])
def test_the_nearest_shipped_scene_is_named(name, near):
    assert f'did you mean "{near}' in refused(name, "no such file and no shipped scene; did you mean")
    assert "; shipped scenes: floating-off, " in refused("zzzzz", "no such file")
