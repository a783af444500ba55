"""YOLOv8 on layout rasters: oriented boxes of items, masks of rooms. The only ultralytics file.

Networks are built from ultralytics' own yaml files and filled from safetensors; no pickle is read
and nothing is fetched. What they say is a proposal: snap.py takes the pixels' word over it.
"""

from __future__ import annotations

import json
import logging
import os
import tempfile
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import cv2
import numpy as np

from chord_usd.errors import CheckpointError
from chord_usd.locations import checkpoint_folder
from chord_usd.palette import HOUSE_CATEGORIES
from chord_usd.types import (
    CANVAS_PX,
    ROOM_KINDS,
    BoolArray,
    Box,
    ByteArray,
    Detection,
    FloatArray,
    PixelFrame,
    RoomKind,
    frozen_array,
)
from chord_usd.units import px_from_m

if TYPE_CHECKING:
    import torch

Kind = Literal["items", "rooms"]

ARCHITECTURES: dict[Kind, str] = {"items": "yolov8n-obb.yaml", "rooms": "yolov8n-seg.yaml"}
ROOM_CLASSES: tuple[RoomKind, ...] = tuple(kind for kind in ROOM_KINDS if kind != "unknown")
CLASSES: dict[Kind, tuple[str, ...]] = {
    "items": tuple(row.name for row in HOUSE_CATEGORIES),
    "rooms": ROOM_CLASSES,
}

IMAGE_PX: dict[Kind, int] = {"items": CANVAS_PX, "rooms": 192}
"""What the networks look at. Rooms are large: three quarters of the canvas cost half as much."""

LEAST_SIDE_PX = 8.0
"""Items are taught and proposed with boxes at least this long and wide.

A box must hold a point of the output grid to be proposed, and the finest grid has one every 8
pixels: of panels drawn at their true thickness, a pixel or two, most could not be told.
"""

WEIGHTS_FILE = "weights.safetensors"
CONFIG_FILE = "config.json"
FORMAT = 1

MIN_SCORE = 0.25
"""Proposals below this confidence are dropped (ultralytics' own default)."""
_ITEM_OVERLAP, _ROOM_OVERLAP = 0.5, 0.6
_MOST_PROPOSALS = 300


@dataclass(frozen=True, eq=False)
class RoomProposal:
    """One room the segmentation network sees."""

    kind: RoomKind
    score: float
    """[0, 1]."""
    mask: BoolArray
    """(CANVAS_PX, CANVAS_PX)."""


class ItemDetector:
    """Finds items as oriented boxes. Load with load_item_detector."""

    def __init__(self, model: torch.nn.Module) -> None:
        self._model = model

    def detect(self, rgb: ByteArray, min_score: float = MIN_SCORE) -> list[Detection]:
        """Proposals for a layout raster, (CANVAS_PX, CANVAS_PX, 3) uint8, best first.

        corners_px outline the box; which side is the front is not known here.
        """
        rows = self.raw(rgb[None], min_score)[0]
        return [
            Detection(
                category=HOUSE_CATEGORIES[int(row[5])].name,
                corners_px=frozen_array(_box_corners(row)),
                score=float(row[4]),
            )
            for row in rows
        ]

    def raw(self, rgb: ByteArray, min_score: float) -> list[FloatArray]:
        """For each raster of (B, H, W, 3): (N, 7) x, y, length, width, score, class, radians."""
        nms = _ultralytics().nms.non_max_suppression
        outputs = _forward(self._model, rgb)[0]
        found = nms(
            outputs,
            min_score,
            _ITEM_OVERLAP,
            max_det=_MOST_PROPOSALS,
            nc=len(HOUSE_CATEGORIES),
            rotated=True,
        )
        return [rows.cpu().numpy().astype(np.float64) for rows in found]


class RoomSegmenter:
    """Finds rooms and their kinds. Load with load_room_segmenter."""

    def __init__(self, model: torch.nn.Module) -> None:
        self._model = model

    def segment(self, rgb: ByteArray, min_score: float = MIN_SCORE) -> list[RoomProposal]:
        """Rooms of a layout or plan raster, (CANVAS_PX, CANVAS_PX, 3) uint8, best first."""
        return self.segment_batch(rgb[None], min_score)[0]

    def segment_batch(self, rgb: ByteArray, min_score: float) -> list[list[RoomProposal]]:
        """As segment, for (B, CANVAS_PX, CANVAS_PX, 3)."""
        import torch

        nms = _ultralytics().nms.non_max_suppression
        small = np.stack([scaled(one, IMAGE_PX["rooms"]) for one in rgb])
        (outputs, protos), _ = _forward(self._model, small)
        found = nms(
            outputs, min_score, _ROOM_OVERLAP, max_det=_MOST_PROPOSALS, nc=len(ROOM_CLASSES)
        )
        batch = []
        for rows, proto in zip(found, protos, strict=True):
            planes = torch.einsum("nc,chw->nhw", rows[:, 6:], proto)[:, None]
            masks = torch.nn.functional.interpolate(planes, CANVAS_PX, mode="bilinear")[:, 0] > 0
            boxes = rows[:, :4] * (CANVAS_PX / IMAGE_PX["rooms"])
            batch.append(
                [
                    RoomProposal(ROOM_CLASSES[int(row[5])], float(row[4]), _within(mask, box))
                    for row, mask, box in zip(
                        rows.cpu().numpy(), masks.cpu().numpy(), boxes.cpu().numpy(), strict=True
                    )
                ]
            )
        return batch


def taught_box(box: Box, frame: PixelFrame) -> FloatArray:
    """(5,) x, y, length, width, radians of an item on the canvas, as the network is taught it.

    Sides are LEAST_SIDE_PX at least; the angle is clockwise as seen, in [-pi/4, pi/4).
    """
    x, y = px_from_m(np.array(box.center_m[:2]), frame)
    length, width = (max(side / frame.m_per_px, LEAST_SIDE_PX) for side in box.size_m[:2])
    quarters, rest = divmod(-box.yaw_deg + 45.0, 90.0)
    if int(quarters) % 2:
        length, width = width, length
    return np.array([x, y, length, width, np.radians(rest - 45.0)])


def load_item_detector(folder: Path | None = None, device: str = "cpu") -> ItemDetector:
    """The detector in folder, by default the shipped one. Raises CheckpointError."""
    return ItemDetector(_load("items", folder, device))


def load_room_segmenter(folder: Path | None = None, device: str = "cpu") -> RoomSegmenter:
    """The segmenter in folder, by default the shipped one. Raises CheckpointError."""
    return RoomSegmenter(_load("rooms", folder, device))


def build_model(kind: Kind) -> torch.nn.Module:
    """An untrained network, ready for model.loss(batch) with ultralytics' default gains."""
    tasks = _ultralytics().tasks
    network = {"items": tasks.OBBModel, "rooms": tasks.SegmentationModel}[kind]
    model = network(ARCHITECTURES[kind], ch=3, nc=len(CLASSES[kind]), verbose=False)
    model.args = _ultralytics().default_arguments
    return model


def save_model(kind: Kind, model: torch.nn.Module, folder: Path, facts: dict[str, Any]) -> None:
    """Write weights (fp16) and config.json into folder. facts: further keys of the config."""
    import torch
    from safetensors.torch import save_file

    folder.mkdir(parents=True, exist_ok=True)
    tensors = {
        name: value.detach().cpu().to(torch.float16).contiguous()
        for name, value in model.state_dict().items()
        if value.is_floating_point()
    }
    save_file(tensors, folder / WEIGHTS_FILE)
    # safetensors leaves the file readable to its owner alone.
    (folder / WEIGHTS_FILE).chmod(0o644)
    config = {
        "format": FORMAT,
        "kind": kind,
        "architecture": ARCHITECTURES[kind],
        "classes": list(CLASSES[kind]),
        "image_px": IMAGE_PX[kind],
        **facts,
    }
    (folder / CONFIG_FILE).write_text(json.dumps(config, indent=2) + "\n", encoding="utf-8")


def load_weights(kind: Kind, model: torch.nn.Module, folder: Path) -> None:
    """Fill model from folder. Raises CheckpointError when that cannot be done exactly."""
    _check_config(kind, folder)
    _fill(kind, model, _read_tensors(folder / WEIGHTS_FILE, _remedy(kind)), folder)


def _fill(
    kind: Kind, model: torch.nn.Module, tensors: dict[str, torch.Tensor], folder: Path
) -> None:
    expected = {n: v for n, v in model.state_dict().items() if v.is_floating_point()}
    wrong = [n for n in expected if n not in tensors or tensors[n].shape != expected[n].shape]
    if wrong or len(tensors) != len(expected):
        raise CheckpointError(
            f"{len(wrong) or len(tensors) - len(expected)} tensors do not fit the network",
            where=str(folder / WEIGHTS_FILE),
            expected=f"the weights of a {ARCHITECTURES[kind]}",
            try_=_remedy(kind),
        )
    model.load_state_dict(tensors, strict=False)


def load_matching(model: torch.nn.Module, folder: Path) -> int:
    """Fill what fits by name and shape from a checkpoint of either kind; returns how many tensors.

    Raises CheckpointError when the weights cannot be read.
    """
    tensors = _read_tensors(folder / WEIGHTS_FILE, "")
    own = model.state_dict()
    fitting = {n: v for n, v in tensors.items() if n in own and own[n].shape == v.shape}
    model.load_state_dict(fitting, strict=False)
    return len(fitting)


def _read_tensors(path: Path, remedy: str) -> dict[str, torch.Tensor]:
    from safetensors import SafetensorError
    from safetensors.torch import load_file

    try:
        return load_file(path)
    except (OSError, SafetensorError) as error:
        raise CheckpointError(
            f"the weights cannot be read ({error})",
            where=str(path),
            expected="a safetensors file",
            try_=remedy,
        ) from error


def _remedy(kind: Kind) -> str:
    return f"pip install --force-reinstall chord-usd, or chord-usd train detector --kind {kind}"


def _check_config(kind: Kind, folder: Path) -> None:
    path = folder / CONFIG_FILE
    try:
        config = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise CheckpointError(
            f"the configuration cannot be read ({error})", where=str(path), try_=_remedy(kind)
        ) from error
    wanted = {"format": FORMAT, "kind": kind, "classes": list(CLASSES[kind])}
    for key, value in wanted.items():
        if not isinstance(config, dict) or config.get(key) != value:
            raise CheckpointError(
                f"'{key}' does not fit this version of chord-usd",
                where=str(path),
                expected=str(value),
                try_=_remedy(kind),
            )


def _load(kind: Kind, folder: Path | None, device: str) -> torch.nn.Module:
    name = f"detector_{kind}"
    try:
        folder = folder or checkpoint_folder(name)
        if not folder.is_dir():
            raise CheckpointError(f"there is no checkpoint {name!r}", where=str(folder))
    except CheckpointError as error:
        raise CheckpointError(
            error.what,
            where=error.where,
            expected=f"a folder with {WEIGHTS_FILE} and {CONFIG_FILE}",
            try_=_remedy(kind),
        ) from None
    import torch

    # Files first: what is wrong with them is told before a second goes into the network.
    _check_config(kind, folder)
    tensors = _read_tensors(folder / WEIGHTS_FILE, _remedy(kind))
    model = build_model(kind)
    _fill(kind, model, tensors, folder)
    model = model.fuse(verbose=False).eval().to(device)  # type: ignore[operator]
    # A third faster on a CPU, where convolutions want their channels last.
    return model.to(memory_format=torch.channels_last)  # type: ignore[no-any-return, call-overload]


def _forward(model: torch.nn.Module, rgb: ByteArray) -> Any:
    import torch

    device = next(model.parameters()).device
    with torch.inference_mode():
        images = torch.tensor(rgb, device=device).permute(0, 3, 1, 2)
        return model(images.float() / 255.0)


def scaled(rgb: ByteArray, side_px: int) -> ByteArray:
    """A square raster (H, H, 3) at another size; areas keep their mean colour."""
    if rgb.shape[0] == side_px:
        return rgb
    small = cv2.resize(rgb, (side_px, side_px), interpolation=cv2.INTER_AREA)
    return np.asarray(small, dtype=np.uint8)


def _within(mask: BoolArray, box: FloatArray) -> BoolArray:
    """The part of a mask (H, W) inside a box (4,) of x0, y0, x1, y1."""
    x0, y0, x1, y1 = np.clip(np.rint(box), 0, mask.shape[0]).astype(int)
    part = np.zeros_like(mask)
    part[y0:y1, x0:x1] = mask[y0:y1, x0:x1]
    return part


def _box_corners(row: FloatArray) -> FloatArray:
    x, y, length, width, _, _, radians = row
    cos, sin = np.cos(radians), np.sin(radians)
    own = np.array([[-1, -1], [-1, 1], [1, 1], [1, -1]]) * (length / 2, width / 2)
    return own @ np.array([[cos, sin], [-sin, cos]]) + (x, y)


@dataclass(frozen=True)
class _Library:
    """The parts of ultralytics in use."""

    tasks: Any
    nms: Any
    default_arguments: Any


@lru_cache(maxsize=1)
def _ultralytics() -> _Library:
    """Import ultralytics so that it stays silent, offline and out of the user's home folder."""
    logging.getLogger("ultralytics").setLevel(logging.ERROR)
    settings = {"YOLO_OFFLINE": "true", "YOLO_VERBOSE": "false"}
    before = {name: os.environ.get(name) for name in (*settings, "YOLO_CONFIG_DIR")}
    with tempfile.TemporaryDirectory() as folder:
        os.environ.update(settings, YOLO_CONFIG_DIR=folder)
        try:
            from ultralytics.cfg import get_cfg
            from ultralytics.nn import tasks
            from ultralytics.utils import LOGGER, nms
        finally:
            for name, value in before.items():
                os.environ.pop(name, None)
                if value is not None:
                    os.environ[name] = value
    LOGGER.setLevel(logging.ERROR)
    return _Library(tasks, nms, get_cfg())
