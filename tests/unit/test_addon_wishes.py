"""A text or an open plan in place of a plan: what the Blender panel makes of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from blender_addon.core import commands, report
from blender_addon.core.job import Job, Progress
from blender_addon.core.program import Program, ProgramError
from blender_addon.core.state import OFFERED_BY, panel_state

SETTINGS = commands.GenerateSettings("PLAN", "", "", {"seed": 3})


def test_a_program_too_old_for_a_text_says_so() -> None:
    old, new = Program(("x",), (0, 1, 0)), Program(("x",), (1, 0, 0), frozenset({"--text"}))
    words = ["generate", "--text=a flat", "-o", "house.usda"]
    with pytest.raises(ProgramError, match=r"chord-usd 0\.1\.0 cannot plan a home from a text yet"):
        old.check_can(words)
    new.check_can(words)
    old.check_can(["generate", "plan.png"])
    assert "text or divide an open plan" in old.lacking(("--text", "--outline"))
    assert new.lacking(("--text",)) == ""


@pytest.mark.parametrize("text", ["a two-bedroom flat, about 70 m²", "-3 rooms", "--seed"])
def test_a_text_reaches_the_program_as_it_was_written(tmp_path: Path, text: str) -> None:
    from chord_usd.cli import build_parser

    outline = tmp_path / "öpen plan.png"
    outline.touch()
    settings = replace(SETTINGS, source="TEXT", plan="left from before.png", text=f" {text} ")
    taken = build_parser().parse_args(commands.generate(settings, tmp_path / "house.usda"))
    assert (taken.text, taken.outline, taken.plan) == (text, None, [])
    settings = replace(settings, source="OUTLINE", plan=str(outline))
    taken = build_parser().parse_args(commands.generate(settings, tmp_path / "house.usda"))
    assert (taken.text, taken.outline, taken.plan) == (text, outline, [])
    settings = replace(settings, text="")
    taken = build_parser().parse_args(commands.generate(settings, tmp_path / "house.usda"))
    assert (taken.text, taken.outline) == ("", outline)


def test_only_files_are_told_how_to_be_read(tmp_path: Path) -> None:
    plan = tmp_path / "sheet.pdf"
    plan.touch()
    of_file = {"m_per_px": 0.0125, "part": 2}
    settings = replace(SETTINGS, plan=str(plan), text="a flat", options=of_file)
    words = {"--scale=0.0125", "--part=2"}
    assert words < set(commands.generate(settings, tmp_path / "house.usda"))
    usual = {"m_per_px": 0, "part": 1}
    for other in (replace(settings, source="TEXT"), replace(settings, options=usual)):
        told = " ".join(commands.generate(other, tmp_path / "house.usda"))
        assert "--scale" not in told
        assert "--part" not in told


def test_what_is_offered_is_what_the_program_has() -> None:
    """The panel asks for options by the names that chord-usd gives them."""
    from chord_usd.cli import build_parser

    for option in filter(None, OFFERED_BY.values()):
        build_parser().parse_args(["generate", option, "x", "-o", "house.usda"])


def test_a_house_is_named_after_its_plan_or_its_text() -> None:
    settings = replace(SETTINGS, plan="in/plän 1.5.png", text="Flat: 2/3 beds, 70.5 m² and so on")
    assert commands.house_name(settings) == "plän 1.5"
    name = commands.house_name(replace(settings, source="TEXT"))
    assert name == "Flat 2 3 beds 70 5"
    assert commands.house_folder("", name, Path("t")).name == name
    assert len(commands.house_name(replace(settings, source="TEXT", text="x" * 99))) < 50


PLANNED = {
    "planned": {"understood": "2 bedrooms and 70 m²", "rooms": 5, "area_m2": 64.6},
    "warnings": ["asked for 2 bedrooms, planned 1", "asked for 70 m², planned 65"],
}


def test_what_was_understood_is_told_in_words() -> None:
    assert report.planned(PLANNED) == [
        "Understood: 2 bedrooms and 70 m²",
        "Planned: 5 rooms, 65 m²",
    ]
    without_text = {"planned": {"understood": "", "rooms": 1, "area_m2": 30.2}}
    assert report.planned(without_text) == ["Planned: 1 room, 30 m²"]
    assert report.warnings(PLANNED)[0] == "Asked for 2 bedrooms, planned 1"
    assert report.planned({"stage": "house.usda"}) == []
    assert report.warnings({"stage": "house.usda"}) == []


def test_what_the_program_tells_of_a_planned_floor_is_understood() -> None:
    import numpy as np

    from chord_usd.base.raster.plan_labels import SCALES_M, sheet_frame
    from chord_usd.base.scene.types import Plan, Room
    from chord_usd.base.scene.wish import Wish
    from chord_usd.faces.commands.planned import planned_report
    from chord_usd.line.pipeline.planner import Commission, Planned
    from chord_usd.line.planning.choose import judged
    from chord_usd.line.planning.floor_sheet import blank_sheet
    from chord_usd.line.planning.words import condition_words

    square = np.array([[0.0, 0.0], [5.0, 0.0], [5.0, 4.0], [0.0, 4.0]])
    wish = Wish({"bedroom": 2}, area_m2=40.0)
    candidate = judged(Plan((Room("a", "living", square),), ()), wish)
    sheet = blank_sheet(sheet_frame(SCALES_M[0]))
    commission = Commission(wish, "2 bedrooms and 40 m²", condition_words(wish), sheet)
    told = planned_report(Planned(candidate, (candidate,), commission))
    assert report.planned({"planned": told}) == [
        "Understood: 2 bedrooms and 40 m²",
        "Planned: 1 room, 20 m²",
    ]
    assert "Asked for 2 bedrooms, planned 0" in report.warnings(told)


@pytest.mark.parametrize(
    ("words", "told"),
    [(["--text=a flat"], "Planning"), (["--outline", "a.png"], "Planning"), (["a.png"], "Reading")],
)
def test_a_plan_is_planned_or_read(words: list[str], told: str) -> None:
    job = Job(["chord-usd", "generate", *words], progress=Progress("plan", 1, 4))
    assert panel_state(job, "", "").message.startswith(told)
