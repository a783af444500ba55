"""What a layout model is made of; stored beside its weights."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, replace
from difflib import get_close_matches
from typing import Any, Literal, get_args, get_origin, get_type_hints

from chord_usd.base.errors import CheckpointError


@dataclass(frozen=True)
class LayoutConfig:
    """Architecture and noise schedule of a conditional layout model.

    The paper's own setting is PRESETS["paper"]; the shipped models are PRESETS["default"] and
    TABLE.
    """

    level: Literal["house", "table", "floor"] = "house"
    """What is laid out: furniture over a plan, items over the top view of a supporting piece, or
    rooms, walls and openings over an open plan or a blank sheet (levels.LEVELS)."""
    state: Literal["codes", "rgb"] = "codes"
    """What is diffused: one error-correcting code word per category, or the RGB raster itself."""
    condition: Literal["planes", "rgb"] = "planes"
    """What the network sees of the plan: masks and room measures, or the RGB raster itself."""
    prediction: Literal["sample", "epsilon"] = "sample"
    """Network output: category logits whose expectation is the clean sample, or the noise."""
    patch_px: int = 4
    """Side of the square of pixels that is folded into channels before the U-Net."""
    channels: tuple[int, ...] = (48, 96, 160, 224)
    """Width of each U-Net level, finest first."""
    attention: tuple[bool, ...] = (False, False, True, True)
    """Which levels attend over the whole house."""
    draft: bool = False
    """Whether the network sees a draft of the layout (layout.draft) beside the plan."""
    words: int = 0
    """How many words the network attends to, near its bottleneck (paper, supplementary, "Text-
    conditioned floor planning"); 0 for none."""
    word_channels: int = 0
    """Length of the vector that stands for a word."""
    programme: int = 0
    """How many of the words, the first ones, condition every block at every step as well: what
    all of a picture must agree on, like the number of bedrooms, is heard too late from attention
    near the bottleneck alone."""
    blocks_per_level: int = 1
    feature_channels: int = 64
    """Width between the U-Net and the 1×1 head."""
    schedule: Literal["log_snr", "linear"] = "log_snr"
    """log_snr: log noise-to-signal uniform in time; linear: DDPM's linear betas (paper)."""
    training_steps: int = 1000
    noise_to_signal: tuple[float, float] = (0.7, 150.0)
    """Smallest and largest sigma/alpha of the log_snr schedule. An item is hundreds of equal
    pixels, so noise hides it only when its standard deviation is many times the signal's."""
    front_amplitude: float = 1.0
    """Of the front mark's bit, in that of a code word's: as a bit like the others it is drowned by
    noise that leaves categories plain, and comes out torn."""
    default_steps: int = 20
    """Sampler steps unless asked otherwise."""
    default_sampler: Literal["ddim", "ddpm"] = "ddim"
    """Sampler unless asked otherwise."""

    @property
    def window_multiple_px(self) -> int:
        """What the sides of an image must be a multiple of: the fold and the U-Net's halvings."""
        return int(self.patch_px * 2 ** (len(self.channels) - 1))

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready mapping; from_dict reads it back."""
        return {
            key: list(value) if isinstance(value, tuple) else value
            for key, value in asdict(self).items()
        }

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> LayoutConfig:
        """Reads to_dict's mapping. Unknown keys raise CheckpointError and name the nearest one."""
        known = {field.name for field in fields(cls)}
        for key in values:
            if key not in known:
                near = get_close_matches(key, known, n=1)
                raise CheckpointError(
                    f"unknown configuration key '{key}'",
                    expected=f"'{near[0]}'" if near else f"one of {', '.join(sorted(known))}",
                    try_="a checkpoint of this version",
                )
        given: dict[str, Any] = {
            key: tuple(value) if isinstance(value, list) else value for key, value in values.items()
        }
        default, kinds = cls(), get_type_hints(cls)
        for key, value in given.items():
            choices = get_args(kinds[key]) if get_origin(kinds[key]) is Literal else (value,)
            if not _alike(value, getattr(default, key)) or value not in choices:
                raise CheckpointError(
                    f"configuration key '{key}' is {json.dumps(values[key])[:60]}",
                    expected=f"a value such as {json.dumps(default.to_dict()[key])}",
                    try_="copy the checkpoint again",
                )
        return cls(**given)


def _alike(value: Any, usual: Any) -> bool:
    """Whether a value is of the type of another, tuples member by member."""
    if isinstance(usual, tuple):
        return isinstance(value, tuple) and all(_alike(member, usual[0]) for member in value)
    if isinstance(usual, float):
        return type(value) in (int, float)
    return type(value) is type(usual)


FRONT_AMPLITUDE = 8**0.5
"""Sets front marks as far apart as code words, which differ in 8 bits."""

_SMALL = LayoutConfig(
    channels=(32, 48, 80, 112),
    attention=(False, False, False, True),
    feature_channels=32,
    draft=True,
    default_sampler="ddpm",
    front_amplitude=FRONT_AMPLITUDE,
)

PRESETS: dict[str, LayoutConfig] = {
    "default": LayoutConfig(draft=True, default_sampler="ddpm", front_amplitude=FRONT_AMPLITUDE),
    "large": LayoutConfig(
        front_amplitude=FRONT_AMPLITUDE,
        channels=(128, 192, 320, 448),
        blocks_per_level=2,
        feature_channels=128,
        default_sampler="ddpm",
    ),
    "paper": LayoutConfig(
        state="rgb",
        condition="rgb",
        prediction="epsilon",
        patch_px=1,
        channels=(128, 128, 256, 256, 512, 512),
        attention=(False, False, False, False, True, False),
        blocks_per_level=2,
        schedule="linear",
        default_steps=1000,
        default_sampler="ddpm",
    ),
    "small": _SMALL,
    "small-pure": replace(_SMALL, draft=False),
}
"""default: two CPU cores; large: a GPU; small, and small-pure, which sees no draft: some minutes of
one core, to compare ways of furnishing; paper: section 5 of the paper, 3 noise + 3 plan channels
in, 3 out, DDPM's U-Net and linear schedule at full resolution."""

FLOOR = LayoutConfig(
    level="floor", attention=(False, False, True, True), words=60, word_channels=448, programme=11
)
"""Floor plans from words, and from open plans: see words.py for what the words are."""

TABLE = LayoutConfig(level="table", default_steps=12)
"""Tabletops: built as the default, so that a layout model of houses can be the start (transfer)."""
