"""Verbs in a process that waits: errors leave it there, and who cancels one gets another."""

from __future__ import annotations

import asyncio
import json
from pathlib import Path

import pytest

from chord_usd.base.errors import ChordError
from chord_usd.base.runtime.warm_calls import WarmVerbs

PLAN = Path(__file__).parents[1] / "fixtures" / "furnished_house.json"


def test_calls_share_a_process_until_one_is_cancelled(tmp_path: Path) -> None:
    (tmp_path / "plan.json").write_bytes(PLAN.read_bytes())
    read = ["plan", "read", "plan.json", "-o"]
    steps: list[str] = []

    async def told(step: str, done: int, total: int) -> None:
        steps.append(step)

    async def talk() -> None:
        verbs = WarmVerbs()
        first = await verbs([*read, "a.json"], tmp_path, told)
        process = verbs._process
        with pytest.raises(ChordError, match="no such file"):
            await verbs(["plan", "read", "nowhere.png", "-o", "c.json"], tmp_path, told)
        second = await verbs([*read, "c.json"], tmp_path, told)
        assert first.data["rooms"] == second.data["rooms"] > 1
        assert process
        assert verbs._process is process
        assert process.returncode is None

        call = asyncio.ensure_future(verbs([*read, "d.json"], tmp_path, told))
        await asyncio.sleep(0)
        call.cancel()
        await asyncio.wait([call])
        assert process.returncode is not None
        assert (await verbs([*read, "e.json"], tmp_path, told)).holds
        await verbs.end()

    asyncio.run(talk())
    made = [json.loads((tmp_path / f"{name}.json").read_bytes()) for name in "ace"]
    assert made.count(made[0]) == 3
    assert set(steps) == {"plan"}
