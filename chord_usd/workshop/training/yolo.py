"""YOLOv8 as ultralytics builds it, to be trained: the only ultralytics file.

Networks are built from ultralytics' own yaml files and filled from safetensors; no pickle is read
and nothing is fetched. line/graph/detect.py runs them without ultralytics.
"""

from __future__ import annotations

import json
import logging
import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import cv2
import torch
from PIL import Image
from safetensors.torch import save_file
from torch import Tensor, nn

from chord_usd.base.errors import CheckpointError, Steps
from chord_usd.base.runtime.checksums import checkpoint_files
from chord_usd.base.runtime.networks import GRAPH_FILE, WEIGHTS_FILE, read_weights
from chord_usd.base.runtime.scratch import scratch_folder
from chord_usd.line.graph.detect import (
    CLASSES,
    CONFIG_FILE,
    FORMAT,
    IMAGE_PX,
    LEAST_SCORE,
    MOST_PROPOSALS,
    Kind,
    check_config,
    remedy,
)
from chord_usd.workshop.training.onnx_file import write_graph

ARCHITECTURES: dict[Kind, str] = {"items": "yolov8n-obb.yaml", "rooms": "yolov8n-seg.yaml"}

_REPLACED = ((Image, "open"), (cv2, "imread"), (cv2, "imwrite"), (cv2, "imshow"))
"""What ultralytics replaces when it is imported."""

_OVERLAP: dict[Kind, float] = {"items": 0.5, "rooms": 0.6}
"""Of two proposals of one class that overlap more than this, the weaker is dropped."""


def build_model(kind: Kind) -> nn.Module:
    """An untrained network, ready for model.loss(batch) with ultralytics' default gains."""
    tasks = _ultralytics().tasks
    network = {"items": tasks.OBBModel, "rooms": tasks.SegmentationModel}[kind]
    model: nn.Module = network(ARCHITECTURES[kind], ch=3, nc=len(CLASSES[kind]), verbose=False)
    model.args = _ultralytics().default_arguments
    return model


def save_model(kind: Kind, model: nn.Module, folder: Path, facts: Mapping[str, Any]) -> None:
    """Write weights (fp16), config.json and, once, the graph. facts: more keys of the config."""
    folder.mkdir(parents=True, exist_ok=True)
    with checkpoint_files(folder):
        tensors = {
            name: value.detach().cpu().to(torch.float16).contiguous()
            for name, value in _floats(model).items()
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
        if not (folder / GRAPH_FILE).is_file():
            write_detector_graph(kind, folder)


def load_weights(kind: Kind, model: nn.Module, folder: Path) -> None:
    """Fill model from folder. Raises CheckpointError when that cannot be done exactly."""
    check_config(kind, folder)
    tensors = _read_tensors(folder, remedy(kind))
    expected = _floats(model)
    wrong = [n for n in expected if n not in tensors or tensors[n].shape != expected[n].shape]
    if wrong or len(tensors) != len(expected):
        raise CheckpointError(
            f"{len(wrong) or len(tensors) - len(expected)} tensors do not fit the network",
            where=str(folder / WEIGHTS_FILE),
            expected=f"the weights of a {ARCHITECTURES[kind]}",
            try_=remedy(kind),
        )
    model.load_state_dict(tensors, strict=False)


def load_matching(model: nn.Module, folder: Path) -> int:
    """Fill what fits by name and shape from a checkpoint of either kind; returns how many tensors.

    Raises CheckpointError when the weights cannot be read.
    """
    tensors = _read_tensors(folder, "")
    state = model.state_dict()
    fitting = {n: v for n, v in tensors.items() if n in state and state[n].shape == v.shape}
    model.load_state_dict(fitting, strict=False)
    return len(fitting)


def write_detector_graph(kind: Kind, folder: Path) -> None:
    """Write the network.onnx of a checkpoint folder, suppression of doubles included."""
    model = build_model(kind)
    side = IMAGE_PX[kind]
    write_graph(
        folder,
        Proposing(kind, model.eval()),
        stored={f"model.model.{name}": name for name in _floats(model)},
        inputs={"rgb": torch.zeros((1, side, side, 3), dtype=torch.uint8)},
        outputs=("rows", "protos") if kind == "rooms" else ("rows",),
    )


class Proposing(nn.Module):
    """(1, H, W, 3) uint8 to ultralytics' proposals, best first; rows without a score behind."""

    def __init__(self, kind: Kind, model: Any) -> None:
        super().__init__()
        names = dict(enumerate(CLASSES[kind]))
        model.names, model.task = names, {"items": "obb", "rooms": "segment"}[kind]
        head = model.model[-1]
        head.export, head.format, head.dynamic, head.xyxy = True, "onnx", False, True
        head.max_det, head.agnostic_nms = MOST_PROPOSALS, False
        arguments = SimpleNamespace(
            format="onnx",
            nms=True,
            dynamic=False,
            batch=1,
            simplify=False,
            quantize=None,
            conf=LEAST_SCORE,
            iou=_OVERLAP[kind],
            max_det=MOST_PROPOSALS,
            agnostic_nms=False,
            opset=None,
        )
        self.model = _ultralytics().suppressing(model, arguments)

    def forward(self, rgb: Tensor) -> Tensor:
        """(1, H, W, 3) uint8 -> (1, MOST_PROPOSALS, 6 + extras), and mask prototypes of rooms."""
        return self.model(rgb.permute(0, 3, 1, 2).float() / 255.0)  # type: ignore[no-any-return]


def _floats(model: nn.Module) -> dict[str, Tensor]:
    """What a checkpoint keeps of a network: counters of batches are of no use."""
    return {n: v for n, v in model.state_dict().items() if v.is_floating_point()}


def _read_tensors(folder: Path, try_: Steps) -> dict[str, Tensor]:
    weights = read_weights(folder / WEIGHTS_FILE, try_)
    return {name: torch.from_numpy(value) for name, value in weights.items()}


@dataclass(frozen=True)
class _Library:
    """The parts of ultralytics in use."""

    tasks: Any
    default_arguments: Any
    suppressing: Any


@lru_cache(maxsize=1)
def _ultralytics() -> _Library:
    """Import ultralytics so that it stays silent, offline and out of the user's home folder.

    It replaces functions of Pillow and OpenCV for the whole process; one of them installs packages
    when a file is no picture. They are put back.
    """
    kept = [(module, name, getattr(module, name)) for module, name in _REPLACED]
    logging.getLogger("ultralytics").setLevel(logging.ERROR)
    settings = {"YOLO_OFFLINE": "true", "YOLO_VERBOSE": "false"}
    before = {name: os.environ.get(name) for name in (*settings, "YOLO_CONFIG_DIR")}
    with scratch_folder() as folder:
        os.environ.update(settings, YOLO_CONFIG_DIR=str(folder))
        try:
            import torchvision  # noqa: F401  the suppression imports it while it is traced
            from ultralytics.cfg import get_cfg
            from ultralytics.engine.exporter import NMSModel
            from ultralytics.nn import tasks
            from ultralytics.utils import LOGGER
        finally:
            for module, name, function in kept:
                setattr(module, name, function)
            for name, value in before.items():
                os.environ.pop(name, None)
                if value is not None:
                    os.environ[name] = value
    LOGGER.setLevel(logging.ERROR)
    return _Library(tasks, get_cfg(), NMSModel)
