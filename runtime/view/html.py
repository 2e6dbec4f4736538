"""HTML templates; text is escaped unless a template says that it is HTML."""

from importlib import resources
from typing import Any

from ltcgear.generated.errors import LtcgearError


def open_templates(room: str, needing: str) -> Any:  # noqa: ANN401
    """Return Jinja2's environment over a package's templates.

    Parameters
    ----------
    room
        Name of the package.
    needing
        What needs Jinja2, for the message where it is missing.

    Raises
    ------
    LtcgearError
        If Jinja2 is missing.
    """
    try:
        from jinja2 import Environment, PackageLoader, StrictUndefined
    except ImportError as error:
        raise LtcgearError(f"{needing} needs Jinja2; install it with: pip install 'ltcgear[report]'") from error
    return Environment(
        loader=PackageLoader(room), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )


def read_asset(room: str, name: str) -> str:
    """Return the text of a file in a package's templates."""
    return (resources.files(room) / "templates" / name).read_text("utf-8")
