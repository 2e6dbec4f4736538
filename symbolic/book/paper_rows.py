"""Rows of the paper: printed equations in their own letters, with the derived ones."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import sympy as sp

from ..checks.paper import Verdict, judge_row
from ..wu2021 import RIGHT, ROWS, Row
from .notation import Printer, escape, fill_lines, put_signs

GREEK = ("alpha", "beta", "gamma", "delta", "epsilon", "theta", "mu", "xi", "phi")
PREFIXES = {
    "Delta_gamma": r"\Delta\gamma", "Delta_theta": r"\Delta\theta", "delta_theta": r"\delta_{\theta}",
    "delta_t": r"\delta_{t}", "rolling": r"\text{rolling}", "coordinates": r"\text{coordinates}",
}  # fmt: skip


@dataclass(frozen=True)
class PrintedRow:
    """One row of the paper: its verdict, and its TeX lines as printed and as derived."""

    verdict: Verdict
    printed: tuple[str, ...]
    derived: tuple[str, ...]


class PaperPrinter(Printer):
    """TeX printer in the paper's letters, with terms in printed order."""

    def __init__(self) -> None:
        super().__init__(order="none")

    def _print_Symbol(self, expr: sp.Symbol, style: str = "plain") -> str:  # noqa: N802
        """Print a symbol of the paper."""
        return write_paper_name(expr.name)


def write_paper_name(name: str) -> str:
    """Return the TeX of a symbol of ``paper``: a prime is a time derivative, ``_PS0`` an index.

    Sums of angles and sgn() are one symbol there, so that they stay as printed.
    """
    if name.startswith("<"):
        return rf"\left\langle\text{{{escape(name.strip('<>'))}}}\right\rangle"
    if name.startswith("sgn("):
        return rf"\operatorname{{sgn}}\left({write_paper_name(name[4:-1])}\right)"
    if " " in name:
        return re.sub(r"[^ +-]+", lambda found: write_paper_name(found[0]), name)
    plain = name.rstrip("'")
    dots = {0: "{}", 1: r"\dot{{{}}}", 2: r"\ddot{{{}}}"}[len(name) - len(plain)]
    prefix = next((key for key in PREFIXES if plain.startswith(key + "_")), plain.partition("_")[0])
    stem, rest = PREFIXES.get(prefix, prefix), plain[len(prefix) :].lstrip("_")
    stem = rf"\{stem}" if stem in GREEK else stem
    stem, _, low = stem.partition("_")
    indices = [part for part in (low.strip("{}"), rf"\text{{{rest}}}" if rest else "") if part]
    return dots.format(stem) + (f"_{{{','.join(indices)}}}" if indices else "")


def print_terms(row: Row, terms: Mapping[str, sp.Expr]) -> tuple[str, ...]:
    """Return term groups as lines of one equation, in order."""
    printer = PaperPrinter()
    if row.definition:
        return fill_lines([f"{write_paper_name(row.label)} =", *put_signs([_part(printer, t) for t in terms.values()])])
    left = [_part(printer, term) for group, term in terms.items() if group not in RIGHT]
    right = [_part(printer, -term) for group, term in terms.items() if group in RIGHT]
    pieces = [*put_signs(left)] + [f"{'=' if i == 0 else ''} {piece}" for i, piece in enumerate(put_signs(right))]
    return fill_lines(pieces)


def _part(printer: PaperPrinter, term: sp.Expr) -> str:
    """Return the TeX of one term group."""
    return str(printer.doprint(term))


@cache
def print_rows() -> tuple[PrintedRow, ...]:
    """Return all rows of the paper with their verdicts."""
    rows = []
    for row in ROWS:
        verdict, derived = judge_row(row)
        rows.append(PrintedRow(verdict, print_terms(row, row.terms), print_terms(row, derived)))
    return tuple(rows)
