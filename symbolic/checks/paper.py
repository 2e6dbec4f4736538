r"""Check of the paper: each printed equation of Wu et al. 2021 against the same row from element wrenches.

Rows are compared term group by term group at seeded random states on the printed flank (s = +1, N > 0), while the
planets roll at the pitch points: the only motion that the paper's tangent deformation (eqs 8 and 24) includes. The
explicit rows 32 and 34-37 print one of the two directions of sliding without saying which; per mesh, the direction that
agrees with more printed Coulomb terms is taken (``direction``). Friction opposes sliding. Rows 14, 15, 27 and 28
contain sgn(), or belong to rows that do, and are compared in both directions at once. Quantities defined by eqs 1 to 30
are derived from the same wrenches (from the angles at which they vanish, and their directions) and by counting teeth,
pairs in contact and degrees of freedom.

``agrees`` means equal to rounding; ``first-order``, that the relative difference vanishes with the change
of centre distance and the tooth deflection; ``misprint``, neither. A misprint is explained by the fewest
edits (a sign, an index, a radius, a sine, ...) that turn the printed group into the derived one; where rows
contradict each other, or slips cancel, ``paper_notes`` says so.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from ..wu2021 import EXACT, MEANING, ROWS, Row, text
from .paper_grades import bench_for, explain, grade, left_out
from .paper_notes import list_notes

SEVERITY = ("agrees", "first-order", "misprint")


@dataclass(frozen=True)
class Verdict:
    """Verdict on one printed row; ``printed`` and ``derived`` are plain text."""

    equation: int
    row: str
    verdict: str
    why: str
    printed: str
    derived: str


# --- random states


def check_row(row: Row) -> Verdict:
    """Compare one row with the derivation; its verdict is the worst of its groups'."""
    return judge_row(row)[0]


def judge_row(row: Row) -> tuple[Verdict, dict[str, sp.Expr]]:
    """Compare one row with the derivation; beside the verdict, return the derived term groups."""
    where = bench_for(row)
    worst, reasons, derived = "agrees", [], dict(row.terms)
    for group, expression in row.terms.items():
        verdict = grade(row, group, expression, where)
        worst = max(worst, verdict, key=SEVERITY.index)
        if verdict == "misprint":
            derived[group], why = explain(row, group, where)
            reasons.append(why)
        elif verdict == "first-order":
            reasons.append(f"{group}: right to first order in the change of centre distance and deflection")
            if row.label in EXACT and grade(row, group, EXACT[row.label], where) == "agrees":
                derived[group] = EXACT[row.label]
    for group, expression in left_out(row, where).items():
        worst = "misprint"
        derived[group] = expression
        hint = MEANING.get((group.split()[0], "left out"), "")
        reasons.append(f"{group}: left out" + f" ({hint})" * bool(hint))
    if worst != "agrees":
        reasons += list_notes(row, derived)
    defined = row.label if row.definition else ""
    told = Verdict(row.equation, row.label, worst, "; ".join(reasons), row.printed, text(derived, defined))
    return told, derived


def check_paper(rows: Sequence[Row] | None = None) -> tuple[Verdict, ...]:
    """Compare printed rows (all by default) with the derivation and explain differences."""
    return tuple(check_row(row) for row in (ROWS if rows is None else rows))
