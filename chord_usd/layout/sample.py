"""PlanImage -> LayoutImage: the reverse diffusion, of a whole house or of some of its floor."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from chord_usd import __version__
from chord_usd.layout.checkpoint import Checkpoint, load_checkpoint
from chord_usd.layout.codes import STATE_CHANNELS
from chord_usd.layout.device import choose_device, half_precision
from chord_usd.layout.levels import traits_of
from chord_usd.layout.network import RGB_CHANNELS
from chord_usd.layout.schedule import sampling_scheduler
from chord_usd.layout.window import Window, WindowSize, window_of, window_size
from chord_usd.raster import paint_layout
from chord_usd.types import (
    BoolArray,
    ByteArray,
    LayoutImage,
    PlanImage,
    Provenance,
    frozen_array,
)

Progress = Callable[[int, int], None]


@dataclass(frozen=True, eq=False)
class Plans:
    """A batch of plans as tensors."""

    pixels: Tensor
    grid: Tensor | None
    inside: Tensor
    """(B, 1, H, W) floor; items exist nowhere else."""


@dataclass(frozen=True, eq=False)
class _Kept:
    """What masked diffusion leaves alone."""

    clean: Tensor
    """(B, C, H, W) clean state."""
    redrawn: Tensor
    """(B, 1, H, W) bool: where it does not hold."""


class LayoutModel:
    """A trained layout model on a device. Make one with load; sampling is deterministic."""

    def __init__(self, checkpoint: Checkpoint, device: str = "cpu", *, full: bool = False) -> None:
        """full: float32 throughout, also where bfloat16 would be faster."""
        self.checkpoint = checkpoint
        self.config = checkpoint.config
        self.traits = traits_of(checkpoint.config)
        self.device = device
        self._full = full
        checkpoint.network.to(memory_format=torch.channels_last)  # type: ignore[call-overload]

    @classmethod
    def load(cls, folder: Path, device: str = "auto") -> LayoutModel:
        """Loads a checkpoint folder. device: auto, cpu or cuda.

        Raises CheckpointError for an unusable folder, ChordError where CUDA is asked for and
        absent.
        """
        chosen = choose_device(device)
        return cls(load_checkpoint(folder, chosen), chosen)

    def sample(
        self,
        plan_image: PlanImage,
        *,
        seed: int = 0,
        steps: int | None = None,
        sampler: str = "ddim",
        progress: Progress | None = None,
    ) -> LayoutImage:
        """One layout for one plan. The same plan, seed and steps give the same pixels."""
        return self.sample_batch(
            [plan_image], seeds=[seed], steps=steps, sampler=sampler, progress=progress
        )[0]

    def sample_batch(
        self,
        plan_images: Sequence[PlanImage],
        *,
        seeds: Sequence[int],
        steps: int | None = None,
        sampler: str = "ddim",
        progress: Progress | None = None,
    ) -> list[LayoutImage]:
        """One layout per plan and seed, in one batch; each is what sample would give it.

        sampler: one of schedule.SAMPLERS.
        """
        sizes = [self._window_size(plan_image) for plan_image in plan_images]
        pictures: dict[int, LayoutImage] = {}
        for size in dict.fromkeys(sizes):
            group = [index for index, other in enumerate(sizes) if other == size]
            run = _Run(
                steps or self.config.default_steps,
                sampler,
                tuple(seeds[index] for index in group),
                _share(progress, len(pictures), len(group), len(sizes)),
            )
            images = [plan_images[index] for index in group]
            windows = [window_of(image.rgb, size) for image in images]
            final = self._denoise(self.plans(images, windows), run, kept=None)
            for place, index in enumerate(group):
                pictures[index] = self._picture(images[place], final[place], run, place, windows)
        return [pictures[index] for index in range(len(sizes))]

    def resample(
        self,
        plan_image: PlanImage,
        labels: ByteArray,
        front: BoolArray,
        region: BoolArray,
        *,
        seed: int = 0,
        steps: int | None = None,
        sampler: str = "ddim",
        progress: Progress | None = None,
    ) -> LayoutImage:
        """The layout of these labels, sampled anew in a region of its floor: masked diffusion.

        labels, front: (H, W) as raster.draw_items gives them; what they hold in the region is not
        looked at. region: (H, W). Outside of it every pixel is that of the layout given, which the
        noisy state follows at each step (Lugmayr et al., RePaint, 2022, without its repeats).
        """
        run = _Run(steps or self.config.default_steps, sampler, (seed,), progress)
        before = paint_layout(plan_image, labels, front, self.traits.level)
        window = window_of(plan_image.rgb, self._window_size(plan_image))
        kept = _Kept(
            self.encode(labels[window], front[window], before[window]),
            torch.from_numpy(region[window].copy())[None, None].to(self.device),
        )
        final = self._denoise(self.plans([plan_image], [window]), run, kept)
        image = self._picture(plan_image, final[0], run, 0, [window])
        rgb = np.where(region[..., None], image.rgb, before)
        return LayoutImage(frozen_array(rgb, np.uint8), image.frame, image.provenance)

    def plans(
        self, plan_images: Sequence[PlanImage], windows: Sequence[Window] | None = None
    ) -> Plans:
        """Plan rasters, or these windows of them, as what the network is conditioned on."""
        cell = self.config.patch_px
        pictures = [image.rgb for image in plan_images]
        if windows:
            pictures = [rgb[window] for rgb, window in zip(pictures, windows, strict=True)]
        conditions = [
            self.traits.describe(rgb, image.frame.m_per_px, cell)
            for rgb, image in zip(pictures, plan_images, strict=True)
        ]
        masks = torch.from_numpy(np.stack([condition.pixels for condition in conditions]))
        inside = masks[:, self.traits.ground_plane, None].to(self.device, torch.float32)
        if self.config.condition == "rgb":
            rgb = torch.from_numpy(np.stack(pictures))
            pixels = rgb.permute(0, 3, 1, 2).to(self.device, torch.float32) / 127.5 - 1.0
            return Plans(pixels, None, inside)
        grid = torch.from_numpy(np.stack([condition.grid for condition in conditions]))
        return Plans(masks.to(self.device, torch.float32), grid.to(self.device), inside)

    def encode(self, labels: ByteArray, front: BoolArray, rgb: ByteArray) -> Tensor:
        """(1, C, H, W) clean state of a layout: its code words, or its (H, W, 3) picture."""
        if self.config.state == "rgb":
            picture = torch.from_numpy(rgb.copy()).permute(2, 0, 1)[None]
            return picture.to(self.device, torch.float32) / 127.5 - 1.0
        marks = torch.from_numpy(front & (labels > 0))[None].to(self.device)
        names = torch.from_numpy(labels.astype(np.int64))[None].to(self.device)
        return self.checkpoint.network.encode(names, marks)

    def predict(self, state: Tensor, times: Tensor, plans: Plans) -> Tensor:
        """The network's output for a noisy batch, float32 (network.LayoutNetwork.forward)."""
        with nullcontext() if self._full else half_precision(self.device):
            output = self.checkpoint.network(state, times, plans.pixels, plans.grid)
        return output.float()

    def clean_estimate(self, output: Tensor, plans: Plans) -> Tensor:
        """The clean state that category logits stand for: bare wherever there is no floor."""
        expected = self.checkpoint.network.expected_state(output)
        return torch.where(plans.inside > 0, expected, self._bare_floor(output))

    @torch.inference_mode()
    def _denoise(self, plans: Plans, run: _Run, kept: _Kept | None) -> Tensor:
        """The reverse process; returns category and front logits, or the clean RGB state."""
        scheduler = sampling_scheduler(self.config, run.sampler)
        scheduler.set_timesteps(run.steps, device=self.device)
        noise = self._noise(run.seeds, *plans.pixels.shape[-2:])
        times = [*scheduler.timesteps, None]
        state = self._held(noise, noise, kept, scheduler, times[0])
        output = state
        for done, (time, after) in enumerate(pairwise(times), start=1):
            output = self.predict(state, time.expand(len(state)), plans)
            sample = output if self.config.state == "rgb" else self.clean_estimate(output, plans)
            stepped = scheduler.step(sample, time, state, **run.randomness()).prev_sample
            state = self._held(stepped, noise, kept, scheduler, after)
            if run.progress:
                run.progress(done, run.steps)
        if self.config.state == "rgb":
            return state
        return torch.where(plans.inside > 0, output, self._nothing())

    @staticmethod
    def _held(
        state: Tensor, noise: Tensor, kept: _Kept | None, scheduler: Any, time: Tensor | None
    ) -> Tensor:
        """The state with what is kept at its own noise level, which is none after the last step."""
        if kept is None:
            return state
        held = kept.clean
        if time is not None:
            held = scheduler.add_noise(kept.clean, noise, time.reshape(1))
        return torch.where(kept.redrawn, state, held)

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

    def _bare_floor(self, like: Tensor) -> Tensor:
        labels = torch.zeros((1, *like.shape[-2:]), dtype=torch.long, device=like.device)
        return self.checkpoint.network.encode(labels, labels > 0)

    def _nothing(self) -> Tensor:
        """(1, classes + 1, 1, 1) logits of the bare ground without a front mark."""
        logits = torch.full((1, self.traits.class_count + 1, 1, 1), -50.0, device=self.device)
        logits[:, 0] = 50.0
        return logits

    def windows(self, plan_images: Sequence[PlanImage]) -> list[Window]:
        """What the network looks at of each raster: windows of one size that hold their houses."""
        sizes = np.array([self._window_size(image) for image in plan_images])
        height, width = (int(side) for side in sizes.max(axis=0))
        return [window_of(image.rgb, (height, width)) for image in plan_images]

    def _window_size(self, plan_image: PlanImage) -> WindowSize:
        """What the network looks at: the house alone, but the paper's network the whole canvas."""
        if self.config.state == "rgb":
            height, width = plan_image.rgb.shape[:2]
            return height, width
        return window_size(plan_image.rgb, self.config.window_multiple_px)

    def _picture(
        self,
        plan_image: PlanImage,
        final: Tensor,
        run: _Run,
        index: int,
        windows: Sequence[Window],
    ) -> LayoutImage:
        if self.config.state == "rgb":
            rgb = ((final + 1.0) * 127.5).round().clamp(0, 255).byte()
            pixels = rgb.permute(1, 2, 0).cpu().numpy()
        else:
            labels = np.zeros(plan_image.rgb.shape[:2], np.uint8)
            front = np.zeros(labels.shape, np.bool_)
            window = windows[index]
            labels[window] = final[:-1].argmax(dim=0).cpu().numpy()
            front[window] = (final[-1] > 0).cpu().numpy() & (labels[window] > 0)
            pixels = paint_layout(plan_image, labels, front, self.traits.level)
        provenance = Provenance(
            checkpoint_hash=self.checkpoint.content_hash,
            seed=run.seeds[index],
            version=__version__,
            configuration={"steps": run.steps, "sampler": run.sampler},
        )
        return LayoutImage(frozen_array(pixels, np.uint8), plan_image.frame, provenance)


class _Run:
    """How one batch is sampled."""

    def __init__(
        self, steps: int, sampler: str, seeds: tuple[int, ...], progress: Progress | None
    ) -> None:
        self.steps, self.sampler, self.seeds, self.progress = steps, sampler, seeds, progress
        # Ancestral sampling draws noise at every step: from its own generators, per picture.
        self._generators = [torch.Generator().manual_seed(seed + 2**32) for seed in seeds]

    def randomness(self) -> dict[str, Any]:
        """What scheduler.step needs so that it never draws from torch's global generator."""
        return {"generator": self._generators} if self.sampler == "ddpm" else {}


def _share(progress: Progress | None, before: int, part: int, count: int) -> Progress | None:
    """Progress of a part of the pictures as progress of them all."""
    if progress is None:
        return None
    return lambda done, steps: progress(before * steps + part * done, count * steps)
