"""The files of FMUs: valid, the same for the same scene, without traces, with the standard's own signatures."""

import re
import shutil
import subprocess
import zipfile
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu
from ltcgear.runtime.export.fmu.fmi_units import exponents
from ltcgear.runtime.export.fmu.names import identify, structure

HEADERS = Path(fmpy.__file__).parent / "c-code"
NATIVE = Path(__file__).parents[3] / "runtime" / "export" / "plain_c" / "c"


def test_both_are_valid(cs, me):
    assert validate_fmu(str(cs)) == []
    assert validate_fmu(str(me)) == []


def test_the_file_tells_nothing_of_its_origin(cs, me, folder, store):
    places = [Path.cwd(), Path.home(), folder, store, Path(__file__).parents[2], Path("/tmp")]
    secrets = [str(place).encode() for place in places if len(str(place)) > 1]
    for path in (cs, me):
        with zipfile.ZipFile(path) as archive:
            for name in archive.namelist():
                data = archive.read(name)
                assert not [secret for secret in secrets if secret in data], name
                assert not re.search(rb"graphs\.casadi|\.toml|site-packages|SerializingStream", data), name
                assert Path(name).suffix in (".xml", ".c", ".h", ".so")


def test_the_same_scene_gives_the_same_bytes(cs, me, pair, folder):
    for path, kind in ((cs, "co-simulation"), (me, "model-exchange")):
        pair.write(folder / "again.fmu", kind=kind)
        assert (folder / "again.fmu").read_bytes() == path.read_bytes()


@pytest.mark.parametrize("kind", ["co-simulation", "model-exchange"])
def test_whatever_a_scene_is_called_its_fmu_is_valid(kind, pair, folder):
    """XML has no control characters; in C ``*/`` ends a comment, and ``??/`` a string."""
    path = folder / "named.fmu"
    pair.write(path, kind=kind, name='a */ "b" ??/', title='\x01 <c> & "d"\n\u00e4')
    assert validate_fmu(str(path)) == []


@pytest.mark.parametrize("version", [2, 3])
def test_signatures_are_those_of_the_standard(version, folder):
    cc, source = shutil.which("cc"), NATIVE / f"fmi{version}.c"
    official = ["-I", str(HEADERS), "-include", f"fmi{version}Functions.h"]
    strict = ["-std=c11", "-Wall", "-Wextra", "-Werror", "-c", str(source), "-o"]
    subprocess.run([cc, *strict, str(folder / "own.o")], check=True)
    subprocess.run([cc, *official, *strict, str(folder / "theirs.o")], check=True)
    text = (HEADERS / f"fmi{version}Functions.h").read_text()
    wanted = set(re.findall(rf"(fmi{version}\w+)TYPE", text))
    names = subprocess.run(["nm", folder / "own.o"], capture_output=True, text=True, check=True).stdout
    assert set(re.findall(rf" T (fmi{version}\w+)", names)) == wanted


SIZES = {2: "fmi2CallbackFunctions fmi2EventInfo fmi2Byte fmi2Boolean", 3: "fmi3Boolean fmi3Byte fmi3Float32 fmi3Int64"}
OFFSETS = {2: [("fmi2CallbackFunctions", "componentEnvironment"), ("fmi2EventInfo", "nextEventTime")], 3: []}


@pytest.mark.parametrize("version", [2, 3])
def test_types_are_those_of_the_standard(version, folder):
    official = (HEADERS / f"fmi{version}FunctionTypes.h").read_text()
    text = re.sub(r"/\*.*?\*/", "", official, flags=re.DOTALL)
    values = re.findall(r"\w+", " ".join(re.findall(r"typedef enum \{(.*?)\}", text, re.DOTALL)))
    assert len(values) == {2: 12, 3: 14}[version]
    asked = [f"(int){value}" for value in values] + [f"(int)sizeof({kind})" for kind in SIZES[version].split()]
    asked += [f"(int)offsetof({kind}, {field})" for kind, field in OFFSETS[version]]
    body = "".join(f'printf("%d\\n", {each});' for each in asked)
    said = []
    for header in (NATIVE / f"fmi{version}types.h", HEADERS / f"fmi{version}FunctionTypes.h"):
        text = f'#include <stddef.h>\n#include <stdio.h>\n#include "{header}"\nint main(void) {{ {body} return 0; }}\n'
        (folder / "types.c").write_text(text)
        subprocess.run(["cc", folder / "types.c", "-o", folder / "types"], check=True)
        said.append(subprocess.run([folder / "types"], capture_output=True, text=True, check=True).stdout)
    assert said[0] == said[1] != ""


def test_the_binary_needs_nothing_but_the_c_library(cs, me, folder):
    for path in (cs, me):
        binary = next(Path(fmpy.extract(str(path), str(folder / path.stem))).glob("binaries/*/*.so"))
        needed = subprocess.run(["objdump", "-p", binary], capture_output=True, text=True, check=True).stdout
        assert set(re.findall(r"NEEDED +(\S+)", needed)) <= {"libm.so.6", "libc.so.6"}
        seen = subprocess.run(["nm", "-D", "--defined-only", binary], capture_output=True, text=True, check=True).stdout
        assert all(name.startswith("fmi") for name in re.findall(r" [A-Z] (\S+)", seen))


def test_names_and_units():
    assert structure("lsp.planet.2.x") == "lsp.planet[2].x"
    assert structure("lsp.planet.2.x.rate") == "lsp.planet[2].x_rate"
    assert structure("high-speed.u") == "'high-speed'.u"
    assert identify("hard-bounce 2") == "hard_bounce_2"
    assert identify("2mw") == "_2mw"
    assert exponents("N*m*s/rad") == {"kg": 1, "m": 2, "s": -1, "rad": -1}
    assert exponents("1/rad") == {"rad": -1}
    assert exponents("rad/s^2") == {"rad": 1, "s": -2}
    assert exponents("kg*m^2") == {"kg": 1, "m": 2}
    with pytest.raises(KeyError):
        exponents("furlong")


def test_the_command(data, refused, folder, pair, monkeypatch):
    scene = folder / "rattle.toml"
    said = data("export-fmu", scene, "-o", folder / "command.fmu", "--set", "loads.brake.torque=-90 N*m")
    assert said["inputs"] == ["loads.motor.speed", "loads.brake.torque"]
    description = fmpy.read_model_description(folder / "command.fmu")
    starts = {v.name: v.start for v in description.modelVariables if v.causality == "input"}
    assert float(starts["loads.brake.torque"]) == -90.0
    assert "name it" in refused("export-fmu", scene, "-o", folder / "a.zip")
    assert "does not exist" in refused("export-fmu", scene, "-o", folder / "none" / "a.fmu")
    assert "co-simulation, model-exchange" in refused("export-fmu", scene, "-o", folder / "a.fmu", "--kind", "both")
    assert "--kind model-exchange" in refused("export-fmu", "hard-tiny-inertia", "-o", folder / "a.fmu")
    shutil.copy(scene, folder / "itself.fmu")
    assert "is the file that is read" in refused("export-fmu", folder / "itself.fmu", "-o", folder / "itself.fmu")
    assert "is a folder" in refused("export-fmu", scene, "-o", make_folder(folder / "b.fmu"))
    monkeypatch.setattr("ltcgear.generated.store.compiler", lambda: None)
    assert "needs a C compiler" in refused("export-fmu", scene, "-o", folder / "a.fmu", code=3)
    assert not (folder / "a.fmu").exists()


def make_folder(path):
    """Make a folder and return its path."""
    path.mkdir()
    return path
