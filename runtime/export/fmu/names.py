"""Variable names of FMI by its structured convention: ``lsp.planet[2].x``."""

import re

PLAIN = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


def structure(name: str) -> str:
    """Return a dotted name of the model's by the structured convention.

    Numbers become indices, ``.rate`` a part of the last name, and a name of other letters is quoted.
    """
    name, rate = (name.removesuffix(".rate"), "_rate") if name.endswith(".rate") else (name, "")
    made = ""
    for part in name.split("."):
        if part.isdigit() and made:
            made += f"[{part}]"
        else:
            made += ("." if made else "") + (part if PLAIN.fullmatch(part) else _quote(part))
    return made[:-1] + rate + "'" if rate and made.endswith("'") else made + rate


def identify(name: str) -> str:
    """Return a name that C, and files on any system, may have."""
    made = re.sub(r"[^A-Za-z0-9_]", "_", name) or "model"
    return made if PLAIN.fullmatch(made) else f"_{made}"


def _quote(part: str) -> str:
    """Return a name in quotes; forbidden characters become underscores."""
    return f"'{re.sub(r'[^ -~]', '_', part).replace(chr(92), '_').replace(chr(39), '_').replace(chr(34), '_')}'"
