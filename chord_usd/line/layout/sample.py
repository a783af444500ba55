"""PlanImage -> LayoutImage: the reverse diffusion, of a whole house or of some of its floor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from chord_usd import __version__
from chord_usd.base.errors import CheckpointError
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.scene.types import (
    CANVAS_PX,
    BoolArray,
    ByteArray,
    LayoutImage,
    PlanImage,
    Provenance,
    frozen_array,
)
from chord_usd.line.layout.denoiser import Denoiser, Estimate, Plans, load_denoiser
from chord_usd.line.layout.draft import DRAFT_PLANES, STATE_CHANNELS, Draft, encode
from chord_usd.line.layout.known import bare_outside, bare_pixel, held_to_plan
from chord_usd.line.layout.levels import traits_of
from chord_usd.line.layout.mosaic import (
    Mosaic,
    Window,
    WindowSize,
    mosaic_of,
    window_of,
    window_size,
)
from chord_usd.line.layout.schedule import (
    WALKED,
    DiffusersSampler,
    Sampler,
    State,
    WrittenSampler,
    alphas_cumprod,
    noised,
    walk_of,
)

RGB_CHANNELS = 3

DRAFTED_SHARE = 0.1
"""Share of the walk's steps that are taken where a draft says what a house holds."""
MOSTLY = 0.99
"""Of the floor, to count as all of it: outlines are rounded to pixels."""


@dataclass(frozen=True, eq=False)
class _Kept:
    """What masked diffusion leaves alone."""

    clean: State
    """(B, C, H, W) clean state."""
    redrawn: BoolArray
    """(B, 1, H, W) bool: where it does not hold."""


class LayoutModel:
    """A trained layout model on a device. Make one with load; sampling is deterministic."""

    def __init__(self, denoiser: Denoiser) -> None:
        self.checkpoint = denoiser.description
        self.config = denoiser.description.config
        self.traits = traits_of(self.config)
        self.device = denoiser.device
        self._denoiser = denoiser
        self._alphas = alphas_cumprod(self.config)

    @classmethod
    def load(cls, folder: Path, device: str = "auto") -> LayoutModel:
        """Loads a checkpoint folder. device: auto, cpu or cuda.

        Raises CheckpointError for an unusable folder, ChordError where CUDA is asked for and
        absent.
        """
        return cls(load_denoiser(folder, device))

    def sample(
        self,
        plan_image: PlanImage,
        *,
        seed: int = 0,
        steps: int | None = None,
        sampler: str | None = None,
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
        sampler: str | None = None,
        drafts: Sequence[Draft | None] = (),
        progress: Progress | None = None,
    ) -> list[LayoutImage]:
        """One layout per plan and seed, in one batch; each is what sample would give it.

        sampler: one of schedule.SAMPLERS; by default the checkpoint's own. drafts: one per plan,
        or none; where one knows all floor, the walk begins late (DRAFTED_SHARE).
        """
        sizes = [self._window_size(plan_image) for plan_image in plan_images]
        pictures: dict[int, LayoutImage] = {}
        for size in dict.fromkeys(sizes):
            group = [index for index, other in enumerate(sizes) if other == size]
            run = self._run(
                [seeds[index] for index in group],
                steps,
                sampler,
                _share(progress, len(pictures), len(group), len(sizes)),
            )
            images = [plan_images[index] for index in group]
            windows = [window_of(image.rgb, size) for image in images]
            starts = [drafts[index] for index in group] if drafts else [None] * len(group)
            seen = self._seen(windows, starts)
            final = self._denoise(self.plans(images, windows, drafts=seen), run, None, seen)
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
        sampler: str | None = None,
        draft: Draft | None = None,
        progress: Progress | None = None,
    ) -> LayoutImage:
        """The layout of these labels, sampled again in a region of its floor: masked diffusion.

        labels, front: (H, W) as canvas.draw_items gives them; what they hold in the region is not
        looked at. region: (H, W). Outside of it every pixel is that of the layout given, which the
        noisy state follows at each step (Lugmayr et al., RePaint, 2022, without its repeats).
        draft: of the whole plan, what stays and what is to come; the walk begins late then.
        """
        run = self._run([seed], steps, sampler, progress)
        before = self.traits.paint(plan_image, labels, front)
        window = window_of(plan_image.rgb, self._window_size(plan_image))
        kept = _Kept(
            self.encode(labels[window], front[window], before[window]), region[window][None, None]
        )
        seen = self._seen([window], [draft])
        plans = self.plans([plan_image], [window], region[window], drafts=seen)
        final = self._denoise(plans, run, kept, seen)
        image = self._picture(plan_image, final[0], run, 0, [window])
        rgb = np.where(region[..., None], image.rgb, before)
        return LayoutImage(frozen_array(rgb, np.uint8), image.frame, image.provenance)

    def sample_labels(
        self,
        sheets: Sequence[PlanImage],
        words: State | None = None,
        *,
        seeds: Sequence[int],
        steps: int | None = None,
        progress: Progress | None = None,
    ) -> list[ByteArray]:
        """Label maps (H, W) of what is laid out on these sheets, which are of one size.

        words: (B, words, channels) for a network that attends to words. Raises CheckpointError
        where it was trained with other words.
        """
        if words is not None and words.shape[-1] != self.config.word_channels:
            raise CheckpointError(
                "the network was trained with another text model",
                expected=f"words of {self.config.word_channels} channels, not {words.shape[-1]}",
                try_="the checkpoint folder as training left it, its text_encoder within",
            )
        run = self._run(seeds, steps, None, progress)
        plans = self._described(
            [sheet.rgb for sheet in sheets], [sheet.frame.m_per_px for sheet in sheets]
        )
        final = self._denoise(replace(plans, words=words), run, kept=None)
        return list(final[:, :-1].argmax(axis=1).astype(np.uint8))

    def plans(
        self,
        plan_images: Sequence[PlanImage],
        windows: Sequence[Window] | None = None,
        region: BoolArray | None = None,
        drafts: Sequence[State] | None = None,
    ) -> Plans | Mosaic:
        """Plan rasters, or these windows of them, as what the network is conditioned on.

        Where they are larger than the canvas that the network was trained on it is shown parts of
        them. region: (H, W) of a window, the only floor that matters. drafts: (planes, H, W) of
        each window, for a network that sees drafts.
        """
        pictures = [image.rgb for image in plan_images]
        if windows:
            pictures = [rgb[window] for rgb, window in zip(pictures, windows, strict=True)]
        scales = [image.frame.m_per_px for image in plan_images]
        if max(pictures[0].shape[:2]) > CANVAS_PX and not self._sees_whole:
            multiple_px = self.config.window_multiple_px
            return mosaic_of(pictures, scales, multiple_px, self._described, region, drafts)
        return self._described(pictures, scales, drafts)

    def _described(
        self,
        pictures: Sequence[ByteArray],
        m_per_px: Sequence[float],
        drafts: Sequence[State] | None = None,
    ) -> Plans:
        cell = self.config.patch_px
        conditions = [
            self.traits.describe(rgb, scale, cell)
            for rgb, scale in zip(pictures, m_per_px, strict=True)
        ]
        masks = np.stack([condition.pixels for condition in conditions])
        inside = masks[:, self.traits.ground_plane, None] > 0
        if self.config.condition == "rgb":
            return Plans(np.stack([_as_state(rgb) for rgb in pictures]), None, inside)
        grid = np.stack([condition.grid for condition in conditions])
        pixels = masks.astype(np.float32)
        if self.config.draft:
            shape = (len(pixels), DRAFT_PLANES, *pixels.shape[2:])
            seen = np.zeros(shape, np.float32) if drafts is None else np.stack(drafts)
            pixels = np.concatenate([pixels, seen], axis=1)
        return Plans(pixels, grid, inside)

    def _seen(
        self, windows: Sequence[Window], drafts: Sequence[Draft | None]
    ) -> list[State] | None:
        """(planes, H, W) of each draft in its window; None where there is none at all."""
        if not any(drafts):
            return None
        traits, seen = self.traits, []
        for window, draft in zip(windows, drafts, strict=True):
            rows, columns = (part.stop - part.start for part in window)
            nothing = np.zeros((DRAFT_PLANES, rows, columns), np.float32)
            if draft is None:
                seen.append(nothing)
            else:
                planes = draft.planes(traits.class_count)
                seen.append(planes[:, *window])
        return seen

    def encode(self, labels: ByteArray, front: BoolArray, rgb: ByteArray) -> State:
        """(1, C, H, W) clean state of a layout: its code words, or its (H, W, 3) picture."""
        if self.config.state == "rgb":
            return _as_state(rgb)[None]
        traits = self.traits
        return encode(labels, front, traits.class_count, traits.front_amplitude)[None]

    def estimate(
        self, state: State, times: Sequence[int], plans: Plans | Mosaic, *, held: bool = False
    ) -> Estimate:
        """What the network says of a noisy batch (B, C, H, W); bare wherever there is no floor.

        held: to what the plan allows on the floor, too.
        """
        if isinstance(plans, Mosaic):
            look = partial(self.estimate, held=held)
            return plans.estimate(state, times, look, bare_pixel(self.traits))
        estimate = self._denoiser.estimate(state, times, plans)
        if held:
            return held_to_plan(estimate, plans, self.traits)
        return bare_outside(estimate, plans.inside, self.traits)

    def _drawn(self, drafts: Sequence[State]) -> State:
        """Clean states of what drafts show."""
        clean = np.stack(drafts)
        clean[:, -1] *= self.traits.front_amplitude
        return clean

    def _denoise(
        self,
        plans: Plans | Mosaic,
        run: _Run,
        kept: _Kept | None,
        drafts: Sequence[State] | None = None,
    ) -> State:
        """The reverse process; returns category and front logits, or the clean RGB state.

        Where a draft says something of all floor, the walk begins late, at the draft with noise.
        """
        sampler = self._sampler(run)
        noise = self._noise(run.seeds, *plans.inside.shape[-2:])
        levels = [float(self._alphas[time]) for time in sampler.times]
        first = _first_step(len(levels), plans.inside, drafts)
        state = noise
        if first and drafts is not None:
            state = noised(self._drawn(drafts), noise, levels[first])
        state = _held(state, noise, kept, levels[first])
        output = state
        for index in range(first, len(levels)):
            time, after = sampler.times[index], [*levels[1:], 1.0][index]
            estimate = self.estimate(state, [time] * len(state), plans, held=True)
            output = estimate.output
            prediction = output if estimate.clean is None else estimate.clean
            state = _held(sampler.step(prediction, index, state), noise, kept, after)
            if run.progress:
                run.progress(index + 1 - first, len(levels) - first)
        return state if self.config.state == "rgb" else output

    def _run(
        self,
        seeds: Sequence[int],
        steps: int | None,
        sampler: str | None,
        progress: Progress | None,
    ) -> _Run:
        """How a batch is sampled: as asked, else as the checkpoint was tuned for."""
        config = self.config
        return _Run(
            steps or config.default_steps,
            sampler or config.default_sampler,
            tuple(seeds),
            progress,
        )

    def _sampler(self, run: _Run) -> Sampler:
        walk = self.checkpoint.walk
        if run.sampler == self.config.default_sampler and run.steps == len(walk):
            return WrittenSampler(walk, run.seeds)
        if run.sampler in WALKED and self.config.prediction == "sample":
            walk = walk_of(self.config, run.sampler, run.steps)
            return WrittenSampler(walk, run.seeds)
        return DiffusersSampler(self.config, run.sampler, run.steps, run.seeds)

    def _noise(self, seeds: Sequence[int], height: int, width: int) -> State:
        """Noise is drawn per seed, so that neither batch size nor device changes it."""
        channels = RGB_CHANNELS if self.config.state == "rgb" else STATE_CHANNELS
        shape = (channels, height, width)
        return np.stack(
            [np.random.default_rng(seed).standard_normal(shape, np.float32) for seed in seeds]
        )

    def windows(self, plan_images: Sequence[PlanImage]) -> list[Window]:
        """What the network looks at of each raster: windows of one size that hold their houses."""
        sizes = np.array([self._window_size(image) for image in plan_images])
        height, width = (int(side) for side in sizes.max(axis=0))
        return [window_of(image.rgb, (height, width)) for image in plan_images]

    @property
    def _sees_whole(self) -> bool:
        return self.config.state == "rgb" or self.traits.whole

    def _window_size(self, plan_image: PlanImage) -> WindowSize:
        """What the network looks at: the house alone, or the whole canvas."""
        if self._sees_whole:
            height, width = plan_image.rgb.shape[:2]
            return height, width
        return window_size(plan_image.rgb, self.config.window_multiple_px)

    def _picture(
        self,
        plan_image: PlanImage,
        final: State,
        run: _Run,
        index: int,
        windows: Sequence[Window],
    ) -> LayoutImage:
        if self.config.state == "rgb":
            rgb = np.clip(np.rint((final + 1.0) * 127.5), 0, 255).astype(np.uint8)
            pixels = rgb.transpose(1, 2, 0)
        else:
            labels = np.zeros(plan_image.rgb.shape[:2], np.uint8)
            front = np.zeros(labels.shape, np.bool_)
            window = windows[index]
            labels[window] = final[:-1].argmax(axis=0)
            front[window] = (final[-1] > 0) & (labels[window] > 0)
            pixels = self.traits.paint(plan_image, labels, front)
        provenance = Provenance(
            checkpoint_hash=self.checkpoint.content_hash,
            seed=run.seeds[index],
            version=__version__,
            configuration={"steps": run.steps, "sampler": run.sampler},
        )
        return LayoutImage(frozen_array(pixels, np.uint8), plan_image.frame, provenance)


@dataclass(frozen=True)
class _Run:
    """How one batch is sampled."""

    steps: int
    sampler: str
    seeds: tuple[int, ...]
    progress: Progress | None


def _first_step(steps: int, inside: BoolArray, drafts: Sequence[State] | None) -> int:
    """Which step of the walk is the first: a later one where drafts know all floor."""
    if drafts is None:
        return 0
    known = (np.stack(drafts) != 0).any(axis=1, keepdims=True)
    late = min(round(steps * (1.0 - DRAFTED_SHARE)), steps - 1)
    return late if known[inside].mean() > MOSTLY else 0


def _held(state: State, noise: State, kept: _Kept | None, alpha: float) -> State:
    """The state with what is kept at the noise level alpha, which is 1 after the last step."""
    if kept is None:
        return state
    return np.where(kept.redrawn, state, noised(kept.clean, noise, alpha))


def _as_state(rgb: ByteArray) -> State:
    """(H, W, 3) picture to (3, H, W) in [-1, 1]."""
    return np.ascontiguousarray(rgb.transpose(2, 0, 1).astype(np.float32) / 127.5 - 1.0)


def _share(progress: Progress | None, before: int, part: int, count: int) -> Progress | None:
    """Progress of a part of the pictures as progress of them all."""
    if progress is None:
        return None
    return lambda done, steps: progress(before * steps + part * done, count * steps)
