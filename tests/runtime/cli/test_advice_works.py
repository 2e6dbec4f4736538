"""Advice works: whoever does what a message of a command or a function says gets what was asked for."""

import re
import shlex

import numpy as np
import pytest
import xarray as xr
from ltcgear.generated.errors import LtcgearError
from ltcgear.generated.writing import force
from ltcgear.runtime import load, load_sweep, simulate, sweep, write_fmu
from ltcgear.runtime.cli.measuring import measure
from ltcgear.runtime.cli.opening import compile_model, open_scene
from ltcgear.runtime.export.fmu import package
from ltcgear.runtime.linear import chart
from ltcgear.runtime.studies.accuracy import phases
from ltcgear.runtime.studies.accuracy.record import write_record
from ltcgear.symbolic import Template
from ltcgear.symbolic.scene.load import SHIPPED

from ..models import case

HELD, TORQUE = r"(?m)^speed = .*$", r"(?m)^torque = .*$"
SCENES = {
    "driven": ("psh", HELD, 'torque = "10 N*m"\ninitial_speed = "-600 rpm"'),
    "still": ("psh", HELD, 'speed = "0 rpm"'),
    "ramp": ("psh", HELD, 'speed_over_time = [["0 s", "-600 rpm"], ["1 s", "-700 rpm"]]'),
    "rest": ("psh", r"\[loads.input\]\n.*\n.*\n", '[stages.psh.input.torsional_support]\nstiffness = "1e8 N*m/rad"\n'),
    "step": ("psh", TORQUE, 'torque_over_time = [["0 s", "-1e4 N*m"], ["1 s", "-1.1e4 N*m"]]'),
    "carried": ("lin-parker-3", r"\Z", '\n[loads.c]\nmember = "gear.carrier"\nspeed = "9 rpm"\n'),
    "pushed": ("lin-parker-3", r"\Z", '\n[loads.r]\nmember = "gear.ring"\ntorque = "9 N*m"\n'),
}
"""Scenes that are a shipped one with something in another's place."""
STAGE = """
[stages.{0}]
kind = "pair"
module = "4 mm"
pressure_angle = "20 deg"
helix_angle = "10 deg"
input = {{ teeth = {1}, support = "rigid", inertia = "1 kg*m^2" }}
output = {{ teeth = {2}, support = "rigid", inertia = "1 kg*m^2" }}
mesh = {{ stiffness = "7e8 N/m", double_factor = 1.4, damping_ratio = 0.05 }}
"""
TRAIN = """
title = "Three stages"
[loads.a]
member = "a.input"
speed = "100 rpm"
[loads.c]
member = "c.output"
torque = "-10 N*m"
[couplings.ab]
between = ["a.output", "b.input"]
stiffness = "9e4 N*m/rad"
damping_ratio = 0.02
[couplings.bc]
between = ["b.output", "c.input"]
stiffness = "9e4 N*m/rad"
damping_ratio = 0.02
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Make a folder with scenes, results whole and broken, a sweep, and a record of accuracy."""
    folder = tmp_path_factory.mktemp("advice")
    for name, (shipped, old, new) in SCENES.items():
        text, count = re.subn(old, new, (SHIPPED / f"{shipped}.toml").read_text("utf-8"))
        assert count == 1
        (folder / f"{name}.toml").write_text(text, "utf-8")
    for name, teeth in {"train": (31, 20, 40, 20, 40, 20), "odd": (31, 211, 223, 199, 197, 23)}.items():
        text = TRAIN + "".join(STAGE.format(stage, *teeth[2 * k : 2 * k + 2]) for k, stage in enumerate("abc"))
        (folder / f"{name}.toml").write_text(text, "utf-8")
    psh = case("psh")
    result = simulate(psh.library, psh.model.values(), t_end=0.3, rate=8192.0)
    result.save(folder / "psh.nc")
    for name, end in {"few": 9, "one": 1}.items():
        result.dataset.isel(time=slice(0, end)).to_netcdf(folder / f"{name}.nc")
    for name, begin in {"late": 2000, "early": 900, "soon": 30}.items():
        broken = result.dataset.copy(deep=True)
        broken["mesh_force"][begin:] = np.nan
        broken.to_netcdf(folder / f"{name}.nc")
    result.dataset.assign_attrs(result_format=1).to_netcdf(folder / "old.nc")
    xr.Dataset({"a": 1}).to_netcdf(folder / "foreign.nc")
    (folder / "text.nc").write_text("text")
    sweep(Template("lsp"), ["loads.ring.speed=5 rpm:20 rpm:2"], folder / "sweep.nc", t_end=0.01, workers=1)
    opened = open_scene("psh")
    options = {"t_end": 0.02, "methods": ["erk"], "rtols": [1e-4]}
    (folder / "record").mkdir()
    write_record(measure(opened, compile_model(opened), "quick", **options), folder / "record")
    return folder


@pytest.fixture(autouse=True)
def unforced():
    """Leave nothing forced behind."""
    yield
    force(False)


LINEAR = {
    "no turn": ("modes psh --turn nan", "give one, for example 0.25", ["modes psh --turn 0.25"]),
    "no count": ("modes psh --count 0", "give 1 or more, or leave --count out", ["modes psh --count 1", "modes psh"]),
    "no picture": ("modes psh --mode 1", "for example -o modes.png", ["modes psh --mode 1 -o modes.png"]),
    "mode 0": ("modes psh --mode 0 -o m.svg", "modes are numbered from 1", ["modes psh --mode 1 -o m.svg"]),
    "suffix": ("modes psh -o m.txt", "name it m.csv", ["modes psh -o m.csv"]),
    "high mode": ("modes psh --mode 9 -o m.svg", "there are 5 modes; give a number up to that\n",
                  ["modes psh --mode 5 -o m.svg"]),
    "of few modes": ("modes psh --mode 3 --count 2 -o m.svg", "give a number up to that, or --count 3",
                     ["modes psh --mode 2 --count 2 -o m.svg", "modes psh --mode 3 --count 3 -o m.svg"]),
    "too high": ("modes psh --mode 9 --count 2 -o m.svg", "there are 5 modes; give a number up to that, and --count 5",
                 ["modes psh --mode 5 --count 5 -o m.svg"]),
    "two axes": ("campbell psh --speed 0:9:3 --load 1:2:2", "give one of them",
                 ["campbell psh --speed 0:9:3", "campbell psh --load 1:2:2"]),
    "no range": ("campbell psh --speed 20", "for example --speed 0:20:61", ["campbell psh --speed 0:20:61"]),
    "no loads": ("campbell psh --load 1:2", "for example --load 0.2:2:31", ["campbell psh --load 0.2:2:31"]),
    "long range": ("campbell psh --speed 0:9:1001", "1000 at most; take fewer", ["campbell psh --speed 0:9:9"]),
    "no figure": ("campbell psh -o x.txt", "name it .png, .svg or .pdf for a figure, .csv or .json for numbers",
                  [f"campbell psh --speed 0:9:3 -o x.{suffix}" for suffix in ("svg", "pdf", "csv", "json")]),
    "campbell still": ("campbell still.toml", "for example --speed 0:100:41", ["campbell still.toml --speed 0:100:41"]),
    "campbell ramp": ("campbell ramp.toml", "give a constant one, loads.NAME.speed, in its place", ["campbell psh"]),
    "campbell rest": ("campbell lin-parker-3", "hold a member's speed, loads.NAME.speed\n", ["campbell carried.toml"]),
    "campbell pushed": ("campbell pushed.toml", "or sweep the load, for example --load 0.2:2:31",
                        ["campbell pushed.toml --load 0.2:2:31"]),
    "no torque": ("campbell lin-parker-3 --load 0.2:2:3", "give one, loads.NAME.torque",
                  ["campbell pushed.toml --load 0.2:2:3"]),
    "misspelt mesh": ("response psh --excite psh.mehs", "did you mean psh.mesh?", ["response psh --excite psh.mesh"]),
    "no mesh": ("response psh --excite zzz", "Meshes: psh.mesh; loads with a torque: output",
                ["response psh --excite psh.mesh", "response psh --excite output"]),
    "high from": ("response psh --excite psh.mesh --from 1e7", "give both, for example --from 10 --to 1000",
                  ["response psh --excite psh.mesh --from 10 --to 1000"]),
    "stability at 0": ("stability psh --speed 0", "a --speed above 0", ["stability psh --speed 1"]),
    "stability still": ("stability still.toml", "another loads.NAME.speed, or the command a --speed above 0",
                        ["stability still.toml --set 'loads.input.speed=5 rpm'", "stability still.toml --speed 5",
                         "stability still.toml --speed 5:9:2"]),
    "from 0": ("stability psh --speed 0:9:3", "begin above 0", ["stability psh --speed 1:9:3"]),
    "no speeds": ("stability psh --speed 20:10:3", "for example --speed 100:600:60, or one number, 0 or above",
                  ["stability psh --speed 100:600:60", "stability psh --speed 20"]),
    "no variations": ("stability psh --variation 0:2", "for example --variation 0:2:40, or one number, 0 or above",
                      ["stability psh --variation 0:2:40", "stability psh --variation 0"]),
    "stability driven": ("stability driven.toml", "give one load a speed in place of its torque and initial_speed",
                         ["stability psh"]),
    "stability ramp": ("stability ramp.toml", "give loads.input.speed in place of loads.input.speed_over_time",
                       ["stability psh"]),
    "stability step": ("stability step.toml", "give loads.output.torque in place of loads.output.torque_over_time",
                       ["stability psh"]),
    "stability rest": ("stability rest.toml", "hold one, loads.NAME.speed", ["stability psh"]),
    "nothing varies": ("stability psh --set effects.mesh_stiffness=mean", "set effects.mesh_stiffness to two-level",
                       ["stability psh --set effects.mesh_stiffness=two-level",
                        "stability psh --set effects.mesh_stiffness=smooth"]),
    "misspelt stage": ("stability lsp --mesh lsp.sun_plnet", "did you mean lsp.sun_planet?",
                       ["stability lsp --mesh lsp.sun_planet"]),
    "no stage": ("stability psh --mesh zzz", "there are psh, psh.mesh", ["stability psh --mesh psh",
                                                                    "stability psh --mesh psh.mesh"]),
    "long period": ("stability odd.toml", "the others at their means: --mesh a", ["stability odd.toml --mesh a"]),
    "stability file": ("stability psh -o a.txt", "name it a.png", ["stability psh -o a.png"]),
    "two wishes": ("sensitivity psh --mode 1 --output mesh_force:psh.mesh", "give one of them",
                   ["sensitivity psh --mode 1", "sensitivity psh --output mesh_force:psh.mesh --t-end 0.02"]),
    "no such mode": ("sensitivity psh --mode 9", "there are 5 modes", ["sensitivity psh --mode 5"]),
    "rigid mode": ("sensitivity driven.toml --mode 1", "give another", ["sensitivity driven.toml --mode 2"]),
    "sensitivity file": ("sensitivity psh -o s.txt", "name it s.csv", ["sensitivity psh -o s.csv"]),
}  # fmt: skip
MEAN = "sensitivity psh --t-end 0.02 --output"
OUTPUTS = {
    "growing": (f"{MEAN} mesh_phase:psh.mesh", "give another output", [f"{MEAN} mesh_force:psh.mesh"]),
    "no item": (f"{MEAN} mesh_force", "nearest: psh.mesh", [f"{MEAN} mesh_force:psh.mesh"]),
    "no quantity": (f"{MEAN} force:psh.mesh", "write QUANTITY:ITEM with one of bearing_force_x, bearing_force_y",
                    [f"{MEAN} bearing_force_x:psh.input"]),
    "no measure": (f"{MEAN} mesh_force:psh.mesh --measure peak", "must be one of mean, rms, vibration, max, min",
                   [f"{MEAN} mesh_force:psh.mesh --measure {measure}" for measure in ("vibration", "max", "min")]),
    "late from": (f"{MEAN} mesh_force:psh.mesh --from 1", "between 0 and the end of the run, 0.02 s",
                  [f"{MEAN} mesh_force:psh.mesh --from 0.01"]),
    "constant": (f"{MEAN} load_torque:output --measure rms --measure vibration", "ask for mean",
                 [f"{MEAN} load_torque:output --measure mean"]),
}  # fmt: skip
SEE = "analyse psh.nc --no-modes"
RESULTS = {
    "few samples": ("analyse few.nc --no-modes", "simulate longer",
                    ["simulate psh --t-end 0.02 -o more.nc && analyse more.nc --no-modes"]),
    "figures": (f"{SEE} --format gif", "one of png, svg, pdf", [f"{SEE} --format pdf"]),
    "no band": (f"{SEE} --band 5", "for example 500:1500", [f"{SEE} --band 500:1500"]),
    "high band": (f"{SEE} --band 500:9999", "up to 4096 Hz, low before high, for example 512:1536",
                  [f"{SEE} --band 500:4096", f"{SEE} --band 512:1536"]),
    "narrow band": (f"{SEE} --band 500:501", "make it 19.99 Hz wide at least", [f"{SEE} --band 500:519.99"]),
    "outside": (f"{SEE} --from 0.2 --to 0.9", "from 0 s to 0.300049 s; give two instants in it",
                [f"{SEE} --from 0 --to 0.300049"]),
    "short span": (f"{SEE} --from 0.20005 --to 0.201", "give 0.007813 s or more",
                   [f"{SEE} --from 0.20005 --to 0.207863"]),
    "late gap": ("analyse late.nc --no-modes", "--from 0.12207", ["analyse late.nc --no-modes --from 0.122070312 "
                                                              "--to 0.244018555"]),
    "early gap": ("analyse early.nc --no-modes", "--from 0.0549316406 --to 0.109741211",
                  ["analyse early.nc --no-modes --from 0.0549316406 --to 0.109741211"]),
    "soon a gap": ("analyse soon.nc --no-modes", "too little comes before it; simulate again",
                   ["simulate psh --t-end 0.02 -o more.nc && analyse more.nc --no-modes"]),
    "whole quantity": (f"{SEE} --output mesh_force", "for example mesh_force:psh.mesh",
                       [f"{SEE} --output mesh_force:psh.mesh"]),
    "item": (f"{SEE} --output mesh_force:psh.msh", 'did you mean "psh.mesh"?', [f"{SEE} --output mesh_force:psh.mesh"]),
    "quantity": (f"{SEE} --output mesh_focre:psh.mesh", 'did you mean "mesh_force"?',
                 [f"{SEE} --output mesh_force:psh.mesh"]),
    "shaft": (f"{SEE} --shaft psh.outptu", "did you mean 'psh.output'?", [f"{SEE} --shaft psh.output"]),
    "no shaft": (f"{SEE} --shaft zzz", "there are psh.input, psh.output", [f"{SEE} --shaft psh.output"]),
    "slow shaft": (f"{SEE} --shaft psh.input", "give a span of 0.3794 s or more, by --from and --to",
                   ["simulate psh --t-end 0.4 -o more.nc && analyse more.nc --no-modes --shaft psh.input --from 0 --to "
                    "0.3794", "simulate psh --t-end 0.8 -o more.nc && analyse more.nc --no-modes --shaft psh.input"]),
    "window": (f"{SEE} --window foo", "one of hann, flattop, blackmanharris, boxcar",
               [f"{SEE} --window {name}" for name in ("hann", "flattop", "blackmanharris", "boxcar")]),
    "resolution": (f"{SEE} --resolution 0.1", "must lie between 3.332 and 128 Hz",
                   [f"{SEE} --resolution 3.332", f"{SEE} --resolution 128"]),
    "report of one": ("report one.nc", "simulate longer",
                      ["simulate psh --t-end 0.02 -o more.nc && report more.nc --no-modes"]),
    "report's name": ("report psh.nc -o a.txt", "name it a.html", ["report psh.nc --no-modes -o a.html"]),
    "report's time": ("report psh.nc --at 9", "from 0 s to 0.300049 s; give an instant in it",
                      ["report psh.nc --no-modes --at 0.300049"]),
    "no result": ("report none.nc", "`ltcgear simulate SCENE -o none.nc` writes one",
                  ["simulate psh --t-end 0.02 -o none.nc && report none.nc --no-modes"]),
    "form": ("export old.nc -o a.csv", "simulate again",
             ["simulate psh --t-end 0.02 -o old.nc --force && export old.nc -o a.csv"]),
    "damaged": ("export text.nc -o a.csv", "simulate again",
                ["simulate psh --t-end 0.02 -o text.nc --force && export text.nc -o a.csv"]),
    "foreign": ("export foreign.nc -o a.csv", "give a file that `ltcgear simulate -o` wrote",
                ["simulate psh --t-end 0.02 -o more.nc && export more.nc -o a.csv"]),
    "export's name": ("export psh.nc -o a.xls", "must end with .csv or .mat", ["export psh.nc -o a.csv",
                                                                               "export psh.nc -o a.mat"]),
    "exported item": ("export psh.nc -o a.csv --output mesh_force:psh", "there are psh.mesh",
                      ["export psh.nc -o a.csv --output mesh_force:psh.mesh"]),
    "exported": ("export psh.nc -o a.csv --output zzz", "there are reference_angle, steps,",
                 ["export psh.nc -o a.csv --output reference_angle", "export psh.nc -o a.csv --output steps",
                  "export psh.nc -o a.csv --output state"]),
}  # fmt: skip
TINY = "hard-tiny-inertia"
CHOSEN = "simulate psh --t-end 0.01 --accuracy"
OTHERS = {
    "check of both": ("check psh --paper", "give one of them", ["check psh", "check --paper"]),
    "check of none": ("check", "give a SCENE, or --paper", ["check psh"]),
    "no change": ("info psh --set a", "KEY=VALUE, for example loads.motor.speed='10 rpm'",
                  ["info rig-2mw --set loads.motor.speed='10 rpm'"]),
    "book's name": ("book psh -o a.txt", "name it a.html", ["book psh -o a.html"]),
    "costs' name": ("cost psh -o a.txt", "name it a.png", ["cost psh --t-end 0.01 -o a.png"]),
    "rtol": ("cost psh --rtol 1", "between 1e-13 and 0.1", ["simulate psh --t-end 0.01 --rtol 0.1"]),
    "no preset": ("accuracy psh --preset foo", "there are quick, full",
                  ["accuracy psh --preset quick --t-end 0.02 --method erk --rtol 1e-4"]),
    "method": ("accuracy psh --method ekr", 'did you mean "erk"?', ["simulate psh --t-end 0.01 --method erk"]),
    "no method": ("simulate psh --method foo", "there are auto, erk, cvodes, adams, idas, rosenbrock, sundae",
                  [f"simulate psh --t-end 0.01 --method {name}" for name in ("auto", "cvodes", "sundae")]),
    "no percentage": (f"{CHOSEN} 3 --record record/accuracy.json", "for example 0.1%",
                      [f"{CHOSEN} 0.1% --record record/accuracy.json"]),
    "all percent": (f"{CHOSEN} 300% --record record/accuracy.json", "for example 0.1%",
                    [f"{CHOSEN} 0.1% --record record/accuracy.json"]),
    "no accuracy": ("simulate psh --t-end 0.01 --record record/accuracy.json", "for example --accuracy 0.1%",
                    [f"{CHOSEN} 0.1% --record record/accuracy.json"]),
    "settings": (f"{CHOSEN} 1% --method erk --rtol 1e-5 --record record/accuracy.json", "leave out --method and --rtol",
                 [f"{CHOSEN} 1% --record record/accuracy.json"]),
    "fine accuracy": (f"{CHOSEN} 1e-9% --record record/accuracy.json", r"ask for --accuracy (\S+),",
                      [f"{CHOSEN} {{}} --record record/accuracy.json"]),
    "no end": ("simulate psh --t-end 0", "greater than zero and below 1e7", ["simulate psh --t-end 0.01"]),
    "no sample": ("simulate psh --t-end 1e-5", "simulate longer or raise simulation.rate",
                  ["simulate psh --t-end 1e-2", "simulate psh --t-end 1e-5 --set 'simulation.rate=1e6 Hz'"]),
    "many samples": ("simulate psh --t-end 9e6", "lower t_end or rate", ["simulate psh --t-end 0.01"]),
    "adams": (f"simulate {TINY} --method adams", "use --method rosenbrock or cvodes",
              [f"simulate {TINY} --method rosenbrock", f"simulate {TINY} --method cvodes"]),
    "many steps": (f"simulate {TINY} --method erk --t-end 2",
                   "use --method rosenbrock, give speck more inertia or softer springs, or simulate less time",
                   [f"simulate {TINY} --method rosenbrock --t-end 2",
                    f"simulate {TINY} --method erk --t-end 2e-5 --set 'simulation.rate=1 MHz'",
                    f"simulate {TINY} --method erk --t-end 2 --set 'rotors.speck.inertia=1 kg*m^2'"]),
    "torn teeth": ("simulate psh --t-end 0.01 --set 'loads.output.torque=-1e9 N*m'",
                   "check loads, stiffness and errors of the mesh", ["simulate psh --t-end 0.01"]),
    "fmu's name": ("export-fmu psh -o a.zip", "name it a.fmu", ["export-fmu psh -o a.fmu"]),
    "fmu's kind": ("export-fmu psh -o a.fmu --kind me", "one of co-simulation, model-exchange",
                   ["export-fmu psh -o a.fmu --kind model-exchange"]),
    "stiff fmu": (f"export-fmu {TINY} -o b.fmu",
                  "write --kind model-exchange, give speck more inertia or softer springs, or lower simulation.t_end",
                  [f"export-fmu {TINY} -o b.fmu --kind model-exchange",
                   f"export-fmu {TINY} -o b.fmu --set 'rotors.speck.inertia=1 kg*m^2'",
                   f"export-fmu {TINY} -o b.fmu --set 'simulation.t_end=1 ms'"]),
}  # fmt: skip
COMMANDS = LINEAR | OUTPUTS | RESULTS | OTHERS


@pytest.mark.parametrize("name", COMMANDS)
def test_the_cure_that_a_command_names_works(run, folder, monkeypatch, name):
    monkeypatch.chdir(folder)
    if "fmu" in name:
        monkeypatch.setattr(package, "compile_fmu", lambda *given: b"")  # which takes seconds
    monkeypatch.setattr(phases, "measure_phases", lambda *given: [])  # which starts programs
    command, told, cures = COMMANDS[name]
    code, out, err = run(*shlex.split(command))
    assert code in (2, 3), out
    found = re.search(told, err) if "(" in told else None
    assert found or told in err, err
    for cure in cures:
        for line in cure.format(*found.groups() if found else ()).split(" && "):
            code, _, err = run(*shlex.split(line))
            assert code == 0, (line, err)


def test_a_chart_of_too_many_points_is_drawn_with_fewer(run, folder, monkeypatch):
    monkeypatch.chdir(folder)
    monkeypatch.setattr(chart, "MOST_STEPS", 400)
    for options, others in (((), ("--mesh", "a")), (("--mesh", "a"), ())):
        command = ("stability", "train.toml", *options)
        err = run(*command, "--variation", "0:2:900")[2]
        most = re.search(r"take (\d+) points at most", err)[1]
        assert run(*command, "--variation", f"0:2:{most}")[0] == 0
        assert ("vary fewer meshes, --mesh a" in err) == bool(others)
        if others:
            fewer = run(*command, *others, "--variation", "0:2:900")[2]
            assert int(re.search(r"take (\d+) points at most", fewer)[1]) > int(most)


def test_tables_and_inputs_of_an_fmu_are_given_as_told(folder, monkeypatch):
    monkeypatch.setattr(package, "compile_fmu", lambda *given: b"")
    psh = open_scene("psh", steered=True)
    library, values = compile_model(psh), psh.model.values()

    def written(**options):
        options = {"name": "psh", "title": "psh", "tables": psh.model.tables, "t_end": 0.01, "rate": 8192.0} | options
        return write_fmu(library, values, folder / "values.fmu", **options)

    with pytest.raises(LtcgearError, match=r"give the model's tables \(model.tables\)"):
        written(tables=None)
    with pytest.raises(LtcgearError, match="it has ") as caught:
        written(inputs=["zzz"])
    inputs = str(caught.value).split("it has ")[1].split(", ")
    assert len(written(inputs=inputs)["inputs"]) == len(inputs) > 0


def test_a_sweep_is_read_as_told(folder):
    with pytest.raises(LtcgearError, match=r"ltcgear\.runtime\.load_sweep reads it"):
        load(folder / "sweep.nc")
    assert load_sweep(folder / "sweep.nc").sizes
