"""Content of the book: chapters of paragraphs, equations and tables, whatever the output format."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Maths:
    """A formula within a text, in TeX."""

    tex: str


@dataclass(frozen=True)
class CrossReference:
    """A reference to another place of the book."""

    text: str
    anchor: str


@dataclass(frozen=True)
class Mark:
    """A verdict: its text and its grade, ``good``, ``fair`` or ``bad``."""

    text: str
    kind: str


Part = str | Maths | CrossReference | Mark
Text = tuple[Part, ...]


@dataclass(frozen=True)
class Paragraph:
    """A paragraph."""

    text: Text
    kind: str = "paragraph"


@dataclass(frozen=True)
class Equation:
    """A numbered equation: its number, its lines in TeX, and a remark."""

    number: str
    lines: tuple[str, ...]
    note: Text = ()
    kind: str = "equation"

    @property
    def anchor(self) -> str:
        """Return its anchor."""
        return "eq-" + self.number.replace(".", "-")


@dataclass(frozen=True)
class Grid:
    """A table."""

    head: tuple[str, ...]
    rows: tuple[tuple[Text, ...], ...]
    caption: str = ""
    kind: str = "grid"


@dataclass(frozen=True)
class Heading:
    """The head of a section within a chapter."""

    title: str
    anchor: str
    kind: str = "heading"


Block = Paragraph | Equation | Grid | Heading


@dataclass
class Chapter:
    """A chapter during writing: blocks in order, equations numbered."""

    number: int
    title: str
    anchor: str
    blocks: list[Block] = field(default_factory=list)

    def say(self, *parts: Part) -> None:
        """Add a paragraph."""
        self.blocks.append(Paragraph(parts))

    def head(self, title: str, anchor: str) -> None:
        """Begin a section."""
        self.blocks.append(Heading(title, anchor))

    def equate(self, lines: Sequence[str], *note: Part) -> Equation:
        """Add a numbered equation."""
        equation = Equation(f"{self.number}.{len(self.equations) + 1}", tuple(lines), note)
        self.blocks.append(equation)
        return equation

    def tabulate(self, head: Sequence[str], rows: Sequence[Sequence[Part | Text]], caption: str = "") -> None:
        """Add a table; nothing if it has no rows."""
        if rows:
            told = tuple(tuple(cell if isinstance(cell, tuple) else (cell,) for cell in row) for row in rows)
            self.blocks.append(Grid(tuple(head), told, caption))

    @property
    def equations(self) -> list[Equation]:
        """Return the equations, in order."""
        return [block for block in self.blocks if isinstance(block, Equation)]

    @property
    def headings(self) -> Iterator[Heading]:
        """Return the heads of the sections."""
        return (block for block in self.blocks if isinstance(block, Heading))


@dataclass(frozen=True)
class Book:
    """A whole book.

    Attributes
    ----------
    title, scene
        The scene's title and name.
    effects
        Effect -> value, of active effects.
    chapters
        Its content.
    identity
        Identity of its C: key, versions, counts of operations.
    checks, paper
        Numbers of passed and failed checks; numbers of the paper's printed equations by verdict.
    """

    title: str
    scene: str
    effects: dict[str, str]
    chapters: tuple[Chapter, ...]
    identity: dict[str, str]
    checks: dict[str, int]
    paper: dict[str, int]
