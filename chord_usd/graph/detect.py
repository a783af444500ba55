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

import numpy as np

from chord_usd.errors import CheckpointError
from chord_usd.locations import checkpoint_folder
from chord_usd.palette import HOUSE_CATEGORIES
from chord_usd.types import (
    CANVAS_PX,
    ROOM_KINDS,
    BoolArray,
    ByteArray,
    Detection,
    FloatArray,
    RoomKind,
    frozen_array,
)

if TYPE_CHECKING:
    import torch

Kind = Literal["items", "rooms"]

ARCHITECTURES: dict[Kind, str] = {"items": "yolov8n-obb.yaml", "rooms": "yolov8n-seg.yaml"}
ROOM_CLASSES: tuple[RoomKind, ...] = tuple(kind for kind in ROOM_KINDS if kind != "unknown")
CLASSES: dict[Kind, tuple[str, ...]] = {
    "items": tuple(row.name for row in HOUSE_CATEGORIES),
    "rooms": ROOM_CLASSES,
}

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
        library = _ultralytics()
        (outputs, protos), _ = _forward(self._model, rgb)
        found = library.nms.non_max_suppression(
            outputs, min_score, _ROOM_OVERLAP, max_det=_MOST_PROPOSALS, nc=len(ROOM_CLASSES)
        )
        batch = []
        for rows, proto in zip(found, protos, strict=True):
            masks = library.ops.process_mask(
                proto, rows[:, 6:], rows[:, :4], rgb.shape[1:3], upsample=True
            )
            batch.append(
                [
                    RoomProposal(ROOM_CLASSES[int(row[5])], float(row[4]), mask.cpu().numpy() > 0)
                    for row, mask in zip(rows, masks, strict=True)
                ]
            )
        return batch


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
        "image_px": CANVAS_PX,
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
    # Files first: what is wrong with them is told before a second goes into the network.
    _check_config(kind, folder)
    tensors = _read_tensors(folder / WEIGHTS_FILE, _remedy(kind))
    model = build_model(kind)
    _fill(kind, model, tensors, folder)
    return model.fuse(verbose=False).eval().to(device)  # type: ignore[operator]


def _forward(model: torch.nn.Module, rgb: ByteArray) -> Any:
    import torch

    device = next(model.parameters()).device
    with torch.inference_mode():
        images = torch.from_numpy(np.ascontiguousarray(rgb.transpose(0, 3, 1, 2))).to(device)
        return model(images.float() / 255.0)


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
    ops: Any
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
            from ultralytics.utils import LOGGER, nms, ops
        finally:
            for name, value in before.items():
                os.environ.pop(name, None)
                if value is not None:
                    os.environ[name] = value
    LOGGER.setLevel(logging.ERROR)
    return _Library(tasks, nms, ops, get_cfg())
