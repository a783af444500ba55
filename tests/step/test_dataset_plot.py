"""The data set tables as a picture."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from PIL import Image

from chord_usd.cli import DONE, UNUSABLE, main


def test_stats_draw_their_tables(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    houses, picture = tmp_path / "houses", tmp_path / "tables.png"
    assert main(["dataset", "synth", "-o", str(houses), "--count", "3"]) == DONE
    capsys.readouterr()
    words = ["dataset", "stats", str(houses), "--plot", str(picture), "--json"]
    assert main([*words, "--progress", "none"]) == DONE
    data = json.loads(capsys.readouterr().out)
    assert 0.0 < data["distance_to_paper"]["categories"] < 0.5
    with Image.open(picture) as image:
        assert image.width > 800
        assert len(image.convert("RGB").getcolors(1 << 24) or ()) > 10


def test_an_unwritable_picture_is_refused(tmp_path: Path) -> None:
    houses = tmp_path / "houses"
    assert main(["dataset", "synth", "-o", str(houses), "--count", "1"]) == DONE
    (tmp_path / "file").write_text("")
    picture = tmp_path / "file" / "tables.png"
    assert main(["dataset", "stats", str(houses), "--plot", str(picture)]) == UNUSABLE
