"""C without files: what CasADi would write into one, made where no file can be."""

from pathlib import Path

import casadi as ca
import numpy as np
from ltcgear.runtime.export.fmu.binary import compile_fmu
from ltcgear.runtime.model.building import build
from ltcgear.runtime.simulation.methods.casadi import whole_c
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.c_text import c_text
from ltcgear.symbolic.emit.pipeline import generate
from ltcgear.symbolic.emit.pointers import look_once
from ltcgear.symbolic.scene.load import make_scene


def test_the_text_is_what_casadi_writes_into_a_file(tmp_path):
    x = ca.SX.sym("x", 3)
    function = ca.Function("rhs", [x], [ca.sin(x)], ["x"], ["xdot"])
    made = [function, function.jacobian()]
    generator = ca.CodeGenerator("model.c", {"verbose": False, "casadi_int": "long long int"})
    for one in made:
        generator.add(one)
    generator.generate(f"{tmp_path}/")
    assert c_text(made) == look_once(Path(tmp_path, "model.c").read_text("utf-8"))


def test_no_temporary_folder_is_needed(monkeypatch):
    def refuse():
        raise FileNotFoundError(2, "No usable temporary directory found")

    raw = {"title": "one", "rotors": {"a": {"inertia": "2 kg*m^2"}}}
    raw["loads"] = {"motor": {"member": "a", "torque": "1 N*m", "initial_speed": "1 rad/s"}}
    monkeypatch.setattr("tempfile._get_default_tempdir", refuse)
    monkeypatch.setattr("tempfile.tempdir", None)
    monkeypatch.setenv("TMPDIR", "/nowhere")
    library = build(generate(build_model(make_scene(raw))))
    assert "ltcgear_tally" in whole_c(library, np.array([1.0]))
    assert compile_fmu({"a.c": "int fmi2Answer(void) { return 42; }\n"}, False)
