"""PlanImage -> LayoutImage: the reverse diffusion."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from chord_usd import __version__
from chord_usd.errors import ChordError
from chord_usd.layout.checkpoint import Checkpoint, load_checkpoint
from chord_usd.layout.codes import STATE_CHANNELS
from chord_usd.layout.condition import FLOOR_PLANE, plan_condition
from chord_usd.layout.network import RGB_CHANNELS
from chord_usd.layout.schedule import sampling_scheduler
from chord_usd.raster import paint_layout
from chord_usd.types import LayoutImage, PlanImage, Provenance, frozen_array

Progress = Callable[[int, int], None]


@dataclass(frozen=True, eq=False)
class _Plans:
    """A batch of plans as tensors."""

    pixels: Tensor
    grid: Tensor | None
    inside: Tensor
    """(B, 1, H, W) floor; items exist nowhere else."""


class LayoutModel:
    """A trained layout model on a device. Make one with load; sampling is deterministic."""

    def __init__(self, checkpoint: Checkpoint, device: str = "cpu") -> None:
        self.checkpoint = checkpoint
        self.config = checkpoint.config
        self.device = device

    @classmethod
    def load(cls, folder: Path, device: str = "auto") -> LayoutModel:
        """Loads a checkpoint folder. device: auto, cpu or cuda.

        Raises CheckpointError for an unusable folder, ChordError where CUDA is asked for and
        absent.
        """
        chosen = _device(device)
        return cls(load_checkpoint(folder, chosen), chosen)

    def sample(
        self,
        plan_image: PlanImage,
        *,
        seed: int = 0,
        steps: int | None = None,
        progress: Progress | None = None,
    ) -> LayoutImage:
        """One layout for one plan. The same plan, seed and steps give the same pixels."""
        return self.sample_batch([plan_image], seeds=[seed], steps=steps, progress=progress)[0]

    def sample_batch(
        self,
        plan_images: Sequence[PlanImage],
        *,
        seeds: Sequence[int],
        steps: int | None = None,
        progress: Progress | None = None,
    ) -> list[LayoutImage]:
        """One layout per plan and seed, in one batch; each is what sample would give it."""
        steps = steps or self.config.default_steps
        plans = self._plans(plan_images)
        noise = self._noise(seeds, *plans.pixels.shape[-2:])
        with torch.inference_mode():
            final = self._denoise(plans, noise, steps, progress)
        return [
            self._picture(plan_image, final[index], seed, steps)
            for index, (plan_image, seed) in enumerate(zip(plan_images, seeds, strict=True))
        ]

    def _plans(self, plan_images: Sequence[PlanImage]) -> _Plans:
        cell = self.config.patch_px
        conditions = [
            plan_condition(image.rgb, image.frame.m_per_px, cell) for image in plan_images
        ]
        masks = torch.from_numpy(np.stack([condition.pixels for condition in conditions]))
        inside = masks[:, FLOOR_PLANE : FLOOR_PLANE + 1].to(self.device, torch.float32)
        if self.config.condition == "rgb":
            rgb = torch.from_numpy(np.stack([image.rgb for image in plan_images]))
            pixels = rgb.permute(0, 3, 1, 2).to(self.device, torch.float32) / 127.5 - 1.0
            return _Plans(pixels, None, inside)
        grid = torch.from_numpy(np.stack([condition.grid for condition in conditions]))
        return _Plans(masks.to(self.device, torch.float32), grid.to(self.device), inside)

    def _noise(self, seeds: Sequence[int], height: int, width: int) -> Tensor:
        """Noise is drawn per seed on the CPU, so that batch size and device do not change it."""
        channels = RGB_CHANNELS if self.config.state == "rgb" else STATE_CHANNELS
        return torch.stack(
            [
                torch.randn(
                    (channels, height, width), generator=torch.Generator().manual_seed(seed)
                )
                for seed in seeds
            ]
        ).to(self.device)

    def _denoise(
        self, plans: _Plans, state: Tensor, steps: int, progress: Progress | None
    ) -> Tensor:
        """The reverse process; returns category and front logits, or the clean RGB state."""
        network = self.checkpoint.network
        scheduler = sampling_scheduler(self.config)
        scheduler.set_timesteps(steps, device=self.device)
        bare = self._bare_floor(state)
        output = state
        for done, time in enumerate(scheduler.timesteps, start=1):
            output = network(state, time.expand(len(state)), plans.pixels, plans.grid)
            sample = output
            if self.config.state == "codes":
                sample = torch.where(plans.inside > 0, network.expected_state(output), bare)
            state = scheduler.step(sample, time, state).prev_sample
            if progress:
                progress(done, steps)
        if self.config.state == "rgb":
            return state
        return torch.where(plans.inside > 0, output, _NOTHING)

    def _bare_floor(self, state: Tensor) -> Tensor:
        if self.config.state == "rgb":
            return state
        labels = torch.zeros((1, *state.shape[-2:]), dtype=torch.long, device=state.device)
        return self.checkpoint.network.encode(labels, labels > 0)

    def _picture(self, plan_image: PlanImage, final: Tensor, seed: int, steps: int) -> LayoutImage:
        if self.config.state == "rgb":
            rgb = ((final + 1.0) * 127.5).round().clamp(0, 255).byte()
            pixels = rgb.permute(1, 2, 0).cpu().numpy()
        else:
            labels = final[:-1].argmax(dim=0).cpu().numpy().astype(np.uint8)
            front = (final[-1] > 0).cpu().numpy() & (labels > 0)
            pixels = paint_layout(plan_image, labels, front)
        provenance = Provenance(
            checkpoint_hash=self.checkpoint.content_hash,
            seed=seed,
            version=__version__,
            configuration={"steps": steps, "sampler": "ddim"},
        )
        return LayoutImage(frozen_array(pixels, np.uint8), plan_image.frame, provenance)


_NOTHING = torch.cat([torch.full((1,), 50.0), torch.full((29,), -50.0)])[None, :, None, None]
"""Logits of bare floor without a front mark."""


def _device(name: str) -> str:
    has_cuda = torch.cuda.is_available()
    if name == "auto":
        return "cuda" if has_cuda else "cpu"
    if name.startswith("cuda") and not has_cuda:
        raise ChordError(
            "no CUDA device here", where=f"--device {name}", try_="--device cpu or --device auto"
        )
    return name
