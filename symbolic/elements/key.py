"""Key of an element type: which law, with which options, between bodies that move along which axes.

Nothing here needs SymPy: a model is put together from keys, and laws are written only where C is to be derived.
"""

import re
from dataclasses import dataclass

Option = str | bool


@dataclass(frozen=True)
class ElementKey:
    """Key of an element type.

    Attributes
    ----------
    type
        Name of the law, such as ``mesh``.
    options
        Options of the law with their values, by name; those left out have the law's own default.
    live
        Names of the axes along which each port's body can be anywhere but at zero; empty for all that the law knows.
    """

    type: str
    options: tuple[tuple[str, Option], ...] = ()
    live: tuple[tuple[str, ...], ...] = ()

    @classmethod
    def of(cls, type_: str, **options: Option) -> "ElementKey":
        """Make the key of a law with options, all axes live."""
        return cls(type_, tuple(sorted(options.items())))

    @property
    def name(self) -> str:
        """Return a name of letters, digits and single underscores that tells type and options."""
        told = [option if value is True else value for option, value in self.options if value]
        return "_".join(re.findall(r"[A-Za-z0-9]+", " ".join(map(str, [self.type, *told]))))

    def __getitem__(self, option: str) -> Option:
        """Return the value of an option."""
        return dict(self.options)[option]
