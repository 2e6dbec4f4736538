"""The printed equations against the derivation: verdicts are computed, and the derivation is sound."""

from collections import Counter

import numpy as np
import pytest
import sympy as sp
from ltcgear.symbolic.checks import paper as check
from ltcgear.symbolic.checks import paper_grades as grades
from ltcgear.symbolic.checks.paper_derived import benches
from ltcgear.symbolic.checks.paper_states import STATES
from ltcgear.symbolic.wu2021 import EXACT, ROWS, Row, evaluate, exchange
from ltcgear.symbolic.wu2021 import printed_letters as paper

VERDICTS = {(v.equation, v.row): v for v in check.check_paper()}
BY_KEY = {(row.equation, row.label): row for row in ROWS}
AGREE = [key for key, v in VERDICTS.items() if v.verdict != "misprint"]
MISPRINTED = [key for key, v in VERDICTS.items() if v.verdict == "misprint"]
BENCH = benches(1, 1)[0]


def verdict_of(row: Row) -> str:
    return check.check_paper([row])[0].verdict


def repaired(row: Row) -> Row:
    where = grades.bench_for(row)
    for group, expression in row.terms.items():
        if grades.grade(row, group, expression, where) == "misprint":
            found = grades.repair(row, group, where)
            assert found is not None, (row.equation, row.label, group)
            row = row.with_term(group, found[0])
    extra = grades.left_out(row, where)
    for group, expression in extra.items():
        row = row.with_term(group, bearing_torque(row.label) if "bearing" in group else by_name(expression))
    return row


def by_name(expression: sp.Expr) -> sp.Expr:
    return expression.xreplace({s: sp.Symbol(s.name, real=True) for s in expression.free_symbols})


def bearing_torque(label: str) -> sp.Expr:
    """Coulomb part of eq 30, left of the equals sign: it opposes the planet's turning on its pin."""
    mu, d = sp.symbols("mu_CPB d_CPB", real=True)
    load = paper.k_CPB * sp.sqrt(paper.u_x**2 + paper.u_y**2)
    side = 1 if label == "theta_P" else -1
    return side * mu * load * d / 2 * sp.sign(paper.om_P - paper.om_C)


def test_every_row_is_judged_and_every_verdict_occurs() -> None:
    assert len(VERDICTS) == len(ROWS) == 59
    assert {equation for equation, _ in VERDICTS} == set(range(1, 39))
    assert Counter(v.verdict for v in VERDICTS.values()) == {"agrees": 29, "first-order": 10, "misprint": 20}
    balances = {key for key in VERDICTS if key[0] >= 31}
    assert balances & set(AGREE) == {(e, r) for e, b in ((31, "S"), (33, "R")) for r in _labels(b)} | {(38, "x_C")}


def _labels(body: str) -> tuple[str, ...]:
    return tuple(f"{c}_{body}" for c in ("x", "y", "theta"))


def test_reasons_are_given_exactly_where_something_differs() -> None:
    for verdict in VERDICTS.values():
        assert bool(verdict.why) == (verdict.verdict != "agrees")
        assert "no simple repair" not in verdict.why
        assert (verdict.printed == verdict.derived) == (verdict.verdict == "agrees")


@pytest.mark.parametrize("key", AGREE, ids=str)
def test_corrupting_any_group_of_a_right_row_is_noticed(key: tuple[int, str]) -> None:
    row = BY_KEY[key]
    for group, term in row.terms.items():
        bad = check.check_paper([row.with_term(group, -term)])[0]
        assert bad.verdict == "misprint"
        assert bad.why.startswith(f"{group}: prints ") or f"; {group}: prints " in bad.why
        assert verdict_of(row.with_term(group, sp.Rational(1001, 1000) * term)) == "misprint"


@pytest.mark.parametrize("key", MISPRINTED, ids=str)
def test_repairing_a_misprinted_row_clears_it_and_undoing_any_part_condemns_it(key: tuple[int, str]) -> None:
    row = BY_KEY[key]
    good = repaired(row)
    assert verdict_of(good) in ("agrees", "first-order")
    changed = [group for group in row.terms if row.terms[group] != good.terms[group]]
    for group in changed:
        assert verdict_of(good.with_term(group, row.terms[group])) == "misprint"
    for group in set(good.terms) - set(row.terms):
        assert verdict_of(good.with_term(group, sp.S.Zero)) == "misprint"


def test_rows_repaired_by_hand_are_right() -> None:
    p = paper
    decay = p.c_PS * p.d_PS0 * (p.r_Sb + p.r_Pb) / p.low_PS**2 * p.v_PS
    sun_x = BY_KEY[32, "x_S"].with_term(p.NORMAL_S, -p.N_PS * sp.sin(p.gma_S))
    assert verdict_of(sun_x) == "misprint"
    assert verdict_of(sun_x.with_term(p.VISCOUS_S, -decay * sp.cos(p.gma_S))) == "first-order"
    exact = p.c_PS * p.v_PS * sp.cos(p.a_PS)
    assert verdict_of(sun_x.with_term(p.VISCOUS_S, -exact * sp.cos(p.gma_S))) == "agrees"
    a, b = p.x_P - p.x_C, p.y_P - p.y_C
    carrier = BY_KEY[38, "theta_C"].with_term("pin", p.k_CPB * (p.u_x * b - p.u_y * a))
    carrier = carrier.with_term("damping", p.c_PB * (p.om_C - p.om_P))
    assert verdict_of(carrier.with_term("bearing Coulomb friction", bearing_torque("theta_C"))) == "agrees"


@pytest.mark.parametrize(
    ("key", "group", "slip", "reads"),
    [
        ((38, "x_C"), "pin", lambda p: -p.k_CPB * (p.x_P - p.x_C - p.R_P * sp.sin(p.pin)), "sin for cos"),
        ((31, "theta_S"), "damping", lambda p: p.c_SB * p.om_R, "theta_R' for theta_S'"),
        ((31, "x_S"), "bearing", lambda p: p.k_RB * p.x_S, "k_RB for k_SB"),
        ((31, "y_S"), "weight", lambda p: -p.G_C, "G_C for G_S"),
        ((13, "N_SPy"), paper.NORMAL_S, lambda p: p.N_PS * sp.cos(p.gpa_S), "gamma_SP + alpha_SP for"),
        ((31, "x_S"), "inertia", lambda p: p.M_S * p.ax_S / 3, "no simple repair; printed / derived"),
    ],
    ids=lambda value: "slip" if callable(value) else str(value),
)
def test_a_planted_slip_is_named(key, group, slip, reads) -> None:
    verdict = check.check_paper([BY_KEY[key].with_term(group, slip(paper))])[0]
    assert verdict.verdict == "misprint"
    assert f"{group}: " in verdict.why
    assert reads in verdict.why


def test_a_printed_term_without_counterpart_is_a_misprint() -> None:
    verdict = check.check_paper([BY_KEY[38, "x_C"].with_term("weight", -paper.G_C)])[0]
    assert verdict.verdict == "misprint"
    assert "the derivation has none" in verdict.why


@pytest.mark.parametrize("b", ["S", "R"])
def test_explicit_rows_assume_approaching_centres(b: str) -> None:
    assert grades.direction(b) == 1


def test_planet_in_steady_state_without_friction_carries_equal_normal_forces() -> None:
    v, row = BENCH.values, BENCH.rows["theta_P"]
    np.testing.assert_allclose(row[paper.NORMAL_S], v["N_PS"] * v["r_Pb"], rtol=1e-10)
    np.testing.assert_allclose(row[paper.NORMAL_R], -v["N_PR"] * v["r_Pb"], rtol=1e-10)
    assert np.all(v["N_PS"] > 0)
    assert np.all(v["N_PR"] > 0)


@pytest.mark.parametrize(
    ("group", "bodies"),
    [(f"{kind} {b}-P", f"{b}P") for kind in ("normal force", "Coulomb friction", "viscous friction") for b in "SR"]
    + [("pin", "CP")],
)
def test_interactions_obey_action_and_reaction(group: str, bodies: str) -> None:
    v, rows = BENCH.values, BENCH.rows
    zero = np.zeros(STATES)
    force = {(c, b): -rows[f"{c}_{b}"].get(group, zero) for c in ("x", "y", "theta") for b in bodies}
    moment = sum(force["theta", b] + v[f"x_{b}"] * force["y", b] - v[f"y_{b}"] * force["x", b] for b in bodies)
    for total in (*(sum(force[c, b] for b in bodies) for c in "xy"), moment):
        np.testing.assert_allclose(total, 0.0, atol=1e-9)


def test_friction_takes_energy_and_the_printed_viscous_law_gives_it_when_centres_part() -> None:
    for way in (1, -1):
        bench = benches(way, way)[0]
        v = bench.values
        for b in "SR":
            for kind in ("Coulomb", "viscous"):
                power = -sum(
                    bench.rows[f"{c}_{body}"][f"{kind} friction {b}-P"] * v[f"{c}_{body}'"]
                    for c in ("x", "y", "theta")
                    for body in (b, "P")
                )
                assert np.all(power < 0)
        printed = evaluate(BY_KEY[14, "f_SP"].terms[paper.VISCOUS_S], v)
        # The force acts on the planet along eq 15; its rate along that line is d' cos(alpha).
        power = printed * v["d_PS'"] * np.cos(v["alpha_PS"])
        assert np.all(power < 0 if way == 1 else power > 0)


def test_no_verdict_hangs_on_a_dot_or_a_square_lost_in_reading_the_page() -> None:
    p = paper
    kind = {"x": {p.low_PS: p.low_PS**2, p.low_PR: p.low_PR**2, p.d_PS: p.d_PS0, p.d_PR: p.d_PR0}}
    kind |= {"y": kind["x"], "theta": {p.d_PS: p.v_PS, p.d_PR: p.v_PR}}
    for row in (row for row in ROWS if row.equation in (32, 34, 35, 36, 37)):
        for group in (g for g in row.terms if g.startswith("viscous")):
            row = row.with_term(group, exchange(kind[row.label[:-2]])(row.terms[group]))
        assert verdict_of(row) == "misprint"


def test_first_order_rows_are_set_beside_the_exact_law() -> None:
    verdicts = [v for v in VERDICTS.values() if v.verdict == "first-order"]
    assert {v.equation for v in verdicts} == {5, 6, 7, 8, 12, 21, 22, 23, 24, 25}
    assert all(v.derived != v.printed for v in verdicts)
    assert all("acos" in v.derived for v in verdicts if v.equation in (6, 7, 12, 22, 23, 25))


def test_first_order_rows_agree_once_the_exact_law_is_put_in() -> None:
    for label, law in EXACT.items():
        (row,) = (row for row in ROWS if row.label == label)
        assert verdict_of(row) == "first-order"
        assert verdict_of(row.with_term("deflection", law)) == "agrees"


@pytest.mark.parametrize(
    ("key", "group", "right"),
    [
        ((2, "gamma_PS"), "angle", sp.atan2(paper.y_P - paper.y_S, paper.x_P - paper.x_S)),
        ((17, "gamma_PR"), "angle", sp.atan2(paper.y_P - paper.y_R, paper.x_P - paper.x_R)),
        ((10, "phi_i"), "phase", (paper.counter_i - 1) * paper.phi_S0),
        ((28, "beta_RPf"), "angle", paper.gamma_PR + paper.a_PR),
        ((30, "T_CPz"), paper.VISCOUS_C, -paper.c_CPB * paper.u_CP),
    ],
)
def test_laws_put_right_by_hand_agree(key, group, right) -> None:
    assert verdict_of(BY_KEY[key]) == "misprint"
    assert verdict_of(BY_KEY[key].with_term(group, right)) == "agrees"


@pytest.mark.parametrize(
    ("key", "group", "wrong"),
    [
        ((1, "coordinates"), "number", lambda e: e - 3),
        ((2, "rolling_S"), "deflection", lambda e: e.subs(paper.Z_S, -paper.Z_S)),
        ((9, "k_PS"), "stiffness", lambda e: e.subs(paper.epsilon, 3 - paper.epsilon)),
        ((10, "phi_S0"), "phase", lambda e: e.subs(paper.Z_S, paper.Z_P)),
        ((15, "beta_SPf"), "angle", lambda e: e + sp.pi),
        ((15, "beta_SPf"), "angle", lambda e: -e),
        ((21, "r_P,PR"), "length", lambda e: e.subs(paper.Z_P, -paper.Z_P)),
        ((24, "delta_t_PR"), "deflection", lambda e: -e),
    ],
)
def test_a_wrong_transcription_turns_the_verdict(key, group, wrong) -> None:
    assert verdict_of(BY_KEY[key]) != "misprint"
    assert verdict_of(BY_KEY[key].with_term(group, wrong(BY_KEY[key].terms[group]))) == "misprint"


def test_whole_turns_of_an_angle_do_not_count() -> None:
    row = BY_KEY[15, "beta_SPf"]
    assert verdict_of(row.with_term("angle", row.terms["angle"] + 4 * sp.pi)) == "agrees"


def why_of(row: Row) -> str:
    return check.check_paper([row])[0].why


@pytest.mark.parametrize(
    ("key", "told"),
    [
        ((10, "phi_i"), "eq 11 has phi_S0*(-1 + i)"),
        ((11, "k_PS,i"), "start at 0, 0.5, 1, 1.5 pitches, so that planets 3 and 4 are never in single contact"),
        ((24, "delta_t_PR"), "against eq 28: with both friction would push the sliding on"),
        ((28, "beta_RPf"), "eq 34 x_R, eq 34 y_R, eq 35 x_P, eq 36 y_P go with eq 24"),
        ((32, "x_S"), "no reaction to that of eq 35 x_P (d_PS here, d_PS0 there)"),
        ((36, "y_P"), "no reaction to that of eq 34 y_R (d_PR0 here, d_PR there, the same sign here and there)"),
        ((32, "theta_S"), "arm of friction: d_PS0 with the viscous force of eq 32 x_S, d_PS with the Coulomb force"),
        ((34, "theta_R"), "two slips cancel: r_Pb + r_Rb for r_Rb - r_Pb, Z_R + Z_P for Z_R - Z_P"),
        ((37, "theta_P"), "two slips cancel: r_Pb + r_Rb for r_Rb - r_Pb, Z_R + Z_P for Z_R - Z_P"),
    ],
)
def test_what_contradicts_or_cancels_is_told(key, told) -> None:
    assert told in VERDICTS[key].why


def test_what_is_told_goes_with_its_cause() -> None:
    p = paper
    sun_x, ring_turns = BY_KEY[32, "x_S"], BY_KEY[34, "theta_R"]
    same = sun_x.with_term(p.VISCOUS_S, sun_x.terms[p.VISCOUS_S].xreplace({p.d_PS: p.d_PS0}))
    assert "no reaction" not in why_of(same)
    half = ring_turns.with_term(p.VISCOUS_R, ring_turns.terms[p.VISCOUS_R].xreplace({p.sum_R: p.r_Rb - p.r_Pb}))
    assert "viscous friction R-P: prints Z_R + Z_P for Z_R - Z_P" in why_of(half)
    assert "cancel" not in why_of(half)
    turned = BY_KEY[24, "delta_t_PR"].with_term("deflection", -BY_KEY[24, "delta_t_PR"].terms["deflection"])
    assert "against" not in why_of(turned)
    angle = BY_KEY[28, "beta_RPf"].with_term("angle", p.gamma_PR + p.a_PR + sp.Rational(1, 10))
    assert "against" not in why_of(angle)
