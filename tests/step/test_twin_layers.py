"""The layer of a twin, opened over its stage: one prim stands elsewhere, at the noted place."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from chord_usd.base.runtime.stages import open_known
from chord_usd.base.scene.types import SceneGraph
from chord_usd.cli import main
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.check.check_scene import read_storeys


def test_a_layer_opens_over_its_stage_and_moves_one_piece(
    tmp_path: Path, staged_graph: SceneGraph
) -> None:
    (tmp_path / "houses" / "one").mkdir(parents=True)
    author_stage(staged_graph, tmp_path / "houses" / "one" / "house.usda")
    assert (
        main(["dataset", "twins", str(tmp_path / "houses"), "-o", str(tmp_path / "out"), "-q"]) == 0
    )
    rows = [
        json.loads(line) for line in (tmp_path / "out" / "twins.jsonl").read_text().splitlines()
    ]
    assert rows
    for row in rows:
        stages = [open_known(tmp_path / "out" / row[key]) for key in ("stage", "twin_stage")]
        house, twin = (
            {item.id: item.box for item in read_storeys(stage)[0].graph.items} for stage in stages
        )
        assert [name for name in house if house[name] != twin[name]] == [row["piece"]]
        assert twin[row["piece"]].center_m == pytest.approx(row["after"]["at_m"], abs=1e-3)
        turned = twin[row["piece"]].yaw_deg - row["after"]["yaw_deg"]
        assert (turned + 180.0) % 360.0 == pytest.approx(180.0, abs=0.01)
