"""How unlikely the layout model finds a layout: the noise-prediction error (CHOrD, section 5).

A layout is noised, the network says what noise it sees, and the squared error is averaged over
draws. It approximates the negative log-likelihood, so what is unlike the training data stands out,
pixel by pixel and piece by piece.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from chord_usd.base.raster import canvas
from chord_usd.base.scene.types import BoolArray, ByteArray, FloatArray, Item, PlanImage
from chord_usd.line.layout.denoiser import Plans
from chord_usd.line.layout.mosaic import Mosaic
from chord_usd.line.layout.sample import LayoutModel
from chord_usd.line.layout.schedule import State, alphas_cumprod, noised

ITEM_NOISE = (8.0, 16.0, 32.0)
"""Noise-to-signal ratios of the draws behind an item's score. Below, the network reads the item
off the noisy picture; above, it sees little but the plan. It parts moved items from others best
here: area under the curve 0.83, against 0.78 at 0.7 and 0.76 at 150."""


@dataclass(frozen=True, eq=False)
class Drawing:
    """A layout as labels over its plan."""

    plan_image: PlanImage
    labels: ByteArray
    """(H, W) as canvas.draw_items gives them."""
    front: BoolArray

    @classmethod
    def of(cls, plan_image: PlanImage, items: Sequence[Item]) -> Drawing:
        """These items over this plan."""
        return cls(plan_image, *canvas.draw_items(items, plan_image.frame))


class NoiseError:
    """Noise-prediction errors of one layout model."""

    def __init__(self, model: LayoutModel) -> None:
        self.model = model
        self._alphas = alphas_cumprod(model.config)
        self.noise_to_signal: FloatArray = np.sqrt((1.0 - self._alphas) / self._alphas)
        """(training_steps,) sigma/alpha of each training step, growing."""

    def time_of(self, noise_to_signal: float) -> int:
        """The training step whose noise-to-signal ratio is nearest, on a logarithmic scale."""
        return int(np.abs(np.log(self.noise_to_signal / noise_to_signal)).argmin())

    def maps(
        self, drawings: Sequence[Drawing], times: Sequence[int], seed: int = 0
    ) -> Iterator[npt.NDArray[np.float32]]:
        """For each time, (B, H, W) squared error of the predicted noise, mean over channels.

        drawings: of one batch. The noise of a time is shared by all of them, so that differences
        between layouts do not come from the noise. What is no floor has no error.
        """
        images = [drawing.plan_image for drawing in drawings]
        windows = self.model.windows(images)
        plans = self.model.plans(images, windows)
        clean = np.concatenate(
            [
                self._clean(drawing)[:, :, window[0], window[1]]
                for drawing, window in zip(drawings, windows, strict=True)
            ]
        )
        rng = np.random.default_rng(seed)
        for time in times:
            noise = rng.standard_normal(clean.shape[1:], np.float32)
            error = self._squared_error(clean, np.broadcast_to(noise, clean.shape), plans, time)
            inside = error * plans.inside[:, 0]
            maps = np.zeros((len(drawings), *drawings[0].labels.shape), np.float32)
            for whole, part, window in zip(maps, inside, windows, strict=True):
                whole[window] = part
            yield maps

    def _squared_error(
        self, clean: State, noise: State, plans: Plans | Mosaic, time: int
    ) -> npt.NDArray[np.float32]:
        noisy = noised(clean, noise, self._alphas[time])
        estimate = self.model.estimate(noisy, [time] * len(clean), plans)
        if estimate.clean is None:
            error = estimate.output - noise
        else:
            # A clean estimate that is off by d is a noise that is off by d · alpha / sigma.
            error = (clean - estimate.clean) / np.float32(self.noise_to_signal[time])
        return np.asarray((error**2).mean(axis=1), np.float32)

    def item_scores(
        self, plan_image: PlanImage, items: Sequence[Item], seed: int = 0
    ) -> dict[str, float]:
        """By item id, how far from the model's expectation it is; items without a pixel are out.

        The noise-prediction error in the item's pixels over the error of a model that expects
        bare floor there: 0 for an item that the model would paint exactly so, about 1 for one that
        it would not have put there, more where it expects another item.
        """
        drawing = Drawing.of(plan_image, items)
        times = [self.time_of(ratio) for ratio in ITEM_NOISE]
        error = sum(
            maps[0] * self.noise_to_signal[time] ** 2
            for time, maps in zip(times, self.maps([drawing], times, seed), strict=True)
        ) / len(times)
        bare = self._clean(Drawing.of(plan_image, []))
        contrast = ((self._clean(drawing) - bare) ** 2).mean(axis=1)[0]
        scores = {}
        for item in items:
            pixels = canvas.draw_items([item], plan_image.frame)[0] > 0
            expected = float(contrast[pixels].sum())
            if expected > 0.0:
                scores[item.id] = round(float(error[pixels].sum()) / expected, 3)
        return scores

    def _clean(self, drawing: Drawing) -> State:
        rgb = canvas.paint_layout(drawing.plan_image, drawing.labels, drawing.front)
        return self.model.encode(drawing.labels, drawing.front, rgb)
