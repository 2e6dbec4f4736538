"""Pages of the book: HTML with MathML, or LaTeX, with the same content."""

import re
from functools import cache
from html import escape as escape_html
from importlib import resources
from types import ModuleType

from ltcgear.generated.errors import LtcgearError

from .content import Book, CrossReference, Mark, Maths, Text
from .notation import escape

MISSING = "the equation book needs Jinja2 and latex2mathml: pip install 'ltcgear[report]'"
TEXT_CELL = re.compile(r"<mtext>(.*?)</mtext>", re.DOTALL)


def write_html(book: Book) -> str:
    """Return a book as one self-contained HTML page.

    Raises
    ------
    LtcgearError
        If the packages for pages are not installed.
    """
    jinja2 = require_packages()[0]
    environment = jinja2.Environment(
        autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=jinja2.StrictUndefined
    )
    environment.filters["maths"] = lambda tex, display="inline": jinja2.utils.markupsafe.Markup(mathml(tex, display))
    environment.filters["kind"] = _kind
    return str(environment.from_string(_template("book.html")).render(book=book))


def write_latex(book: Book) -> str:
    """Return a book as a LaTeX file.

    Raises
    ------
    LtcgearError
        If the packages for pages are not installed.
    """
    jinja2 = require_packages()[0]
    environment = jinja2.Environment(
        block_start_string="<%", block_end_string="%>", variable_start_string="<<", variable_end_string=">>",
        comment_start_string="<#", comment_end_string="#>", trim_blocks=True, lstrip_blocks=True,
        undefined=jinja2.StrictUndefined, autoescape=False,
    )  # fmt: skip
    environment.filters |= {"tex": escape, "cell": tex_text, "kind": _kind}
    return str(environment.from_string(_template("book.tex")).render(book=book))


def require_packages() -> tuple[ModuleType, ModuleType]:
    """Return Jinja2 and latex2mathml's converter.

    Raises
    ------
    LtcgearError
        If one of them is not installed.
    """
    try:
        import jinja2
        from latex2mathml import converter
    except ImportError as error:
        raise LtcgearError(MISSING) from error
    return jinja2, converter


def _template(name: str) -> str:
    """Read a template."""
    return (resources.files(__package__) / "templates" / name).read_text("utf-8")


def _kind(part: object) -> str:
    """Return the kind of a part of a text: text, maths, link or mark."""
    return {Maths: "maths", CrossReference: "link", Mark: "mark"}.get(type(part), "text")


@cache
def mathml(tex: str, display: str = "inline") -> str:
    """Return the MathML of a formula in TeX.

    Parameters
    ----------
    tex
        The formula; special characters of text in it are escaped.
    display
        ``inline`` or ``block``.
    """
    made = (
        require_packages()[1].convert(tex, display=display).replace(' xmlns="http://www.w3.org/1998/Math/MathML"', "")
    )
    return TEXT_CELL.sub(lambda found: f"<mtext>{_plain(found[1])}</mtext>", made)


def _plain(text: str) -> str:
    """Return a text in a formula escaped for HTML."""
    return escape_html(re.sub(r"\\([_&%#${}])", r"\1", text).replace("&#x000A0;", "\u00a0"))


def tex_text(text: Text) -> str:
    """Return a text escaped for TeX; dotted names may be broken over lines."""
    return "".join(f"${part.tex}$" if isinstance(part, Maths) else _breakable(_words(part)) for part in text)


def _breakable(text: str) -> str:
    """Allow line breaks after dots and underscores of names."""
    return re.sub(r"(\_|\.(?=[a-z]))", r"\1\\allowbreak{}", escape(text))


def _words(part: str | CrossReference | Mark) -> str:
    """Return the words of a part."""
    return part if isinstance(part, str) else part.text
