"""Key of an element type: its law, options, and the live axes of its bodies.

Nothing here needs SymPy: a model is assembled from keys, and laws are written only when C is derived.
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
        Options of the law with their values, by name; omitted options have the law's default.
    live
        Names of the axes on which each port's body can be away from zero; empty for all that the law uses.
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
