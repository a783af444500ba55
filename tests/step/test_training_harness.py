"""Runs that are cut, fine-tuned and watched: what every network's training relies on."""

from __future__ import annotations

import gzip
import json
import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from torch import Tensor, nn

from chord_usd.base.errors import CheckpointError, SceneError
from chord_usd.base.runtime.locations import shipped_checkpoints
from chord_usd.cli import build_parser, main
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.houses import random_plan
from chord_usd.workshop.data.kept_set import KeptHouse, read_kept, write_kept
from chord_usd.workshop.training.held_out import HeldOut, curve_of, draw_curve, slope_left
from chord_usd.workshop.training.loop import Lesson, RunConfig, train, write_weights
from chord_usd.workshop.training.next_network import standings
from chord_usd.workshop.training.weights import WARM_SHARE, Weights, pack, unpack, warm_and_cool

QUICK = RunConfig(
    minutes=0.01, batch=1, learning_rate=1e-2, warmup_steps=200, cooldown_share=0.5,
    weight_decay=0.0, ema_decay=0.999,
)  # fmt: skip


class CutError(Exception):
    """A run ends as by kill: nothing after it is written."""


def _lesson(steps: int | None = None) -> Lesson[nn.Linear, Tensor]:
    """Learn to give back the input; cut after so many steps."""

    def batches(seed: int) -> Iterator[Tensor]:
        generator = torch.Generator().manual_seed(seed)
        count = 0
        while steps is None or count < steps:
            count += 1
            yield torch.randn(8, 4, generator=generator)
        raise CutError

    return Lesson(
        batches,
        losses=lambda network, batch: {"error": ((network(batch) - batch) ** 2).mean()},
        score=lambda network: {
            "held_out_error": float(((network.weight - torch.eye(4)) ** 2).sum())
        },
        write=lambda folder, network, facts: write_weights(folder, network, {"training": facts}),
    )


class TestAverage:
    @pytest.mark.parametrize("steps", [40, 180, 2000])
    def test_a_change_reaches_the_average_in_runs_of_any_length(self, steps: int) -> None:
        """The network moves evenly; of the way, nine tenths are in the checkpoint."""
        network = nn.Linear(4, 1, bias=False)
        weights = Weights(network, 1e-3, 0.0, decay=0.999)
        begun = weights.average.weight.clone()
        for _ in range(steps):
            with torch.no_grad():
                network.weight += 1e-3
            weights.taken += 1
            weights._update_average()
        moved = (network.weight - begun).mean()
        assert float(((weights.average.weight - begun).mean() / moved).detach()) > 0.9

    def test_long_runs_average_no_longer_than_they_are_asked_to(self) -> None:
        network = nn.Linear(1, 1, bias=False)
        weights = Weights(network, 1e-3, 0.0, decay=0.9)
        weights.taken = 100_000
        weights.average.weight.data.zero_()
        network.weight.data.fill_(1.0)
        weights._update_average()
        assert float(weights.average.weight) == pytest.approx(0.1)


def test_the_rate_is_full_after_a_share_of_the_budget_however_few_steps_that_is() -> None:
    assert warm_and_cool(0, 200, 0.0, 0.5, 0.02) == pytest.approx(1 / 200)
    assert warm_and_cool(3, 200, WARM_SHARE, 0.5, 0.02) == pytest.approx(1.0)
    assert warm_and_cool(200, 200, 0.0, 0.5, 0.02) == pytest.approx(1.0)
    assert warm_and_cool(10_000, 200, 1.0, 0.5, 0.02) == pytest.approx(0.02)


@settings(max_examples=40, deadline=None)
@given(
    arrays.arrays(np.float32, st.integers(1, 700), elements=st.floats(-1e3, 1e3, width=32)),
    st.sampled_from((1, 3, 4)),
)
def test_eight_bits_keep_signs_and_the_size_of_small_values(values, root: int) -> None:
    codes, scales = pack(torch.from_numpy(values), root)
    back = unpack(codes, scales, root).numpy()
    largest = scales.repeat_interleave(256)[: len(values)].numpy()
    assert codes.dtype == torch.int8
    # Half a level of the root, at the slope of its inverse.
    bound = largest * (root * 0.5 / 127 + 1e-5) + 1e-30
    assert (np.abs(back - values) <= bound).all()
    assert (back * values >= 0).all()
    if root > 1:
        normal = np.abs(values) > 1e-25
        assert (back[normal & (largest > 1e-20)] != 0).all()


class TestCut:
    def test_a_cut_run_goes_on_from_its_last_save(self, tmp_path: Path) -> None:
        always = {**QUICK.__dict__, "save_minutes": 0.0, "minutes": 60.0}
        network = nn.Linear(4, 4)
        with pytest.raises(CutError):
            train(_lesson(steps=30), network, RunConfig(**always), tmp_path)
        assert not (tmp_path / "checkpoint").exists()
        facts = train(_lesson(), nn.Linear(4, 4), QUICK, tmp_path)
        assert facts["steps"] > 30
        rows = curve_of(tmp_path)
        assert rows[-1]["step"] == facts["steps"]
        assert facts["held_out_error"] < 1.0

    def test_the_curve_is_that_of_a_run_without_a_cut(self, tmp_path: Path) -> None:
        """Same data after the cut: eight bits for moments leave the losses as they are."""
        losses = {}
        for name in ("whole", "cut"):
            torch.manual_seed(0)
            weights = Weights(nn.Linear(4, 4), 1e-2, 0.0, 0.999)
            generator = torch.Generator().manual_seed(1)
            seen = []
            for step in range(120):
                if name == "cut" and step % 20 == 19:
                    weights.save(tmp_path, {})
                    weights = Weights(nn.Linear(4, 4), 1e-2, 0.0, 0.999)
                    weights.load(tmp_path, "cpu")
                batch = torch.randn(8, 4, generator=generator)
                loss = ((weights.network(batch) - batch) ** 2).mean()
                weights.step(loss, 1e-2, 1.0)
                seen.append(float(loss.detach()))
            losses[name] = np.array(seen)
        assert np.abs(losses["cut"] - losses["whole"]).max() < 0.05 * losses["whole"][0]

    def test_a_state_of_another_version_is_named(self, tmp_path: Path) -> None:
        weights = Weights(nn.Linear(2, 2), 1e-2, 0.0, 0.9)
        weights.step(weights.network(torch.ones(1, 2)).sum(), 1e-2, 1.0)
        weights.save(tmp_path / "state", {})
        index = tmp_path / "state" / "state.json"
        index.write_text(json.dumps({**json.loads(index.read_text()), "format": 1}))
        with pytest.raises(CheckpointError, match="another version"):
            weights.load(tmp_path / "state", "cpu")


class TestHeldOut:
    def test_rows_survive_a_cut_line_and_become_a_curve(self, tmp_path: Path) -> None:
        values = iter([1.0, 0.5, 0.4])
        control = HeldOut(tmp_path, lambda: {"nats": next(values), "of": {"wall": 0.5}, "n": 3})
        for step in range(3):
            control.take(step, float(step))
        with control.path.open("a") as log:
            log.write('{"step": 3, "min')
        rows = curve_of(tmp_path)
        assert [row["nats"] for row in rows] == [1.0, 0.5, 0.4]
        assert set(rows[0]) == {"step", "minutes", "nats", "wall"}
        assert draw_curve(rows, tmp_path / "curve.png")
        assert (tmp_path / "curve.png").stat().st_size < 20_000

    def test_a_flat_end_has_no_slope(self) -> None:
        flat = [{"nats": value} for value in (9.0, 5.0, 3.0, 2.0, 2.0, 2.0)]
        steep = [{"nats": float(9 - step)} for step in range(6)]
        assert slope_left(flat, "nats") == 0.0
        assert slope_left(steep, "nats") == pytest.approx(0.2)
        assert slope_left(flat[:2], "nats") is None


@pytest.fixture(scope="module")
def houses() -> list[KeptHouse]:
    rngs = [np.random.default_rng(seed) for seed in range(6)]
    return [
        KeptHouse(f"house_{seed}", furnish(random_plan(rng), rng), {"planned": 0.5})
        for seed, rng in enumerate(rngs)
    ]


class TestKeptSet:
    def test_houses_come_back_and_take_little_room(self, houses, tmp_path: Path) -> None:
        target = tmp_path / "kept.jsonl.gz"
        assert write_kept(houses, target) == 6
        back = read_kept(target)
        for kept, read in zip(houses, back, strict=True):
            assert (read.name, read.scores) == (kept.name, kept.scores)
            centres = [
                np.array([item.box.center_m for item in one.house.items]) for one in (kept, read)
            ]
            assert np.allclose(*centres, atol=1e-4)
            assert len(read.house.rooms) == len(kept.house.rooms)
        # 5,000 houses in 20 MB.
        assert target.stat().st_size / len(houses) < 4_000

    def test_later_runs_extend_a_set(self, houses, tmp_path: Path) -> None:
        whole, grown = tmp_path / "whole.jsonl.gz", tmp_path / "grown.jsonl.gz"
        write_kept(houses, whole)
        write_kept(houses[:2], grown)
        write_kept([*read_kept(grown), *houses], grown)
        assert whole.read_bytes() == grown.read_bytes()

    def test_a_changed_row_is_named(self, houses, tmp_path: Path) -> None:
        target = tmp_path / "kept.jsonl.gz"
        write_kept(houses, target)
        text = gzip.decompress(target.read_bytes()).decode().replace("house_2", "house_9")
        target.write_bytes(gzip.compress(text.encode()))
        with pytest.raises(SceneError, match="line 4 was changed"):
            read_kept(target)

    @pytest.mark.parametrize(
        "content",
        [b"", b"no gzip", gzip.compress(b"{}"), gzip.compress(b"\xff\xfe")],
        ids=["empty", "no gzip", "no header", "no text"],  # gzip notes the time
    )
    def test_another_file_is_refused(self, content: bytes, tmp_path: Path, capsys) -> None:
        target = tmp_path / "kept.jsonl.gz"
        target.write_bytes(content)
        assert (
            main(["train", "lists", "-o", str(tmp_path / "run"), "--furnished", str(target)]) == 2
        )
        assert "kept set" in capsys.readouterr().err


class TestNext:
    def test_the_farthest_comes_first_and_every_network_is_there(self) -> None:
        rows = standings(shipped_checkpoints())
        excesses = [row.excess for row in rows]
        assert excesses == sorted(excesses, reverse=True)
        for row in rows:
            assert (shipped_checkpoints() / row.network).is_dir()

    def test_each_command_line_is_understood(self, capsys) -> None:
        for row in standings(shipped_checkpoints()):
            assert main(["train", "next", "--dry-run", "--json", "--network", row.network]) == 0
            command = json.loads(capsys.readouterr().out)["command"]
            build_parser(command[1:]).parse_args(command[1:])

    def test_it_replaces_no_process_that_does_more(self, tmp_path: Path, capsys) -> None:
        assert main(["train", "next", "-o", str(tmp_path / "runs"), "--minutes", "0.001"]) == 2
        assert "train next: would replace the process that calls it" in capsys.readouterr().err
        assert not list(tmp_path.iterdir())

    @pytest.mark.acceptance
    def test_what_the_run_says_is_heard(self, tmp_path: Path) -> None:
        words = ["train", "next", "--network", "symbols", "--minutes", "0.001", "-o"]
        command = [sys.executable, "-m", "chord_usd", *words, tmp_path / "runs"]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0
        assert "symbols: " in done.stderr
        assert "checkpoint: " in done.stdout

    def test_a_wrong_table_is_one_line(self, tmp_path: Path) -> None:
        (tmp_path / "targets.tsv").write_text("network\tvalue\nlists\t2\n")
        with pytest.raises(CheckpointError, match="targets"):
            standings(tmp_path)


_OF_TWO = """
import sys, torch
from torch import nn
from chord_usd.workshop.training.processes import Processes
from chord_usd.workshop.training.weights import Weights
processes = Processes("cpu")
torch.manual_seed(0)
weights = Weights(nn.Linear(3, 1, bias=False), 0.1, 0.0, 0.9, processes)
torch.manual_seed(processes.seed(1))
for _ in range(5):
    batch = torch.randn(4, 3)
    weights.step(weights.network(batch).square().mean(), 0.1, 1.0)
ended = processes.agree(processes.is_first, torch.device("cpu"))
torch.save((weights.network.weight.detach(), batch, ended), sys.argv[1])
"""


@pytest.mark.acceptance
def test_two_processes_learn_as_one_from_different_data(tmp_path: Path) -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    environment = {
        **os.environ, "WORLD_SIZE": "2", "MASTER_ADDR": "127.0.0.1", "MASTER_PORT": str(port),
        "OMP_NUM_THREADS": "1",
    }  # fmt: skip
    running = [
        subprocess.Popen(
            [sys.executable, "-c", _OF_TWO, str(tmp_path / f"{rank}.pt")],
            env={**environment, "RANK": str(rank)},
        )
        for rank in range(2)
    ]
    assert [process.wait(timeout=300) for process in running] == [0, 0]
    (first, seen, ended), (second, others, agreed) = (
        torch.load(tmp_path / f"{rank}.pt") for rank in range(2)
    )
    assert torch.equal(first, second)
    assert not torch.equal(seen, others)
    assert ended
    assert agreed
