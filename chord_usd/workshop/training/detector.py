"""Train the detector: oriented boxes of items, masks of rooms, from procedural houses.

The networks and losses are ultralytics' YOLOv8; the loop is ours, because samples are drawn as
they are needed and the budget is minutes, not epochs.
"""

from __future__ import annotations

import json
import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from chord_usd import __version__
from chord_usd.base.errors import CheckpointError
from chord_usd.base.runtime.locations import RUN_CHECKPOINT
from chord_usd.base.runtime.networks import WEIGHTS_FILE
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.runtime.targets import begin_run
from chord_usd.base.scene.types import CANVAS_PX
from chord_usd.line.graph.detect import CONFIG_FILE, IMAGE_PX, Kind, scaled
from chord_usd.workshop.training.detector_data import Sample, Spoiling, stream
from chord_usd.workshop.training.yolo import build_model, load_matching, load_weights, save_model

SPOILING: dict[Kind, Spoiling] = {
    "items": Spoiling(frayed=0.4, patchy=0.2, noisy=0.2),
    # Segmentation also reads bare plans, and plans are seldom frayed.
    "rooms": Spoiling(unfurnished=0.1, frayed=0.3, patchy=0.2, noisy=0.2),
}

_CHROMA_GAIN = 4.0
"""Weight of hues beside brightness while training.

Items are painted at 0.3 opacity: a washing machine is a few hundredths off white, a wall is black.
With hues four times as strong the network learns to distinguish them sooner; the gain is folded
into its first layer when it is saved, which then takes the raster as it is.
"""

LOG_FILE = "log.jsonl"
"""One line per save: minutes, images, the mean of each part of the loss since the line before."""

_EMA_LAG_STEPS = 300.0
"""The running mean of the weights reaches its full memory after about this many steps."""


@dataclass(frozen=True)
class DetectorTraining:
    """Settings of one training run."""

    minutes: float = 15.0
    """Wall-clock budget."""
    batch: int = 16
    learning_rate: float = 2e-3
    weight_decay: float = 5e-4
    warmup_steps: int = 60
    ema_decay: float = 0.998
    device: str = "cpu"
    threads: int = 1
    seed: int = 0
    bfloat16: bool = True
    """Convolve in bfloat16: half the time where the processor knows it."""
    save_minutes: float = 2.0
    start: Path | None = None
    """Checkpoint of either kind to take what fits from: both networks share their backbone."""


def train_detector(
    kind: Kind,
    out: Path,
    config: DetectorTraining | None = None,
    resume: bool = False,
    progress: Progress | None = None,
    generated: Sequence[Sample] = (),
) -> dict[str, Any]:
    """Train one network for config.minutes; leave out/checkpoint and a log in out.

    resume: start from the weights there (their running mean; the optimiser starts afresh). The
    checkpoint is whole at any time: it is rewritten every save_minutes. progress gets seconds
    done and in all. generated: painted by the layout model, seen beside drawings. Returns the
    model card's facts of the run. Raises CheckpointError when there is nothing to resume from.
    """
    begin_run(out)
    config = config or DetectorTraining()
    torch.set_num_threads(config.threads)
    torch.manual_seed(config.seed)
    run = _Run(kind, out, config, resume, generated)
    run.train(progress or (lambda done, total: None))
    return run.facts()


class _Run:
    """The state of a training run."""

    def __init__(
        self,
        kind: Kind,
        out: Path,
        config: DetectorTraining,
        resume: bool,
        generated: Sequence[Sample],
    ) -> None:
        self.kind, self.out, self.config = kind, out, config
        self.checkpoint = out / RUN_CHECKPOINT
        self.images, self.minutes_before = 0, 0.0
        self.minutes, self.step, self.loss = 0.0, 0, math.nan
        self.parts: dict[str, list[float]] = {}
        self.origin = config.start.name if config.start else ""
        self.model = build_model(kind)
        if resume:
            self._resume()
        elif config.start:
            load_matching(self.model, config.start)
        self._turn_stem(1.0 / _CHROMA_GAIN)
        self.model = self.model.to(config.device).to(memory_format=torch.channels_last).train()  # type: ignore[call-overload]
        self.ema = {name: value.detach().clone() for name, value in self._floats()}
        self.optimizer = self._optimizer()
        # The stream goes on behind what was seen before the resumption.
        rng = np.random.default_rng((config.seed, self.images))
        self.samples = stream(rng, SPOILING[kind], kind, generated)
        self.generated = len(generated)

    def train(self, progress: Progress) -> None:
        total = self.config.minutes * 60.0
        started = saved = time.monotonic()
        elapsed = 0.0
        while elapsed < total:
            self._set_learning_rate(elapsed / total)
            self._update(_batch(self.kind, self.samples, self.config))
            now = time.monotonic()
            elapsed = now - started
            self.minutes = elapsed / 60.0
            if now - saved > self.config.save_minutes * 60.0:
                self.save(self.facts())
                self._log()
                saved = now
            progress(round(min(elapsed, total)), round(total))
        self.save(self.facts())
        self._log()

    def save(self, facts: dict[str, Any]) -> None:
        """Write the running mean of the weights."""
        current = {name: value.clone() for name, value in self._floats()}
        self.model.load_state_dict(self.ema, strict=False)
        self._turn_stem(_CHROMA_GAIN)
        save_model(self.kind, self.model, self.checkpoint, facts)
        self.model.load_state_dict(current, strict=False)

    def _turn_stem(self, gain: float) -> None:
        """Make the first layer take pictures whose hues are 1 / gain times as strong."""
        weight = self.model.get_parameter("model.0.conv.weight")
        with torch.no_grad():
            weight.copy_(_with_chroma(weight, gain))

    def _log(self) -> None:
        means = {name: round(float(np.mean(values)), 4) for name, values in self.parts.items()}
        self.parts.clear()
        row = {"minutes": round(self.minutes_before + self.minutes, 2), "images": self.images}
        with (self.out / LOG_FILE).open("a", encoding="utf-8") as log:
            log.write(json.dumps({**row, **means}) + "\n")

    def facts(self) -> dict[str, Any]:
        """The model card's facts of the run so far."""
        return {
            "version": __version__,
            "images": self.images,
            "minutes": round(self.minutes_before + self.minutes, 1),
            "batch": self.config.batch,
            "seed": self.config.seed,
            "device": self.config.device,
            "threads": self.config.threads,
            "loss": round(self.loss, 4),
            "generated": self.generated,
            **({"start": self.origin} if self.origin else {}),
        }

    def _resume(self) -> None:
        if not (self.checkpoint / WEIGHTS_FILE).is_file():
            raise CheckpointError(
                "there is nothing to resume from",
                where=str(self.checkpoint),
                expected=f"a folder with {WEIGHTS_FILE}",
                try_="train without resuming",
            )
        load_weights(self.kind, self.model, self.checkpoint)
        before = json.loads((self.checkpoint / CONFIG_FILE).read_text(encoding="utf-8"))
        self.images = int(before.get("images", 0))
        self.minutes_before = float(before.get("minutes", 0.0))
        self.origin = str(before.get("start", ""))

    def _floats(self) -> Iterator[tuple[str, Tensor]]:
        return (
            (name, value)
            for name, value in self.model.state_dict().items()
            if value.is_floating_point()
        )

    def _optimizer(self) -> torch.optim.Optimizer:
        decayed = [p for p in self.model.parameters() if p.requires_grad and p.ndim > 1]
        free = [p for p in self.model.parameters() if p.requires_grad and p.ndim <= 1]
        groups = [
            {"params": decayed, "weight_decay": self.config.weight_decay},
            {"params": free, "weight_decay": 0.0},
        ]
        return torch.optim.AdamW(groups, lr=self.config.learning_rate, betas=(0.9, 0.99))

    def _set_learning_rate(self, share_done: float) -> None:
        """Warm up, hold, and fall along a cosine to a hundredth."""
        warm = min(1.0, (self.step + 1) / self.config.warmup_steps)
        fall = 0.01 + 0.99 * (1 + math.cos(math.pi * min(share_done, 1.0))) / 2
        for group in self.optimizer.param_groups:
            group["lr"] = self.config.learning_rate * warm * fall

    def _update(self, batch: dict[str, Tensor]) -> None:
        with torch.autocast(batch["img"].device.type, torch.bfloat16, self.config.bfloat16):
            seen = self.model(_with_chroma(batch["img"], _CHROMA_GAIN))
        # Boxes to a fraction of a pixel need more digits than bfloat16 has.
        losses, parts = self.model.loss(batch, _as_float(seen))  # type: ignore[operator]
        loss = losses.sum()
        self.optimizer.zero_grad(set_to_none=True)
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self.model.parameters(), 10.0)
        self.optimizer.step()
        self.step += 1
        self.images += len(batch["img"])
        self.loss = float(loss.detach()) / len(batch["img"])
        for name, value in parts.items():
            self.parts.setdefault(name, []).append(float(value))
        decay = self.config.ema_decay * (1 - math.exp(-self.step / _EMA_LAG_STEPS))
        for name, value in self._floats():
            self.ema[name].lerp_(value.detach(), 1 - decay)


def _batch(kind: Kind, samples: Iterator[Sample], config: DetectorTraining) -> dict[str, Tensor]:
    """A batch in the form ultralytics' losses take; lengths relative to the canvas."""
    chosen = list(islice(samples, config.batch))
    images = np.stack([scaled(sample.rgb, IMAGE_PX[kind]) for sample in chosen])
    images = images.transpose(0, 3, 1, 2)
    rgb = torch.from_numpy(np.ascontiguousarray(images)).to(config.device).float() / 255.0
    if kind == "items":
        classes = [sample.boxes[:, 0] for sample in chosen]
        scale = np.array([1.0 / CANVAS_PX] * 4 + [1.0])
        boxes = [sample.boxes[:, 1:] * scale for sample in chosen]
    else:
        classes = [sample.room_classes for sample in chosen]
        boxes = [sample.room_boxes / CANVAS_PX for sample in chosen]
    batch = {
        "img": rgb.contiguous(memory_format=torch.channels_last),
        "batch_idx": _joined([np.full(len(rows), i) for i, rows in enumerate(classes)]),
        "cls": _joined(classes),
        "bboxes": _joined(boxes),
    }
    if kind == "rooms":
        batch["masks"] = torch.from_numpy(np.stack([sample.room_map for sample in chosen])).float()
    return {name: value.to(config.device) for name, value in batch.items()}


def _with_chroma(planes: Tensor, gain: float) -> Tensor:
    """(N, 3, H, W) with what the three channels differ from their mean multiplied."""
    mean = planes.mean(dim=1, keepdim=True)
    return mean + gain * (planes - mean)


def _as_float(outputs: Any) -> Any:
    """The same tree of outputs in single precision."""
    if isinstance(outputs, Tensor):
        return outputs.float()
    if isinstance(outputs, dict):
        return {name: _as_float(value) for name, value in outputs.items()}
    return [_as_float(value) for value in outputs]


def _joined(parts: list[np.ndarray]) -> Tensor:
    return torch.from_numpy(np.concatenate(parts).astype(np.float32))
