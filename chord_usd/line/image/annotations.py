"""What machines learn from: camera matrices, boxes and COCO, from a camera and its mask."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from chord_usd.base.scene.label_sets import OWN, class_of, classes_of
from chord_usd.base.scene.palette import CATEGORIES, DRESSING_CATEGORIES
from chord_usd.line.image.marks import Thing
from chord_usd.line.image.stage_cameras import StageCamera

MaskArray = npt.NDArray[np.uint16]

BUILDING = ("floor", "ceiling", "passage", "skirting", "facade", "walltop")
"""Labels of a house's parts that the paper has no colour for."""

_DRESSING = [row.name for row in DRESSING_CATEGORIES]
_KNOWN = tuple(
    dict.fromkeys((*(name for name in CATEGORIES if name not in _DRESSING), *BUILDING, *_DRESSING))
)
"""Their place from 1 on is their category id, the same in every house; new ones go to the end."""

_CV_FROM_USD = np.diag([1.0, -1.0, -1.0, 1.0])
"""OpenCV's cameras have y down and look along z."""


def category_ids(labels: Iterable[str]) -> dict[str, int]:
    """Category id of each label; unknown ones follow behind the known, in alphabetical order."""
    wanted = set(labels)
    strange = sorted(wanted - set(_KNOWN))
    return {
        label: number
        for number, label in enumerate((*_KNOWN, *strange), start=1)
        if label in wanted
    }


def semantic_mask(numbers: MaskArray, things: Sequence[Thing]) -> MaskArray:
    """(H, W) category ids from the numbers of things; 0 stays 0."""
    ids = category_ids(thing.label for thing in things)
    table = np.zeros(len(things) + 1, dtype=np.uint16)
    for thing in things:
        table[thing.number] = ids[thing.label]
    return table[numbers]


def intrinsics_px(view: StageCamera, size_px: tuple[int, int]) -> list[list[float]]:
    """(3, 3) camera matrix for square pixels, the centre of the first one at (0.5, 0.5).

    Of an orthographic camera the focal length is pixels per metre.
    """
    width_px, height_px = size_px
    focal = (1.0 if view.orthographic else view.focal_m) / view.aperture_m * width_px
    right, up = (width_px * shift for shift in view.shift)
    return [[focal, 0.0, width_px / 2 - right], [0.0, focal, height_px / 2 + up], [0.0, 0.0, 1.0]]


def camera_record(view: StageCamera, size_px: tuple[int, int]) -> dict[str, Any]:
    """A camera as plain values: intrinsics in pixels, extrinsics in metres."""
    to_world = np.array(view.matrix)
    return {
        "name": view.name,
        "room": view.room,
        "projection": "orthographic" if view.orthographic else "perspective",
        "width_px": size_px[0],
        "height_px": size_px[1],
        "intrinsics_px": intrinsics_px(view, size_px),
        # x right, y up, looks along -z; the world is Z up
        "camera_to_world": to_world.tolist(),
        # x right, y down, looks along z, as OpenCV has it
        "world_to_camera_cv": (_CV_FROM_USD @ np.linalg.inv(to_world)).tolist(),
    }


def thing_records(numbers: MaskArray, things: Sequence[Thing]) -> list[dict[str, Any]]:
    """The things that are seen: number, prim, label, box in the picture and box in the world."""
    ids = category_ids(thing.label for thing in things)
    return [
        {
            "id": thing.number,
            "path": thing.path,
            "label": thing.label,
            "category_id": ids[thing.label],
            "room": thing.room,
            "area_px": area,
            "box_px": box,
            "box_m": {"matrix": [list(row) for row in thing.matrix], "size_m": list(thing.size_m)},
        }
        for thing, area, box in _seen(numbers, things)
    ]


def _seen(
    numbers: MaskArray, things: Sequence[Thing]
) -> Iterable[tuple[Thing, int, tuple[int, int, int, int]]]:
    """Things with their area and their box (left, top, width, height), in pixels."""
    areas = np.bincount(numbers.ravel(), minlength=len(things) + 1)
    for thing in things:
        if areas[thing.number]:
            rows, columns = np.nonzero(numbers == thing.number)
            left, top = int(columns.min()), int(rows.min())
            box = (left, top, int(columns.max()) - left + 1, int(rows.max()) - top + 1)
            yield thing, int(areas[thing.number]), box


def coco(
    pictures: Sequence[tuple[str, dict[str, Any], MaskArray]], label_set: str = OWN
) -> dict[str, Any]:
    """A COCO data set of pictures: (file name, sidecar, (H, W) instance mask) each.

    label_set: one of scene.label_sets. In others than OWN, `categories` holds all classes of the
    set, seen or not, and things that it has no class for are left out.
    """
    images: list[dict[str, Any]] = []
    annotations: list[dict[str, Any]] = []
    categories = {} if label_set == OWN else classes_of(label_set)
    for image_id, (file_name, sidecar, numbers) in enumerate(pictures, start=1):
        height, width = numbers.shape
        images.append({"id": image_id, "file_name": file_name, "width": width, "height": height})
        for thing in sidecar["instances"]:
            if label_set == OWN:
                name = thing["label"]
                categories[name] = thing["category_id"]
            elif (name := class_of(thing["label"], label_set)) is None:
                continue
            annotations.append(
                {
                    "id": len(annotations) + 1,
                    "image_id": image_id,
                    "category_id": categories[name],
                    "bbox": thing["box_px"],
                    "area": thing["area_px"],
                    "segmentation": run_lengths(numbers == thing["id"]),
                    "iscrowd": 0,
                    "prim_path": thing["path"],
                }
            )
    ordered = sorted(categories.items(), key=lambda named: named[1])
    named = [{"id": number, "name": name} for name, number in ordered]
    return {"images": images, "annotations": annotations, "categories": named}


def run_lengths(mask: npt.NDArray[np.bool_]) -> dict[str, Any]:
    """COCO's uncompressed run lengths: column by column, the first run is of zeros."""
    flat = np.asarray(mask).ravel(order="F")
    changes = np.flatnonzero(np.diff(flat)) + 1
    bounds = np.concatenate([[0], changes, [flat.size]])
    counts = np.diff(bounds).tolist()
    return {"size": list(mask.shape), "counts": [0, *counts] if flat[0] else counts}
