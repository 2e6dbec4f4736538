"""C without files: what CasADi would write into one, made where no file can be."""

from pathlib import Path

import casadi as ca
from ltcgear.symbolic.emit import c_text
from ltcgear.symbolic.pointers import look_once


def test_the_text_is_what_casadi_writes_into_a_file(tmp_path):
    x = ca.SX.sym("x", 3)
    function = ca.Function("rhs", [x], [ca.sin(x)], ["x"], ["xdot"])
    made = [function, function.jacobian()]
    generator = ca.CodeGenerator("model.c", {"verbose": False, "casadi_int": "long long int"})
    for one in made:
        generator.add(one)
    generator.generate(f"{tmp_path}/")
    assert c_text(made) == look_once(Path(tmp_path, "model.c").read_text("utf-8"))


def test_no_temporary_folder_is_needed(monkeypatch, run, tmp_path):
    def refuse(**where):
        raise FileNotFoundError(2, "No usable temporary directory found")

    monkeypatch.setenv("LTCGEAR_CACHE", str(tmp_path / "store"))
    monkeypatch.setattr("tempfile._get_default_tempdir", refuse)
    monkeypatch.setattr("tempfile.tempdir", None)
    monkeypatch.setenv("TMPDIR", "/nowhere")
    result = tmp_path / "a.nc"
    assert run("simulate", "psh", "--t-end", "0.001", "--method", "rosenbrock", "-o", result)[0] == 0
    assert run("export-fmu", "psh", "-o", tmp_path / "a.fmu")[0] == 0
    assert run("report", result, "-o", tmp_path / "a.html")[0] in (0, 2)
