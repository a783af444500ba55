"""Another model in a piece's place: which there are, where it stands, and its files."""

from __future__ import annotations

import filecmp
import math
import os
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .edits import Matrix, Size, Swap, size_of

COLOUR = "colour"
"""The variant set of the models' colours."""

ASSETS = "assets"
"""The folder beside a house that holds its models."""


MODEL_SUFFIXES = (
    ".usd", ".usda", ".usdc", ".usdz", ".mtlx",
    ".png", ".jpg", ".jpeg", ".exr", ".hdr", ".tga", ".tif", ".tiff", ".webp",
)  # fmt: skip
"""Of files that a model is made of: layers and textures."""


@dataclass(frozen=True)
class Candidate:
    """A model that could take a piece's place."""

    id: str
    usd: Path
    size_m: Size
    """Its own."""
    fits_m: Size
    """What it fills of the slot."""
    offset_m: tuple[float, float]
    colours: tuple[str, ...]
    picture: Path | None
    shared: tuple[Path, ...] = ()
    """Pictures beside its folder, which other models have, too."""

    @property
    def label(self) -> str:
        """As a button shows it."""
        length, width, _ = self.size_m
        return f"{self.id.replace('_', ' ')}, {length:.2f} × {width:.2f} m"


def candidates(report: Mapping[str, Any]) -> list[Candidate]:
    """The candidates in the report of `assets nearest --json`, in its order."""
    entries = []
    for asset in report.get("assets", ()):
        fits = asset["fits"]
        entries.append(
            Candidate(
                id=str(asset["id"]),
                usd=Path(asset["usd"]),
                size_m=size_of(asset["size_m"]),
                fits_m=size_of(fits["size_m"]),
                offset_m=(float(fits["center_m"][0]), float(fits["center_m"][1])),
                colours=tuple(asset.get("looks", {}).get(COLOUR, ())),
                picture=Path(asset["picture"]) if asset.get("picture") else None,
                shared=tuple(Path(file) for file in asset.get("shared", ())),
            )
        )
    return entries


def swap_for(
    candidate: Candidate, slot_m: Size, usd: str, colour: str, kg_per_m3: float = 0.0
) -> Swap:
    """The swap that puts a candidate in a slot, in the colour it is asked for if it has that.

    usd: the model's layer, relative to the house.
    """
    chosen = colour if colour in candidate.colours else next(iter(candidate.colours), "")
    looks = {COLOUR: chosen} if chosen else {}
    return Swap(usd, slot_m, candidate.offset_m, candidate.fits_m, looks, kg_per_m3)


def placed(matrix: Matrix, before: Swap | None, swap: Swap, own_m: Size) -> Matrix:
    """Where the swapped model stands: as the piece before it, turned and moved as that was.

    matrix: the placement of what stands there now. before: the swap that put that there. own_m:
    the model's own size, which is scaled to what it fills.
    """
    turn = _turn(matrix)
    back = before.offset_m if before else (0.0, 0.0)
    x, y = (new - old for new, old in zip(swap.offset_m, back, strict=True))
    scale = [size / unscaled for size, unscaled in zip(swap.size_m, own_m, strict=True)]
    rows = []
    for row in range(3):
        shift = turn[row][0] * x + turn[row][1] * y
        rows.append(
            (*(turn[row][column] * scale[column] for column in range(3)), matrix[row][3] + shift)
        )
    return (*rows, (0.0, 0.0, 0.0, 1.0))


def raised(matrix: Matrix, by_m: float) -> Matrix:
    """A placement that is higher by so much: what stands on a piece that is higher now."""
    rows = [list(row) for row in matrix]
    rows[2][3] += by_m
    return tuple(tuple(row) for row in rows)


def bring_model(usd: Path, house: Path, shared: Sequence[Path] = ()) -> str:
    """Copy a model beside the house, unless it is there; returns its relative path.

    With it goes what lies in its folder and can belong to a model, and the pictures that it shares
    with others (named by content: those that are there stay); nothing else, and no links. A
    folder of that name is completed; where it has other files under the same names, they stay, and
    the model goes into a folder of another name. Raises OSError.
    """
    files = _model_files(usd.parent)
    target = house.parent / ASSETS / usd.parent.name
    number = 1
    while not (target / usd.name).is_file() and _is_in_the_way(target, usd.parent, files):
        number += 1
        target = target.with_name(f"{usd.parent.name}_{number}")
    if not (target / usd.name).is_file():
        for picture in shared:
            _bring(picture, [Path(picture.name)], house.parent / ASSETS / picture.parent.name)
        _bring(usd, files, target)
    return f"{ASSETS}/{target.name}/{usd.name}"


def _model_files(folder: Path) -> list[Path]:
    """What lies in a folder and can be part of a model, relative to it."""
    files = (file for file in folder.rglob("*") if file.suffix.lower() in MODEL_SUFFIXES)
    return [file.relative_to(folder) for file in files if file.is_file() and not file.is_symlink()]


def _is_in_the_way(target: Path, source: Path, files: list[Path]) -> bool:
    if not os.path.lexists(target):
        return False
    if target.is_symlink() or not target.is_dir():
        return True
    there = (file for file in files if os.path.lexists(target / file))
    return any(
        not (target / file).is_file()
        or not filecmp.cmp(source / file, target / file, shallow=False)
        for file in there
    )


def _bring(usd: Path, files: list[Path], target: Path) -> None:
    """Copy what is not there, each file whole; the model itself last, which makes it complete."""
    for file in sorted(files, key=lambda file: file == Path(usd.name)):
        place = target / file
        if not place.exists():
            place.parent.mkdir(parents=True, exist_ok=True)
            partial = place.with_name(f"{place.name}.part")
            shutil.copyfile(usd.parent / file, partial)
            partial.replace(place)


def size_text(size_m: Size) -> str:
    """As the command line takes a size."""
    return "x".join(f"{side:.4f}" for side in size_m)


def _turn(matrix: Matrix) -> list[list[float]]:
    """The rotation of a placement, without its scale."""
    lengths = [math.sqrt(sum(matrix[row][col] ** 2 for row in range(3))) for col in range(3)]
    return [[matrix[row][col] / (lengths[col] or 1.0) for col in range(3)] for row in range(3)]
