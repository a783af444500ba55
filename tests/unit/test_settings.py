"""The table of options: its faces agree with it."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import get_type_hints

import pytest

from blender_addon.core import options as panel
from chord_usd.base.errors import ChordError
from chord_usd.base.scene.settings import FACES, OPTIONS, HouseOptions, Settings, words_of
from chord_usd.cli import build_parser
from chord_usd.faces.commands.house_options import documented_rows, panel_rows, settings_of

DOCUMENT = Path(__file__).parents[2] / "docs/commands.md"


def test_keywords_of_python_are_the_rows() -> None:
    assert get_type_hints(HouseOptions) == get_type_hints(Settings)


def test_the_panel_has_a_copy_of_its_rows() -> None:
    """Written by: python -m chord_usd.faces.commands.house_options panel"""
    assert list(panel.ROWS) == panel_rows()


def test_the_document_lists_every_row() -> None:
    """Written by: python -m chord_usd.faces.commands.house_options document"""
    assert documented_rows() in DOCUMENT.read_text()


def test_faces_are_known() -> None:
    assert {face for option in OPTIONS.values() for face in option.faces} <= set(FACES)


def test_words_of_a_command_line_give_the_settings_back() -> None:
    chosen = {
        "seed": 3, "style": "modern", "texture_px": 512, "lists": False, "m_per_px": 0.01,
        "furniture": "-Hall: desk", "asset_folders": (Path("a"), Path("-b")), "roof": "hip",
    }  # fmt: skip
    words = ["generate", "plan.png", "-o", "house.usda", *words_of(chosen)]
    assert settings_of(build_parser(words).parse_args(words)) == Settings(**chosen)


@pytest.mark.parametrize(
    ("name", "value"),
    [(field.name, object()) for field in fields(Settings) if OPTIONS[field.name].limits]
    + [("seed", True), ("steps", 0), ("m_per_px", float("nan")), ("roof", "onion"), ("style", "x")],
)
def test_values_out_of_range_are_refused(name: str, value: object) -> None:
    with pytest.raises(ChordError):
        Settings(**{name: value})
