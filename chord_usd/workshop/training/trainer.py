"""Training of a layout model of any level: resumable, on a time budget, on CPU or CUDA."""

from __future__ import annotations

import csv
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import asdict, dataclass
from datetime import date
from functools import partial
from pathlib import Path
from typing import Any

import torch
from torch import Tensor
from torch.nn import functional

from chord_usd.base.runtime.targets import begin_run
from chord_usd.line.layout.checkpoint import load_checkpoint, save_checkpoint
from chord_usd.line.layout.condition import AREA_SCALE
from chord_usd.line.layout.config import LayoutConfig
from chord_usd.line.layout.device import half_precision
from chord_usd.line.layout.levels import traits_of
from chord_usd.line.layout.network import LayoutNetwork
from chord_usd.line.layout.sample import DRAFTED_SHARE, MOSTLY
from chord_usd.line.layout.schedule import training_scheduler
from chord_usd.line.layout.transfer import adopt, take_up
from chord_usd.workshop.training.budget import Budget
from chord_usd.workshop.training.held_out import CURVE_FILE, HeldOut, curve_of, draw_curve
from chord_usd.workshop.training.layout_graph import write_layout_graph
from chord_usd.workshop.training.memory import keep_freed_memory
from chord_usd.workshop.training.processes import Processes
from chord_usd.workshop.training.stream import Batch, BatchStream, batch_loader
from chord_usd.workshop.training.weights import Weights, warm_and_cool

STATE_FOLDER = "state"
LOG_FILE = "losses.csv"
HELD_OUT = 16
"""Layouts that the average is scored on."""
_END_RATE = 0.05
"""Share of the learning rate at which a run ends."""
LOG_FIELDS = ("step", "images", "minutes", "loss", "category", "front", "learning_rate")

PlanTensors = tuple[Tensor, Tensor | None, Tensor | None]
"""What a network is shown beside the noisy state: pixels, grid, words."""

Report = Callable[[dict[str, float]], None]


@dataclass(frozen=True)
class TrainingConfig:
    """How to train. Preset `paper` uses the paper's numbers (section 5), see PAPER_TRAINING."""

    minutes: float = 60.0
    batch: int = 8
    learning_rate: float = 4e-4
    warmup_steps: int = 60
    cooldown_share: float = 0.25
    """Last share of the budget in which the learning rate falls to a twentieth."""
    weight_decay: float = 0.01
    ema_decay: float = 0.999
    gradient_clip: float = 1.0
    front_weight: float = 0.3
    area_power: float = 0.5
    """Pixels count as their room's (or table's) area to minus this power: 0 all pixels alike, 1 all
    rooms alike."""
    decay_every_steps: int = 0
    """Where set, the learning rate is divided by 10 each time (paper), without cool-down."""
    workers: int = 1
    save_minutes: float = 0.5
    """After so many, the state of the run is saved: the most that a kill loses."""
    checkpoint_minutes: float = 5.0
    sheet_minutes: float = 15.0
    seed: int = 0
    device: str = "cpu"
    mixed_precision: bool = True
    """bfloat16 in the network, float32 in losses and weights."""
    processor_time: bool = False
    """Whether minutes are the processor's, of this process without its workers, not the clock's."""


PAPER_SCENES = 9706
PAPER_EPOCHS = 400
_PAPER_STEPS_PER_EPOCH = PAPER_SCENES * 8 // 10 // 4

PAPER_TRAINING = TrainingConfig(
    minutes=float("inf"),
    batch=4,
    learning_rate=1e-4,
    warmup_steps=0,
    weight_decay=0.0,
    decay_every_steps=100 * _PAPER_STEPS_PER_EPOCH,
)
"""Batch 4, learning rate 1e-4 divided by 10 every 100 epochs (paper, section 5.1)."""

TABLE_TRAINING = TrainingConfig(minutes=40.0, batch=16, learning_rate=4e-4, warmup_steps=60)
"""Tabletops are small pictures: more of them a step for the same time."""


FLOOR_TRAINING = TrainingConfig(minutes=60.0, batch=8, learning_rate=4e-4, front_weight=0.0)
"""Floor plans have no fronts."""


class LayoutTrainer:
    """Holds what a run must not lose: network, moving average, optimiser, counters."""

    def __init__(self, network_config: LayoutConfig, config: TrainingConfig, folder: Path) -> None:
        torch.manual_seed(config.seed)
        self.config, self.folder = config, folder
        self.traits = traits_of(network_config)
        self.data: dict[str, Any] = {}
        self.held_out: dict[str, float] = {}
        """Scores of the average, when the checkpoint was written last."""
        self.device = torch.device(config.device)
        network = LayoutNetwork(network_config).to(self.device)
        if self.device.type == "cuda":  # on a CPU the conversions cost more than they give
            network.to(memory_format=torch.channels_last)  # type: ignore[call-overload]
        self.processes = Processes(config.device)
        # Networks begin alike, noise does not.
        torch.manual_seed(self.processes.seed(config.seed))
        self.weights = Weights(
            network, config.learning_rate, config.weight_decay, config.ema_decay, self.processes
        )
        self.network, self.average = self.weights.network, self.weights.average
        self.scheduler = training_scheduler(network_config)
        self.step, self.minutes_before = 0, 0.0
        self.budget = Budget(config.minutes, processor_time=config.processor_time)
        self._run_step = self._compiled()

    def warm_start(self, checkpoint: Path) -> None:
        """Starts from the weights of a checkpoint folder; the optimiser starts fresh.

        A checkpoint of another level gives what fits (transfer.adopt); steps count from 0 then.
        """
        loaded = load_checkpoint(checkpoint, str(self.device))
        if loaded.config.level != self.network.config.level:
            adopt(self.network, loaded.network)
            self.average.load_state_dict(self.network.state_dict())
            return
        for network in (self.network, self.average):
            take_up(network, loaded.network)
        self.step = int(loaded.training.get("steps", 0))
        self.minutes_before = float(loaded.training.get("minutes", 0.0))

    def resume(self) -> bool:
        """Takes up the run in the folder; False where there is none."""
        counters = self.weights.load(self.folder / STATE_FOLDER, str(self.device))
        if counters is None:
            return False
        self.step, self.minutes_before = counters["step"], counters["minutes"]
        return True

    def save(self) -> None:
        """Writes the resumable state as a whole."""
        counters = {"step": self.step, "minutes": self.minutes_before + self.minutes}
        self.weights.save(self.folder / STATE_FOLDER, counters)

    def write_checkpoint(self, control: HeldOut) -> None:
        """Scores the average, and writes the checkpoint folder with the curve of its scores."""
        self.held_out = dict(control.take(self.step, self.minutes_before + self.minutes))
        checkpoint = self.folder / "checkpoint"
        save_checkpoint(checkpoint, self.average, self.training_record())
        write_layout_graph(checkpoint, self.average)
        draw_curve(curve_of(self.folder), checkpoint / CURVE_FILE)

    def training_record(self) -> dict[str, object]:
        """What the model card says of this run."""
        return {
            "steps": self.step,
            "batch": self.config.batch * self.processes.count,
            "minutes": round(self.minutes_before + self.minutes, 1),
            "device": self.config.device,
            "date": date.today().isoformat(),
            "data": self.data,
            **self.held_out,
        }

    @property
    def minutes(self) -> float:
        """Minutes since this call of the program began."""
        return self.budget.spent

    def train(self, stream: BatchStream, report: Report) -> None:
        """Runs until the minutes are spent, saving every save_minutes and at the end."""
        config = self.config
        is_first = self.processes.is_first
        if is_first:
            begin_run(self.folder)
        keep_freed_memory()
        self.data = asdict(stream.config)
        # A resumed run must not see the data of its first minutes again.
        stream.skip_to(self.processes.seed(self.step))
        budget = self.budget = Budget(config.minutes, processor_time=config.processor_time)
        control = HeldOut(self.folder, partial(self._score, stream.held_out_batch(HELD_OUT)))
        for batch in batch_loader(stream, config.workers):
            losses = self._step(batch)
            ended = self.processes.agree(budget.is_over, self.device)
            if is_first:
                self._keep(stream, control, losses, report, ended)
            if ended:
                break

    def _keep(
        self,
        stream: BatchStream,
        control: HeldOut,
        losses: dict[str, Tensor],
        report: Report,
        ended: bool,
    ) -> None:
        """Write what is due after a step: log, scores, checkpoint, state, sheet."""
        config, budget = self.config, self.budget
        if self.step % 25 == 0:
            self._log(losses, report)
        if ended or budget.is_due("checkpoint", config.checkpoint_minutes):
            self.write_checkpoint(control)
        else:
            control.take_if_due(budget, self.step, self.minutes_before)
        if ended or budget.is_due("save", config.save_minutes):
            self.save()
        if ended or budget.is_due("sheet", config.sheet_minutes):
            self._draw_sheet(stream)

    @torch.no_grad()
    def _score(self, batch: Batch) -> dict[str, float]:
        """Losses of the average on a batch, always at the same noise."""
        batch = {name: tensor.to(self.device) for name, tensor in batch.items()}
        devices = [self.device] if self.device.type == "cuda" else []
        with torch.random.fork_rng(devices):
            torch.manual_seed(0)
            losses = self._losses(batch, self.average)
        return {f"held_out_{name}": round(float(loss), 5) for name, loss in losses.items()}

    def _step(self, batch: Batch) -> dict[str, Tensor]:
        batch = {name: tensor.to(self.device, non_blocking=True) for name, tensor in batch.items()}
        with half_precision(self.config.device) if self.config.mixed_precision else nullcontext():
            losses = self._run_step(batch)
        self.weights.step(losses["loss"], self._learning_rate(), self.config.gradient_clip)
        self.step += 1
        return losses

    def _losses(self, batch: Batch, network: LayoutNetwork | None = None) -> dict[str, Tensor]:
        """Cross-entropy of the categories at a random noise level, or the paper's noise error.

        network: the one in training by default.
        """
        network = network or self.network
        clean = self._clean_state(batch)
        times = self._times(batch)
        noise = torch.randn_like(clean)
        noisy = self.scheduler.add_noise(clean, noise, times)
        plan = self._plan_pixels(batch), self._plan_grid(batch), batch.get("words")
        output = network(noisy, times, *plan)
        if network.config.state == "rgb":
            return {"loss": functional.mse_loss(output.float(), noise)}
        return self._category_losses(output, batch, self._wanted(batch, noisy, times, plan))

    def _times(self, batch: Batch) -> Tensor:
        """(B,) random training steps: early ones only where a draft knows a whole house."""
        count = len(batch["labels"])
        drawn = torch.rand(count, device=batch["labels"].device)
        if self.network.config.draft:
            floor = batch["pixels"][:, self.traits.ground_plane] > 0
            unknown = (floor & ~batch["draft_known"]).flatten(1).sum(1)
            drafted = unknown < (1.0 - MOSTLY) * floor.flatten(1).sum(1)
            drawn = torch.where(drafted, drawn * DRAFTED_SHARE, drawn)
        return (drawn * self.network.config.training_steps).long()

    def _wanted(self, batch: Batch, noisy: Tensor, times: Tensor, plan: PlanTensors) -> Tensor:
        """What the network is to say of the categories: labels (B, H, W), or their chances."""
        return batch["labels"].long()

    def _category_losses(self, output: Tensor, batch: Batch, wanted: Tensor) -> dict[str, Tensor]:
        """Means over pixels of the ground: nothing belongs outside, so nothing is learned there."""
        classes = self.traits.class_count
        logits, front_logit = output[:, :classes], output[:, classes]
        item = batch["labels"] > 0
        inside = (batch["pixels"][:, self.traits.ground_plane] > 0) | item
        weight = inside * self._pixel_weight(batch)
        category = functional.cross_entropy(logits.float(), wanted, reduction="none")
        category = (category * weight).sum() / weight.sum()
        front = functional.binary_cross_entropy_with_logits(
            front_logit.float(), batch["front"].float(), reduction="none"
        )
        front = (front * item).sum() / item.sum().clamp(min=1)
        loss = category + self.config.front_weight * front
        return {"loss": loss, "category": category.detach(), "front": front.detach()}

    def _pixel_weight(self, batch: Batch) -> Tensor:
        """(B, H, W): a bathroom left empty is as bad as a bedroom, at a tenth of its pixels."""
        plane = self.traits.area_plane
        if plane is None:
            # Not even thin walls and doors weigh more: they would be painted fat.
            return torch.ones_like(batch["labels"], dtype=torch.float32)
        area_m2 = torch.expm1(batch["grid"][:, plane : plane + 1] * AREA_SCALE)
        relative = area_m2.clamp(*self.traits.weighed_area_m2) / self.traits.usual_area_m2
        weight = torch.where(area_m2 > 0, relative**-self.config.area_power, 1.0)
        return functional.interpolate(weight, batch["labels"].shape[1:])[:, 0]

    def _clean_state(self, batch: Batch) -> Tensor:
        if self.network.config.state == "rgb":
            return batch["layout"].permute(0, 3, 1, 2).float() / 127.5 - 1.0
        return self.network.encode(batch["labels"], batch["front"])

    def _plan_pixels(self, batch: Batch) -> Tensor:
        if self.network.config.condition == "rgb":
            return batch["rgb"].permute(0, 3, 1, 2).float() / 127.5 - 1.0
        pixels = batch["pixels"].float()
        if not self.network.config.draft:
            return pixels
        # As Draft.planes has it.
        seen = self.network.encode(batch["draft_labels"], batch["draft_front"])
        seen[:, -1] /= self.network.config.front_amplitude
        return torch.cat([pixels, seen * batch["draft_known"][:, None]], dim=1)

    def _plan_grid(self, batch: Batch) -> Tensor | None:
        return None if self.network.config.condition == "rgb" else batch["grid"]

    def _compiled(self) -> Callable[[Batch], dict[str, Tensor]]:
        if self.device.type != "cuda":
            return self._losses
        return torch.compile(self._losses, dynamic=True)

    def _learning_rate(self) -> float:
        config = self.config
        if config.decay_every_steps:
            return config.learning_rate * 0.1 ** (self.step // config.decay_every_steps)
        # By the steps of the optimiser: a warm start has no moments to rely on.
        return config.learning_rate * warm_and_cool(
            self.weights.taken,
            config.warmup_steps,
            self.budget.share,
            config.cooldown_share,
            _END_RATE,
        )

    def _log(self, losses: dict[str, Tensor], report: Report) -> None:
        row = {
            "step": float(self.step),
            "images": float(self.step * self.config.batch * self.processes.count),
            "minutes": round(self.minutes_before + self.minutes, 2),
            "learning_rate": self._learning_rate(),
            **{name: round(float(value.detach()), 5) for name, value in losses.items()},
        }
        self.folder.mkdir(parents=True, exist_ok=True)
        path = self.folder / LOG_FILE
        fresh = not path.exists()
        with path.open("a", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, LOG_FIELDS, restval="", extrasaction="ignore")
            if fresh:
                writer.writeheader()
            writer.writerow(row)
        report(row)

    def _draw_sheet(self, stream: BatchStream) -> None:
        from chord_usd.workshop.training.sheets import SHEET_COLUMNS, draw_sheet

        path = self.folder / "sheets" / f"step_{self.step:07d}.png"
        draw_sheet(self.average, path, self.device, stream.held_out(SHEET_COLUMNS))
