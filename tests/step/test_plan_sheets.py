"""Several plans on one sheet."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from PIL import Image
from plan_symbols import draw_storeys

from chord_usd.base.errors import PlanError
from chord_usd.cli import main
from chord_usd.line.plan import drawing as drawings
from chord_usd.line.plan.drawing import read_drawing

pytestmark = pytest.mark.usefixtures("unlettered")


@pytest.fixture
def unlettered(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reading without OCR, which other tests are about, and which takes a second."""
    monkeypatch.setattr(drawings, "read_texts", lambda _: ())


@pytest.mark.parametrize(("part", "rooms", "told"), [(1, 3, "the largest"), (2, 2, "number 2")])
def test_a_part_of_a_sheet_is_read_and_told(
    part: int, rooms: int, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Image.fromarray(draw_storeys()).save(tmp_path / "sheet.png")
    out = tmp_path / "plan.json"
    words = ["plan", "read", str(tmp_path / "sheet.png"), "-o", str(out), "--part", str(part)]
    assert main([*words, "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert any("2 plans" in w and told in w and "--part" in w for w in report["warnings"])
    assert report["rooms"] == rooms
    assert len(json.loads(out.read_text())["rooms"]) == rooms


def test_a_part_that_is_not_there_is_refused() -> None:
    with pytest.raises(PlanError, match="part 3 was asked for, but the sheet shows 2") as caught:
        read_drawing(draw_storeys(), part=3)
    assert "1 to 2" in str(caught.value)
