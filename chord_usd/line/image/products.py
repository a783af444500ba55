"""The files of a take, and whether the files of an earlier run are whole."""

from __future__ import annotations

import io
import json
import struct
import zlib
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from chord_usd.base.runtime.files import deliver, hash_file, write_atomic
from chord_usd.base.scene.label_sets import OWN
from chord_usd.line.image.annotations import (
    MaskArray,
    camera_record,
    category_ids,
    coco,
    semantic_mask,
    thing_records,
)
from chord_usd.line.image.exr import colour_channels, read_exr, write_exr
from chord_usd.line.image.marks import Thing
from chord_usd.line.image.takes import Take

if TYPE_CHECKING:
    from PIL import Image

    from chord_usd.line.image.room_labels import RoomLabel

PASSES = ("rgb", "depth", "normal", "instance", "semantic", "layers")

FILES_OF_PASS = {
    "rgb": ("{}.png", "{}.exr"),
    "depth": ("{}.depth.exr",),
    "normal": ("{}.normal.exr",),
    "instance": ("{}.instance.png",),
    "semantic": ("{}.semantic.png",),
    "layers": ("{}.layers.exr",),
}
"""Of each camera; beside them its sidecar `<camera>.json`, and `coco.json` for all together."""

COCO_FILE = "coco.json"

MADE_NOTE = "chordMade"
"""Text of a PNG, attribute of an EXR: what the picture was made from (made.py), as JSON."""

BACKDROP_RGB = (240, 241, 243)
"""8-bit paper on which a house seen from above lies, instead of in the sky."""


def product_files(folder: Path, camera: str, passes: Sequence[str]) -> list[Path]:
    """The files a camera's passes end in, in their order."""
    names = [name for kind in PASSES if kind in passes for name in FILES_OF_PASS[kind]]
    return [folder / name.format(camera) for name in names]


def write_products(
    take: Take, folder: Path, passes: Sequence[str], things: Sequence[Thing],
    made: dict[str, Any], labels: Sequence[RoomLabel] = (),
) -> list[Path]:  # fmt: skip
    """Write all files of a take at once, and its sidecar; returns them without the sidecar.

    made: what it was made from, noted in sidecar and pictures. labels: written on the picture.
    Raises OutputError; then none of the files is there.
    """
    targets = product_files(folder, take.view.name, passes)
    with deliver() as delivery:
        ours = partial(_is_product, take.view.name)
        placed = {target.name: delivery.place(target, asked=False, ours=ours) for target in targets}
        notes = {MADE_NOTE: json.dumps(made)}
        _write_colour(take, placed, notes, labels)
        _write_data(take, placed, things, notes)
        _write_layers(take, placed, notes)
        sidecar = _sidecar(take, passes, things, made)
        sidecar["files"] = {name: hash_file(path) for name, path in placed.items()}
        # Placed last, so that it is moved last: what it lists is there when it is.
        place = delivery.place(sidecar_file(folder, take.view.name), asked=False, ours=ours)
        place.write_text(_json(sidecar))
    return targets


def sidecar_file(folder: Path, camera: str) -> Path:
    """Where the words on a camera's files are."""
    return folder / f"{camera}.json"


def _is_product(camera: str, path: Path) -> bool:
    """Whether a camera's sidecar says so: pictures travel between machines without manifests."""
    listed = _listed_files(path.parent, camera)
    if path == sidecar_file(path.parent, camera):
        return bool(listed)
    return listed.get(path.name) == hash_file(path)


def _listed_files(folder: Path, camera: str) -> dict[str, str]:
    """Hashes of a camera's files, by its sidecar; none without a sidecar that chord-usd wrote."""
    try:
        sidecar = json.loads(sidecar_file(folder, camera).read_text())
        files: dict[str, str] = sidecar["files"] if sidecar["made"] else {}
        return files if isinstance(files, dict) else {}
    except (OSError, ValueError, KeyError, TypeError):
        return {}


def are_finished(folder: Path, camera: str, made: dict[str, Any]) -> bool:
    """Whether an earlier run made these files in this way, and their bytes are still the same."""
    try:
        sidecar = json.loads(sidecar_file(folder, camera).read_text())
        files: dict[str, str] = sidecar["files"]
        wanted = {path.name for path in product_files(folder, camera, made["passes"])}
        return (
            sidecar["made"] == made
            and set(files) == wanted
            and all(hash_file(folder / name) == digest for name, digest in files.items())
        )
    except (OSError, ValueError, KeyError, TypeError):
        return False


def write_coco(folder: Path, cameras: Sequence[str], label_set: str = OWN) -> Path:
    """Write the COCO data set of these cameras' instance masks. Raises OutputError.

    label_set: as of annotations.coco.
    """
    pictures = []
    for camera in cameras:
        sidecar = json.loads(sidecar_file(folder, camera).read_text())
        shown = "png" if "rgb" in sidecar["made"]["passes"] else "instance.png"
        mask = read_mask(folder / f"{camera}.instance.png")
        pictures.append((f"{camera}.{shown}", sidecar, mask))
    target = folder / COCO_FILE
    write_atomic(target, json.dumps(coco(pictures, label_set)), asked=False)
    return target


def read_mask(path: Path) -> MaskArray:
    """(H, W) ids of an instance or semantic mask."""
    from PIL import Image

    with Image.open(path) as picture:
        return np.asarray(picture).astype(np.uint16)


def _write_colour(
    take: Take, placed: dict[str, Path], notes: dict[str, str], labels: Sequence[RoomLabel]
) -> None:
    png, exr = (placed.get(name.format(take.view.name)) for name in FILES_OF_PASS["rgb"])
    if png is None or exr is None:
        return
    assert take.picture is not None
    assert take.colour is not None
    png.write_bytes(with_notes(_on_paper(take, labels), notes))
    write_exr(exr, colour_channels(take.colour), notes, half=True)


def _on_paper(take: Take, labels: Sequence[RoomLabel]) -> bytes:
    """A picture with a transparent background laid on paper; others are taken as they are."""
    from PIL import Image

    assert take.picture is not None
    with Image.open(take.picture) as image:
        image.load()  # a file that was cut short is found out here
        if image.mode != "RGBA":
            return take.picture.read_bytes()
        backdrop = Image.new("RGBA", image.size, (*BACKDROP_RGB, 255))
        backdrop.alpha_composite(image)
    paper = backdrop.convert("RGB")
    if labels:
        from chord_usd.line.image.room_labels import write_labels

        write_labels(paper, take.view, labels)
    return _png(paper)


def _write_layers(take: Take, placed: dict[str, Path], notes: dict[str, str]) -> None:
    """Blender's own layers, without its notes of the hour, with Cryptomatte's names."""
    path = placed.get(FILES_OF_PASS["layers"][0].format(take.view.name))
    if path is None:
        return
    assert take.layers is not None
    channels, header = read_exr(take.layers)
    names = {key: str(text) for key, text in header.items() if key.startswith("cryptomatte/")}
    write_exr(path, channels, {**names, **notes})


def _write_data(
    take: Take, placed: dict[str, Path], things: Sequence[Thing], notes: dict[str, str]
) -> None:
    name = take.view.name
    if path := placed.get(f"{name}.depth.exr"):
        assert take.depth_m is not None
        write_exr(path, {"Z": take.depth_m}, notes)
    if path := placed.get(f"{name}.normal.exr"):
        assert take.normal is not None
        write_exr(path, {axis: take.normal[..., at] for at, axis in enumerate("XYZ")}, notes)
    if path := placed.get(f"{name}.instance.png"):
        _write_mask(path, _numbers(take), notes)
    if path := placed.get(f"{name}.semantic.png"):
        _write_mask(path, semantic_mask(_numbers(take), things), notes)


def _numbers(take: Take) -> MaskArray:
    assert take.numbers is not None
    return take.numbers.astype(np.uint16)


def _write_mask(path: Path, mask: MaskArray, notes: dict[str, str]) -> None:
    from PIL import Image

    path.write_bytes(with_notes(_png(Image.fromarray(mask)), notes))


def _png(image: Image.Image) -> bytes:
    held = io.BytesIO()
    image.save(held, format="PNG")
    return held.getvalue()


def _sidecar(
    take: Take, passes: Sequence[str], things: Sequence[Thing], made: dict[str, Any]
) -> dict[str, Any]:
    size_px = (made["width_px"], made["height_px"])
    record: dict[str, Any] = {"camera": camera_record(take.view, size_px), "made": made}
    if take.colour is not None:
        record["exposure_ev"] = take.exposure_ev
    if "instance" in passes or "semantic" in passes:
        record["instances"] = thing_records(_numbers(take), things)
        record["categories"] = category_ids(thing.label for thing in things)
    return record


def _json(value: dict[str, Any]) -> str:
    return json.dumps(value, indent=1) + "\n"


# PNG files chunk by chunk: the same pixels with other notes --------------------------------------

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_NOTES = (b"tEXt", b"zTXt", b"iTXt", b"tIME", b"eXIf")


def with_notes(png: bytes, notes: Mapping[str, str]) -> bytes:
    """The picture with these notes (Latin-1 text by keyword) instead of those that it has.

    Blender notes date and render time, so that two runs would differ. Raises ValueError for what is
    no PNG, or is cut short.
    """
    chunks = list(_chunks(png))
    texts = [(b"tEXt", f"{key}\0{text}".encode("latin-1")) for key, text in notes.items()]
    kept = [chunk for chunk in chunks if chunk[0] not in _NOTES]
    # The header comes first, notes may follow anywhere.
    return _SIGNATURE + b"".join(_written(*chunk) for chunk in (kept[0], *texts, *kept[1:]))


def _chunks(png: bytes) -> Iterator[tuple[bytes, bytes]]:
    """(kind, data) of each. Raises ValueError."""
    if not png.startswith(_SIGNATURE):
        raise ValueError("no PNG")
    at, kind = len(_SIGNATURE), b""
    while kind != b"IEND":
        if at + 12 > len(png):
            raise ValueError("a PNG that is cut short")
        length, kind = struct.unpack_from(">I4s", png, at)
        yield kind, png[at + 8 : at + 8 + length]
        at += length + 12


def _written(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
