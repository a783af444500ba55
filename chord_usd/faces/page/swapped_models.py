"""Models that can take a piece's place: noted when offered, copied beside a house when chosen.

As the Blender panel does it: what is swapped here is found there.
"""

from __future__ import annotations

import filecmp
import json
import re
import shutil
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, TypeGuard

from chord_usd.base.errors import ChordError
from chord_usd.base.runtime.files import write_atomic

OFFERED = ".models"
"""The folder of the root with pictures of models, and what is known of them."""

ASSETS = "assets"
SHARED = "Finishes"
"""Within assets: pictures that models share."""
COLOUR = "colour"
_NAME = re.compile(r"\w[\w.-]{0,79}", re.ASCII)
_LOOK = re.compile(r"[A-Za-z_]\w{0,79}", re.ASCII)
"""The name of a variant set, which USD writes without quotes."""
_USD = re.compile(r"assets/(\w[\w.-]{0,99})/(\w[\w.-]{0,99}\.usd[ac]?)", re.ASCII)
_PARTS = (".usd", ".usda", ".usdc", ".mtlx", ".png", ".jpg", ".jpeg", ".exr", ".webp")

_PIECE = """#usda 1.0
(
    defaultPrim = "House"
    metersPerUnit = 1
    upAxis = "Z"
)

def Xform "House"
{{
    def Xform "Piece" (
        prepend references = @./{usd}@{variants}
    )
    {{
    }}
}}
"""


def is_name(name: object) -> TypeGuard[str]:
    """Whether this can be the id of a model, or a colour."""
    return isinstance(name, str) and _NAME.fullmatch(name) is not None


def note_offered(folder: Path, models: Iterable[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Keep where models are; returns what the page may know of them."""
    folder.mkdir(exist_ok=True)
    shown = []
    for model in models:
        if not is_name(model["id"]):
            continue
        write_atomic(folder / f"{model['id']}.json", json.dumps(model))
        shown.append(
            {
                "id": model["id"],
                "size_m": model["size_m"],
                "fits": model["fits"],
                "colours": model["looks"].get(COLOUR, []),
                "styles": model.get("styles", []),
            }
        )
    return shown


def bring_model(folder: Path, name: object, house: Path) -> str:
    """Copy a model that was offered beside a house, unless it is there; returns its path there.

    Raises ChordError for one that was not offered.
    """
    note = folder / f"{name}.json"
    if not is_name(name) or not note.is_file():
        raise ChordError("that model was not offered", try_="look for models again")
    model = json.loads(note.read_bytes())
    usd = Path(model["usd"])
    target, number = house / ASSETS / usd.parent.name, 1
    while target.exists() and not _is_same(usd, target / usd.name):
        number += 1
        target = house / ASSETS / f"{usd.parent.name}_{number}"
    if not target.exists():
        for picture in map(Path, model.get("shared", ())):
            place = house / ASSETS / picture.parent.name / picture.name
            if not place.exists():
                place.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(picture, place)
        shutil.copytree(usd.parent, target, ignore=_ignored)
    return f"{ASSETS}/{target.name}/{usd.name}"


def _is_same(file: Path, other: Path) -> bool:
    return other.is_file() and filecmp.cmp(file, other, shallow=False)


def _ignored(folder: str, names: list[str]) -> list[str]:
    """What is no part of a model."""
    paths = ((name, Path(folder, name)) for name in names)
    return [
        name
        for name, path in paths
        if path.is_symlink() or (path.is_file() and path.suffix.lower() not in _PARTS)
    ]


def piece_layer(usd: str, colour: str) -> str:
    """A stage with one model of a house in one colour, to lie beside the house's own."""
    chosen = f'\n        variants = {{\n            string {COLOUR} = "{colour}"\n        }}'
    return _PIECE.format(usd=usd, variants=chosen if colour else "")


def checked_swap(given: Any, house: Path) -> dict[str, Any]:
    """A swap as the layer of changes has it. Raises ChordError for what is none."""
    try:
        looks = {str(key): str(value) for key, value in given.get("looks", {}).items()}
        swap: dict[str, Any] = {
            "usd": str(given["usd"]),
            "slot_m": _numbers(given["slot_m"], 3),
            "offset_m": _numbers(given["offset_m"], 2),
            "size_m": _numbers(given["size_m"], 3),
            "looks": looks,
            "kg_per_m3": _numbers([given.get("kg_per_m3", 0.0)], 1)[0],
        }
    except (AttributeError, KeyError, TypeError, ValueError):
        raise ChordError("a swap is none") from None
    if not _USD.fullmatch(swap["usd"]) or not (house / swap["usd"]).is_file():
        raise ChordError("a swap names no model of the house")
    if not all(_LOOK.fullmatch(look) and is_name(choice) for look, choice in looks.items()):
        raise ChordError("a swap has no such look")
    return swap


def _numbers(values: Any, count: int) -> list[float]:
    numbers = [float(value) for value in values]
    if len(numbers) != count or not all(abs(number) < 1e5 for number in numbers):
        raise ValueError
    return numbers
