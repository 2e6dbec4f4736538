r"""Notation of the book: SymPy expressions as TeX, in the letters of one table, with long sums broken into lines.

A symbol's name may carry a tag: ``x@lsp.sun`` is the x of a body, ``k#3`` the k of element 3; they are written
:math:`x_\text{lsp.sun}` and :math:`k^{(3)}`.
"""

import re
from collections.abc import Mapping, Sequence
from typing import Any

import sympy as sp
from sympy.printing.latex import LatexPrinter

from .letters import LETTERS, ORDER, Letter

WIDTH = 74
"""Visible characters in a line before a sum is broken."""
RANKED = "|"


class Printer(LatexPrinter):  # type: ignore[misc]  # SymPy is untyped
    """TeX printer; a symbol without a letter is an error, so that no program name is printed."""

    def __init__(self, letters: Mapping[str, Letter] = LETTERS, order: str | None = None) -> None:
        super().__init__({"order": order, "mul_symbol": r"\,", "parenthesize_super": True, "ln_notation": True})
        self.letters = letters

    def _print_Symbol(self, expr: sp.Symbol, style: str = "plain") -> str:  # noqa: N802
        """Print a symbol by its letter, tags included."""
        return write_name(expr.name.partition(RANKED)[2] or expr.name, self.letters)

    def _print_Add(self, expr: sp.Expr, order: str | None = None) -> str:  # noqa: N802
        """Print a sum, positive terms first; unsorted if no order is wanted."""
        terms = [str(self._print(term)) for term in self._as_ordered_terms(expr, order=order)]
        if self._settings["order"] != "none":
            terms.sort(key=lambda term: term.startswith("-"))
        signed = (f" - {t[1:].lstrip()}" if t.startswith("-") else f" + {t}" for t in terms)
        return "".join(signed).removeprefix(" + ").lstrip()

    def _print_Indexed(self, expr: sp.Indexed) -> str:  # noqa: N802
        """Print an amplitude with its order."""
        return f"{write_name(str(expr.base), self.letters)}_{{{self._print(expr.indices[0])}}}"

    def _print_Given(self, expr: sp.Expr) -> str:  # noqa: N802
        """Print a quantity as a function of its own angle."""
        z, value, _ = expr.args
        return f"{self._print(value)}{self._bracket(z)}"

    def _print_LogCosh(self, expr: sp.Expr, exp: str | None = None) -> str:  # noqa: N802
        """Print ln cosh."""
        return self._raised(rf"\ln\cosh{self._bracket(expr.args[0])}", exp)

    def _print_Switch(self, expr: sp.Expr, exp: str | None = None) -> str:  # noqa: N802
        """Print a contact state, H being 1 for a positive argument and 0 otherwise."""
        return self._raised(rf"\operatorname{{H}}{self._bracket(sp.Add(*expr.args, evaluate=False))}", exp)

    def _print_Step(self, expr: sp.Expr, exp: str | None = None) -> str:  # noqa: N802
        """Print the unit step."""
        return self._raised(rf"\operatorname{{H}}{self._bracket(expr.args[0])}", exp)

    def _print_Rest(self, expr: sp.Expr, exp: str | None = None) -> str:  # noqa: N802
        """Print contact without force."""
        border = sp.Add(*expr.args[:2], evaluate=False)
        touching, pushing = (rf"\operatorname{{H}}{self._bracket(z)}" for z in (expr.args[2], border))
        return self._raised(rf"{touching}\left[1 - {pushing}\right]", exp)

    def _print_Lesser(self, expr: sp.Expr) -> str:  # noqa: N802
        """Print the smaller of two."""
        return rf"\min\left({self._print(expr.args[0])},\, {self._print(expr.args[1])}\right)"

    def _print_Wrapped(self, expr: sp.Expr, exp: str | None = None) -> str:  # noqa: N802
        """Print a phase less its nearest whole number."""
        return self._raised(rf"\operatorname{{wrap}}{self._bracket(expr.args[0])}", exp)

    _print_Wrap = _print_Wrapped  # noqa: N815

    def _print_Rise(self, expr: sp.Expr, exp: str | None = None) -> str:  # noqa: N802
        """Print the smooth rise from 0 to 1."""
        return self._raised(rf"\operatorname{{R}}{self._bracket(expr.args[0])}", exp)

    def _print_Sharing(self, expr: sp.Expr) -> str:  # noqa: N802
        """Print the load sharing."""
        return rf"\operatorname{{W}}\left({self._print(expr.args[0])},\, {self._print(expr.args[1])}\right)"

    def _print_atan2(self, expr: sp.Expr) -> str:
        """Print the angle of a vector, y before x."""
        return rf"\operatorname{{atan}}_{{2}}\left({self._print(expr.args[0])},\, {self._print(expr.args[1])}\right)"

    def _print_atan(self, expr: sp.Expr, exp: str | None = None) -> str:
        """Print the arc tangent."""
        return self._raised(rf"\arctan{self._bracket(expr.args[0])}", exp)

    def _print_acos(self, expr: sp.Expr, exp: str | None = None) -> str:
        """Print the arc cosine."""
        return self._raised(rf"\arccos{self._bracket(expr.args[0])}", exp)

    def _print_sign(self, expr: sp.Expr, exp: str | None = None) -> str:
        """Print the sign."""
        return self._raised(rf"\operatorname{{sgn}}{self._bracket(expr.args[0])}", exp)

    def _bracket(self, expr: sp.Expr) -> str:
        """Print an argument in brackets."""
        return rf"\left({self._print(expr)}\right)"

    @staticmethod
    def _raised(text: str, exp: str | None) -> str:
        """Print a power of a function."""
        return text if exp is None else rf"\left[{text}\right]^{{{exp}}}"


def write_name(name: str, letters: Mapping[str, Letter] = LETTERS) -> str:
    """Return the TeX of a symbol's name.

    Raises
    ------
    KeyError
        If the table has no letter for it.
    """
    base, mark, tag = re.fullmatch(r"([^@#]+)([@#]?)(.*)", name, re.DOTALL).groups()  # type: ignore[union-attr]
    tex = letters[base][0]
    if mark == "#":
        return f"{tex}^{{({tag})}}"
    return tex if not mark else add_subscript(tex, rf"\text{{{escape(tag)}}}")


def add_subscript(tex: str, more: str) -> str:
    """Add to a symbol's subscript."""
    stem, low, rest = tex.partition("_")
    if not low:
        return f"{tex}_{{{more}}}"
    inside = rest[1:-1] if rest.startswith("{") else rest
    return f"{stem}_{{{inside},\\,{more}}}"


SPECIAL = {
    "\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "$": r"\$", "&": r"\&", "#": r"\#", "_": r"\_", "%": r"\%",
    "~": r"\textasciitilde{}", "^": r"\textasciicircum{}",
}  # fmt: skip


def escape(text: str) -> str:
    """Return plain text escaped for TeX."""
    return "".join(SPECIAL.get(character, character) for character in text)


def typeset(expression: Any, letters: Mapping[str, Letter] = LETTERS) -> str:  # noqa: ANN401
    """Return the TeX of an expression."""
    return str(Printer(letters).doprint(_ranked(sp.sympify(expression))))


def _ranked(expression: Any) -> Any:  # noqa: ANN401
    """Rename symbols so that SymPy sorts parameters before variables in a product."""
    amplitudes = expression.atoms(sp.Indexed)
    plain = expression.free_symbols - amplitudes - {item.base.label for item in amplitudes}
    names = {symbol: sp.Symbol(f"{_rank(symbol.name)}{RANKED}{symbol.name}", **symbol.assumptions0) for symbol in plain}
    return expression.xreplace(names)


def _rank(name: str) -> int:
    """Return the rank of a symbol in a product."""
    return next((i for i, group in enumerate(ORDER) if re.split("[@#]", name)[0] in group), len(ORDER))


def break_sum(left: str, expression: Any, letters: Mapping[str, Letter] = LETTERS) -> tuple[str, ...]:  # noqa: ANN401
    """Return the TeX lines of ``left = expression``, with a long sum broken before its signs.

    Parameters
    ----------
    left
        TeX of the left side.
    expression
        The right side.
    letters
        Table of letters.
    """
    whole = sp.sympify(expression)
    ordered = _ranked(whole).as_ordered_terms() if whole.is_Add else [_ranked(whole)]
    terms = [str(Printer(letters).doprint(term)) for term in ordered]
    return fill_lines([f"{left} =", *put_signs(sorted(terms, key=lambda term: term.startswith("-")))])


def put_signs(terms: Sequence[str]) -> list[str]:
    """Return the terms of a sum with their signs, without a leading plus."""
    told = [f"- {t[1:].lstrip()}" if t.startswith("-") else f"+ {t}" for t in terms]
    return [told[0].removeprefix("+ "), *told[1:]] if told else ["0"]


def fill_lines(pieces: Sequence[str]) -> tuple[str, ...]:
    """Join pieces into lines of bounded length; the first two stay together."""
    lines, line = [], " ".join(pieces[:2])
    for piece in pieces[2:]:
        if count_visible(line) + count_visible(piece) > WIDTH:
            lines.append(line)
            line = piece
        else:
            line = f"{line} {piece}"
    return (*lines, line)


def count_visible(tex: str) -> int:
    """Estimate the number of visible characters of a TeX formula."""
    plain = re.sub(r"\\(operatorname|mathrm|text|left|right|dot|ddot|frac|sqrt|bar)\b", "", tex)
    return len(re.sub(r"\\[a-zA-Z]+", "x", plain).translate(str.maketrans("", "", "{}^_ ,\\")))
