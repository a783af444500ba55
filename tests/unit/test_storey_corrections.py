"""What is said of rooms of several storeys reaches those rooms."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from chord_usd.base.errors import ChordError
from chord_usd.base.runtime.json_text import json_text
from chord_usd.base.scene.json_stairs import storeys_to_json
from chord_usd.line.pipeline import Settings
from chord_usd.line.pipeline.whole_house import read_storeys
from chord_usd.line.plan.corrections import on_storeys, read_rooms
from chord_usd.workshop.data.storey_houses import random_storeys

NAMES = ["Ground floor", "First floor"]


def test_rooms_are_corrected_on_the_storey_that_is_named(tmp_path: Path) -> None:
    given = random_storeys(np.random.default_rng(1), 2)
    file = tmp_path / "house.json"
    file.write_text(json_text(storeys_to_json(given)))
    rooms = "1/2: library, ground floor/3: office"
    found = read_storeys([file], Settings(rooms=rooms))
    changed = {
        (storey, number)
        for storey, (one, other) in enumerate(zip(found, given, strict=True))
        for number, (new, old) in enumerate(zip(one.plan.rooms, other.plan.rooms, strict=True))
        if new.name != old.name
    }
    assert changed == {(1, 1), (0, 2)}


@pytest.mark.parametrize("text", ["3: bedroom", "2/3: bedroom", "attic/3: bedroom"])
def test_a_room_on_no_storey_is_refused(text: str) -> None:
    with pytest.raises(ChordError, match=r"on no storey.*1/3: bedroom"):
        on_storeys(read_rooms(text), NAMES)
