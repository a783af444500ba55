"""The certificate of a house that a verb has written: how it is measured and reported."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd.faces.commands.common import Options

if TYPE_CHECKING:
    from chord_usd.base.runtime.progress import Stopwatch

NOT_CHECKED = "not checked: chord-usd check does that"


def add_check(parser: Options) -> None:
    """The option --no-check."""
    parser.add_argument(
        "--no-check", action="store_true", help="leave the certificate to chord-usd check"
    )


def certified(stage: Path, watch: Stopwatch, standard: str = "") -> dict[str, Any]:
    """The certificate of a stage that this process wrote, as check has it. Raises StageError.

    standard: names of standards that it is compared with, with commas between them.
    """
    with watch.step("check"):
        from chord_usd.base.metrics.design.standard import standards_in
        from chord_usd.line.stage.check.check_stage import certificate, check_stage

        return certificate(check_stage(stage, trusted=True, standards=standards_in(standard)))


def holds(check: dict[str, Any] | None) -> bool:
    """Whether nothing is known against the certificate: what a verb's exit code says."""
    return check is None or (
        bool(check["holds"]) and all(standard["holds"] for standard in check.get("standards", ()))
    )


def reported(check: dict[str, Any] | None, *lines: str) -> str:
    """The report of a verb: its lines and the certificate.

    What does not hold comes first, with its place.
    """
    if check is None:
        return "\n".join([*lines, NOT_CHECKED])
    lines = (*lines, *(standard["summary"] for standard in check.get("standards", ())))
    lacks = [f"no {piece}" for piece in check["home_lacks"]]
    lacking = f"; the home has {', '.join(lacks)}" if lacks else ""
    if check["holds"]:
        return "\n".join([*lines, f"certificate holds{lacking}"])
    first, *more = check["faults"]
    others = f", and {len(more)} more: chord-usd check lists them" if more else ""
    return "\n".join([f"certificate does not hold: {first}{others}{lacking}", *lines])
