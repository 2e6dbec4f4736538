"""Selection of method and tolerance for an error that is asked for."""

import re
from dataclasses import dataclass
from decimal import ROUND_CEILING, Context
from pathlib import Path
from typing import Any

from ltcgear.generated.errors import LtcgearError

from .cheapest import find_cheapest
from .run_errors import KINDS, value_of

Data = dict[str, Any]


@dataclass(frozen=True)
class Setting:
    """Method and tolerance, where they come from, and what they are expected to give."""

    method: str
    rtol: float
    asked: float
    expected: float
    measure: str
    record: str
    over: float
    warning: str | None

    @property
    def why(self) -> str:
        """Say where it comes from."""
        return (
            f"it was the fastest for {100 * self.asked:g} % in the record of `ltcgear accuracy`: there its error was "
            f"{self.expected:.1e} over {self.over:g} s ({KINDS[self.measure]}); {self.record}"
        )

    def to_json(self) -> Data:
        """Return its entry in a summary."""
        return {
            "asked": self.asked, "expected": self.expected, "measure": self.measure, "record": self.record,
            "over_s": self.over, "warning": self.warning,
        }  # fmt: skip


def read_percentage(text: str) -> float:
    """Return an error given in per cent as a fraction.

    Raises
    ------
    LtcgearError
        If it is no percentage between 0 and 100.
    """
    found = re.fullmatch(r"\s*([0-9]*\.?[0-9]+(?:[eE][-+]?[0-9]{1,3})?)\s*%\s*", text)
    if found is None:
        raise LtcgearError(f"--accuracy {text!r:.60}: write a percentage, for example 0.1%")
    value = float(found[1]) / 100
    if not 0 < value < 1:
        raise LtcgearError(f"--accuracy {text!r:.60}: must be above 0 % and below 100 %, for example 0.1%")
    return value


def _above(error: float) -> str:
    """Return an error in per cent, in three digits, rounded up."""
    return f"{float(Context(3, ROUND_CEILING).create_decimal_from_float(100 * error)):g}%"


def select_setting(record: Data, source: Path | str, limit: float, model: str, numbers: str) -> Setting:
    """Take the fastest setting of a record that meets an error.

    Parameters
    ----------
    record, source
        A record that was read, and where it comes from.
    limit
        The error asked for, of the record's measure.
    model, numbers
        Keys of the model to be run and of its numbers.

    Raises
    ------
    LtcgearError
        If the record is of another model, or has no setting that meets the error.
    """
    if record["model"] != model:
        raise LtcgearError(
            f"{source}: of another model ({record['scene']:.60}), so its errors say nothing about this one; run "
            "`ltcgear accuracy` on this scene"
        )
    point = find_cheapest(record, limit)
    measure = record["reference"]["measure"]
    if point is None:
        found = [value_of(p["errors"], measure) for p in record["points"] if p["reason"] is None]
        least = min((value for value in found if value is not None), default=float("nan"))
        least += record["reference"]["floor"] or 0.0  # it counts on top
        ask = f"ask for --accuracy {_above(least)}, or " if least < 1 else ""
        raise LtcgearError(
            f"--accuracy {100 * limit:g}%: no setting in {source} meets it; the smallest error there is {least:.1e}; "
            f"{ask}run `ltcgear accuracy` with --preset full"
        )
    warning = None
    if record["numbers"] != numbers:
        warning = f"{source} was measured with other numbers of this model, so the expected error may not hold"
    expected = value_of(point["errors"], measure)
    return Setting(
        point["method"],
        point["rtol"],
        limit,
        0.0 if expected is None else expected,
        measure,
        str(source),
        float(record["t_end"]),
        warning,
    )
