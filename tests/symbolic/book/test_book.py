"""The equation book says what the C computes: its printed expressions, evaluated one by one."""

import json
import re

import casadi as ca
import numpy as np
import pytest
import sympy as sp
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.book.chapter_balances import write_balances
from ltcgear.symbolic.book.chapter_elements import _grouped, write_elements, write_meshes
from ltcgear.symbolic.book.chapter_laws import write_laws
from ltcgear.symbolic.book.chapter_motion import write_motion
from ltcgear.symbolic.book.content import Chapter, Grid
from ltcgear.symbolic.book.folding import NamedStep, fold, unfold
from ltcgear.symbolic.book.laws import write_law
from ltcgear.symbolic.book.letters import LETTERS
from ltcgear.symbolic.book.model_equations import assemble, list_terms
from ltcgear.symbolic.book.notation import break_sum, typeset, write_name
from ltcgear.symbolic.book.paper_rows import PaperPrinter, print_rows, write_paper_name
from ltcgear.symbolic.book.waves import COS, COUNT, LEVEL, SIN, TAU, WAVES, Rise
from ltcgear.symbolic.checks.agree import random_points
from ltcgear.symbolic.checks.paper import check_paper
from ltcgear.symbolic.emit.c_text import functions
from ltcgear.symbolic.mechanics.equations import derive
from ltcgear.symbolic.mechanics.profiles import evaluate as evaluate_profile
from ltcgear.symbolic.scene.load import load_scene, make_scene, shipped_scenes
from ltcgear.symbolic.wu2021 import ROWS

from ...runtime.everything import covering, everything, labelled
from ...runtime.models import raw_scene
from ...runtime.variants import VARIANTS
from ..book_values import evaluate, rise, value

POINTS = 3
WRITERS = (write_motion, write_laws, write_elements, write_meshes, write_balances)
SCENES = ("psh", "lsp", "hsp", "rig-2mw", "lin-parker-3", "hard-friction", "start-up", "hard-bounce")
MIXED = ("all at once", "rigid pins out of place, held carrier, gravity", "torsional, all of it",
         "torque-driven on rigid pins")  # fmt: skip


def models():
    """Models of all kinds, each with a name."""
    for name in SCENES:
        yield pytest.param(lambda name=name: build_model(load_scene(name)), id=name)
    for name in MIXED:
        yield pytest.param(lambda name=name: build_model(make_scene(raw_scene("rig-2mw", *VARIANTS[name]))), id=name)
    for variant in covering():
        yield pytest.param(lambda v=variant: build_model(everything(dict(v))), id=labelled(variant))


@pytest.mark.parametrize("make", list(models()))
def test_the_printed_equations_give_the_accelerations_of_the_c(make):
    model = make()
    equations = derive(model)
    rhs, points = functions(equations)["rhs"], random_points(model, equations, 50.0)
    assembly = assemble(model)
    names = {
        "x": [state.name for state in equations.states],
        "s": [*equations.levels, *(signal.name for signal in model.signals)],
        "p": [name for name, _ in equations.parameters],
    }
    printed, emitted = [], []
    for k in range(POINTS):
        columns = {"x": points.x[:, k], "s": points.s[:, k], "p": points.p[:, k]}
        vectors = {key: dict(zip(names[key], column, strict=True)) for key, column in columns.items()}
        rates = evaluate(assembly, vectors)[1]
        printed.append([rates[state] for state in names["x"]])
        emitted.append(np.asarray(rhs(*columns.values())).ravel())
    one, two = np.array(printed).T, np.array(emitted).T
    size = np.abs(two).max(axis=1)
    assert (np.abs(one - two).max(axis=1) <= 1e-10 * np.maximum(size, 1e-6 * size.max())).all()


@pytest.mark.parametrize("make", list(models()))
def test_every_kind_of_scene_is_told_with_all_its_elements(make):
    model = make()
    chapters = [Chapter(1, "one", "one") for _ in range(5)]
    for write, chapter in zip(WRITERS, chapters, strict=True):
        write(chapter, model)
    _, laws, elements, meshes, balances = chapters
    assert sum(1 for _ in laws.headings) == 2 + len({instance.element for instance in model.instances})
    told = [row[0][0] for block in elements.blocks[:2] if isinstance(block, Grid) for row in block.rows]
    spans = [item for text in told for item in re.findall(r"\d+", text)]
    assert int(max(spans, key=int)) == len(model.instances)
    kinds = {item.kind for item in model.profiles}
    assert {heading.anchor for heading in meshes.headings} >= {f"wave-{kind}" for kind in kinds}
    sums = " ".join(line for equation in balances.equations for line in equation.lines)
    for name, terms in list_terms(model).items():
        assert write_name(f"W@{name}") in sums
        assert all(rf"\mathbf{{W}}_{{{port}}}^{{({number})}}" in sums for number, port in terms)


@pytest.mark.parametrize(
    ("name", "letters"),
    [("lin-parker-3", set()), ("psh", {r"\rho", r"\varphi"}), ("hsp", {r"\rho", r"\varphi", r"\rho_{C}", r"\beta"})],
)
def test_a_scene_is_told_without_turns_that_it_does_not_know(name, letters):
    chapters = [Chapter(1, "one", "one") for _ in range(3)]
    for write, chapter in zip((write_motion, write_laws, write_balances), chapters, strict=True):
        write(chapter, build_model(load_scene(name)))
    told = " ".join(line for chapter in chapters for equation in chapter.equations for line in equation.lines)
    found = {letter for letter in (r"\rho", r"\varphi", r"\rho_{C}", r"\beta") if letter in told}
    assert found == letters


def test_numbers_of_equal_elements_are_all_told():
    groups = list(_grouped(build_model(load_scene("rig-2mw"))))
    assert sorted(number for numbers, _ in groups for number in numbers) == list(range(1, 33))
    assert all(len(numbers) == len(group) for numbers, group in groups)
    assert len(groups) == 17  # 2 x 3 of planets, bearings of ring, sun and pair, the pair, 5 shafts, the load


def element_types():
    """All element types that shipped scenes, mixed variants of the rig, and pairs of effects call for."""
    made = [build_model(load_scene(name)) for name in shipped_scenes()]
    made += [build_model(make_scene(raw_scene("rig-2mw", *VARIANTS[name]))) for name in VARIANTS]
    made += [build_model(everything(dict(variant))) for variant in covering()]
    return list(dict.fromkeys(instance.element for model in made for instance in model.instances))


TYPES = element_types()


@pytest.mark.parametrize("key", TYPES, ids=str)
def test_named_quantities_change_nothing(key):
    law = write_law(key)
    element = law.element
    reports = [output.expression for output in element.outputs.values()]
    raw = [element.potential, element.dissipation, *element.loads, *reports]
    rng = np.random.default_rng(7)
    known = {symbol: rng.uniform(0.1, 0.2) for symbol in element.arguments}
    given = {"x_2": 3.1, "d_0": 3.0, "r_1": 1.1, "e_x": 0.6, "e_y": 0.8, "s": -1.0}
    known |= {symbol: given[symbol.name] for symbol in element.arguments if symbol.name in given}
    for step in law.steps:
        known[step.symbol] = value(step.value, known)
    for plain, short, back in zip(raw, law.folded.expressions, unfold(law.folded), strict=True):
        expected = value(plain, known)
        assert value(short, known) == pytest.approx(expected, rel=1e-11, abs=1e-14)
        assert value(back, known) == pytest.approx(expected, rel=1e-11, abs=1e-14)
    for energy, hand in zip(law.gradient, element.loads, strict=True):
        if energy is not None:
            assert value(energy, known) == pytest.approx(value(hand, known), rel=1e-9, abs=1e-11)


@pytest.mark.parametrize("key", TYPES, ids=str)
def test_every_symbol_of_a_law_has_a_letter_of_its_own(key):
    law = write_law(key)
    written = [typeset(symbol, law.letters) for symbol in law.symbols]
    assert len(set(written)) == len(written)
    assert all(law.letters[symbol.name][1] for symbol in law.symbols)
    parts = (*law.folded.expressions, *(step.value for step in law.steps))
    assert max(sp.count_ops(part) for part in parts) <= 40


def test_a_symbol_without_a_letter_is_an_error():
    with pytest.raises(KeyError, match="nobody"):
        typeset(sp.Symbol("nobody"))


@pytest.mark.parametrize("name", ["psh", "hard-in-phase", "hard-dead-band"])
def test_no_two_symbols_of_a_scene_written_out_look_alike(name):
    assembly = assemble(build_model(load_scene(name)))
    symbols = [*(item.symbol for item in assembly.assignments), *assembly.leaves]
    written = [typeset(symbol) for symbol in symbols]
    assert len(set(written)) == len(written)


def test_folding_keeps_what_it_does_not_know():
    a, b, c, d = sp.symbols("a b c d", positive=True)
    folded = fold([(a + b) * c, -a - b + c, sp.sin(a * b * c)], [NamedStep(d, a + b)])
    assert folded.expressions == (c * d, c - d, sp.sin(a * b * c))
    assert unfold(folded) == ((a + b) * c, c - a - b, sp.sin(a * b * c))
    assert fold([a], [NamedStep(d, a + b)]).steps == ()


@pytest.mark.parametrize(("kind", "count"), [("smooth", 4), ("series", 7), ("arcs", 7), ("tooth", 4), ("constant", 1)])
def test_printed_profiles_are_those_of_the_c(kind, count):
    rng, wave = np.random.default_rng(3), WAVES[kind]
    symbols = wave.numbers(count)
    assert len(symbols) == count
    for _ in range(20):
        numbers = list(rng.uniform(0.2, 0.6, count))
        if kind == "tooth":
            numbers[1:3] = float(rng.integers(0, 17)), 17.0
        tau, level = rng.uniform(-20.0, 20.0), float(rng.integers(0, 2))
        known = {**dict(zip(symbols, numbers, strict=True)), TAU: tau, LEVEL: level, COUNT: (count - 1) // 2}
        formula = wave.formula.xreplace({COUNT: sp.Integer((count - 1) // 2)})
        inputs = [ca.DM(number) for number in (tau, level, 1.0)]
        expected, slope = evaluate_profile(kind, *inputs, [ca.DM(number) for number in numbers])
        assert value(formula, known) == pytest.approx(float(expected), rel=1e-12, abs=1e-14)
        if kind != "arcs":
            assert value(sp.diff(formula, TAU), known) == pytest.approx(float(slope), rel=1e-9, abs=1e-12)


def test_the_printed_integral_is_the_smooth_rise():
    z = sp.Symbol("z", real=True)
    for at in (-0.3, 0.0, 0.2, 0.5, 0.9, 1.0, 1.4):
        assert float(Rise.definition(z).subs(z, at).doit()) == pytest.approx(rise(at), abs=1e-14)
    assert (rise(0), rise(0.5), rise(1)) == pytest.approx((0, 0.5, 1), abs=1e-14)


def test_symbols_of_the_paper_have_letters_of_their_own():
    names = {symbol.name for row in ROWS for term in row.terms.values() for symbol in term.free_symbols}
    written = {write_paper_name(name) for name in names}
    assert len(written) == len(names)
    assert write_paper_name("x_S''") == r"\ddot{x}_{\text{S}}"
    assert write_paper_name("Delta_gamma_PS") == r"\Delta\gamma_{\text{PS}}"
    assert PaperPrinter().doprint(sp.Symbol("r_Sb") ** 2) == r"r_{\text{Sb}}^{2}"


def test_rows_of_the_paper_are_those_of_the_check():
    rows, verdicts = print_rows(), check_paper()
    assert [row.verdict for row in rows] == list(verdicts)
    for row in rows:
        assert (row.printed == row.derived) == (row.verdict.printed == row.verdict.derived)


def test_what_the_paper_prints_on_the_right_stays_there():
    rows = {(row.verdict.equation, row.verdict.row): " ".join(row.printed) for row in print_rows()}
    left, right = rows[31, "y_S"].split("=")
    assert right.split() == [r"F_{\text{Sy}}", "+", r"G_{\text{S}}"]
    assert left.count("-") == 2
    assert rows[29, "delta_CPx"].startswith(r"\delta_{\text{CPx}} = x_{\text{P}} - x_{\text{C}} - R_{\text{P}}")
    assert rows[38, "theta_C"].endswith(r"= T_{\text{C}}")


def test_long_sums_are_broken_before_their_signs():
    x = sp.Symbol("x", real=True)
    total = sum((-1) ** n * sp.sin(n * x) for n in range(1, 30))
    lines = break_sum("F", total)
    assert len(lines) == 3
    assert lines[0].startswith("F =")
    assert all(line[0] in "+-" for line in lines[1:])
    assert json.dumps(lines).count("sin") == 29


def test_the_table_of_letters_tells_meanings():
    assert all(tex and meaning for tex, meaning in LETTERS.values())
    assert set(COS.free_symbols | SIN.free_symbols) == {sp.Symbol("a"), sp.Symbol("b")}
