"""Pages that are no plan are refused in one line; difficult ones are read, or a doubt says why."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from bad_pages import NO_PLANS, at_30_degrees, cut_in_half, on_graph_paper
from PIL import Image

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.types import Plan
from chord_usd.line.plan.placement import WARNINGS
from chord_usd.line.plan.read import read_plan_file
from chord_usd.line.plan.verdict import CUT_OFF, VERDICT
from chord_usd.workshop.data.houses import random_plan
from tests.every import later

PLAN = random_plan(np.random.default_rng(5), rooms=5)
OF_EACH_COMMIT = ("an elevation", "graph paper")
"""With letters and without; to read a page of letters takes the most time."""


@pytest.mark.parametrize(
    "name", [*OF_EACH_COMMIT, *later(*[name for name in NO_PLANS if name not in OF_EACH_COMMIT])]
)
def test_what_is_no_plan_is_refused_in_one_line(name: str, tmp_path: Path) -> None:
    Image.fromarray(NO_PLANS[name]()).save(tmp_path / "page.png")
    with pytest.raises(PlanError) as refused:
        read_plan_file(tmp_path / "page.png")
    assert "\n" not in str(refused.value)
    assert "page.png" in str(refused.value)


@pytest.mark.parametrize("drawn", [on_graph_paper, at_30_degrees])
def test_difficult_pages_are_read(drawn: Callable[[Plan], np.ndarray], tmp_path: Path) -> None:
    Image.fromarray(drawn(PLAN)).save(tmp_path / "page.png")
    plan = read_plan_file(tmp_path / "page.png")
    assert len(plan.rooms) == len(PLAN.rooms)
    assert plan.extra[VERDICT] != "wrong"


def test_half_a_plan_is_never_right(tmp_path: Path) -> None:
    Image.fromarray(cut_in_half(PLAN)).save(tmp_path / "page.png")
    plan = read_plan_file(tmp_path / "page.png")
    assert plan.extra[VERDICT] != "right"
    assert any(CUT_OFF in told for told in plan.extra[WARNINGS])


def test_a_scan_beyond_the_limit_is_refused_with_the_limit(tmp_path: Path) -> None:
    Image.new("1", (20_000, 14_000), 1).save(tmp_path / "page.png")
    with pytest.raises(PlanError, match="pixels") as refused:
        read_plan_file(tmp_path / "page.png")
    assert "\n" not in str(refused.value)
