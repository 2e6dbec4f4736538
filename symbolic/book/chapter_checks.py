"""Chapters on checks: the scene's equations, the paper's printed ones, and the identity of book and C."""

from collections import Counter
from collections.abc import Sequence

from ..checks.check import Check
from .content import Chapter, Mark, Maths
from .paper_rows import PrintedRow, write_paper_name

KINDS = {"agrees": "good", "first-order": "fair", "misprint": "bad"}


def write_checks(chapter: Chapter, checks: Sequence[Check]) -> None:
    """Write the results of all checks of the scene."""
    failed = [check for check in checks if not check.passed]
    chapter.say(
        f"{len(checks)} checks, {len(failed)} of them failed. " if failed else f"All {len(checks)} checks passed. ",
        "A value that keeps to its tolerance passes; proofs count what they could not prove.",
    )
    rows = [
        (
            Mark("passed", "good") if check.passed else Mark("failed", "bad"),
            check.name, f"{check.value:.3g}", f"{check.tolerance:.3g}", check.note,
        )
        for check in checks
    ]  # fmt: skip
    chapter.tabulate(("", "check", "value", "tolerance", "how"), rows)


def write_paper(chapter: Chapter, rows: Sequence[PrintedRow]) -> None:
    """Write each printed equation of the paper, what the derivation gives, and the verdict."""
    found = Counter(row.verdict.verdict for row in rows)
    chapter.say(
        "Wu, Zhou, Jiang and Chen, Applied Sciences 2021, 11, 6876, in its own letters; one planet stands for the sum. "
        f"{found['agrees']} rows agree with the derivation, {found['first-order']} to first order in the deflection "
        f"and the change of centre distance, and {found['misprint']} are misprints. Each is shown as printed and, "
        "where that differs, as derived: with the fewest corrections that put it right."
    )
    last = 0
    for row in rows:
        verdict = row.verdict
        if verdict.equation != last:
            chapter.head(f"Equation ({verdict.equation})", f"paper-{verdict.equation}")
            last = verdict.equation
        name, why = Maths(write_paper_name(verdict.row)), f": {verdict.why}" if verdict.why else ""
        chapter.say(Mark(verdict.verdict, KINDS[verdict.verdict]), ", row ", name, why)
        chapter.equate(row.printed, name, " as printed")
        if row.derived != row.printed:
            chapter.equate(row.derived, name, " as derived")


def write_identity(chapter: Chapter, identity: dict[str, str]) -> None:
    """Write the identity of book and C."""
    chapter.say(
        "The C of this scene is kept under the key, which is made of the model's structure, the source text of the "
        "equations and the versions at work; the digest is that of the C itself. The same key gives the same equations."
    )
    chapter.tabulate(("what", "value"), list(identity.items()))
