"""Command lines of chord-usd for what the panel's buttons do."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from .edits import Size
from .errors import InputError
from .layer import edits_file, opened_file
from .options import FOLDERS, OF_FILES, words_of
from .swaps import size_text

Source = Literal["PLAN", "TEXT", "OUTLINE"]

PICTURE_SUFFIXES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".webp", ".gif")
"""Plans that can be shown as they are."""

PLAN_SUFFIXES = (*PICTURE_SUFFIXES, ".json", ".pdf", ".svg", ".dxf", ".ifc", ".sh3d")
"""What a plan may be: a picture, CHOrD JSON, a page or a drawing."""

NAME_WORDS, NAME_LETTERS = 6, 40
"""A house is named after so much of its text."""

HOUSE = "house.usda"
"""Name of a new house, in a folder of its own."""

PASSES = {
    "rgb": ("Picture", "What a camera sees"),
    "depth": ("Depth", "Metres from the camera"),
    "normal": ("Normals", "Directions of surfaces"),
    "instance": ("Instances", "Which piece a pixel shows"),
    "semantic": ("Categories", "Of which category a pixel is"),
    "layers": ("Layers", "Blender's layers with Cryptomatte, in one EXR"),
}
"""As chord-usd render has them: the label of each, and what it shows."""

MODELS_SHOWN = 8
"""How many models are offered for a swap."""

FARM_TILE_PX = 540
"""A farm's task renders about so many rows of a picture."""

_REPORT = ("--json", "--progress", "json")


@dataclass(frozen=True)
class RoomWishes:
    """The panel's fields of wanted and unwanted pieces of a room, in words."""

    wanted: str = ""
    unwanted: str = ""


@dataclass(frozen=True)
class GenerateSettings:
    """The panel's fields for a new house."""

    source: Source
    plan: str
    """Path of the plan, or of the open plan that is to be divided into rooms."""
    text: str
    """What is wanted, in words; an open plan does without."""
    options: Mapping[str, Any] = field(default_factory=dict)
    """Values of rows of the option table, by name."""


@dataclass(frozen=True)
class RenderSettings:
    """The panel's fields for pictures."""

    cameras: tuple[str, ...]
    """All of them where none is named."""
    samples: int
    resolution: tuple[int, int]
    passes: tuple[str, ...] = ("rgb",)


def generate(settings: GenerateSettings, house: Path) -> list[str]:
    """Arguments that write a house. Raises InputError naming the field to fill in."""
    is_text = settings.source == "TEXT"
    return [
        "generate",
        *_source(settings),
        "-o",
        str(house),
        *words_of(
            _without(settings.options, OF_FILES) if is_text else settings.options, "generate"
        ),
        *_REPORT,
    ]


def regenerate(
    house: Path,
    room: str,
    options: Mapping[str, Any],
    keep: Sequence[str] = (),
    wishes: RoomWishes | None = None,
) -> list[str]:
    """Arguments that furnish one room of the house again, around the pieces that are kept.

    keep: names of the pieces' prims. Raises InputError.
    """
    if not room:
        raise InputError("Choose a room first.")
    kept = [part for name in keep for part in ("--keep", name)]
    edits = edits_file(_existing(house))
    seen = ["--edits", str(edits)] if edits.is_file() else []
    wishes = wishes or RoomWishes()
    # In one word: a text may begin with a dash.
    said = [f"--with={wishes.wanted.strip()}"] if wishes.wanted.strip() else []
    said += [f"--without={wishes.unwanted.strip()}"] if wishes.unwanted.strip() else []
    return [
        "regenerate",
        str(house),
        "--room",
        room,
        *kept,
        *seen,
        *said,
        f"--seed={options.get('seed', 0)}",
        *words_of(_without(options, ("seed",)), "regenerate"),
        *_REPORT,
    ]


def edit(house: Path, sentence: str, assets: str = "", *, only_read: bool = False) -> list[str]:
    """Arguments that change the house, as it is seen with its changes, as a sentence says.

    only_read: only report what is understood. Raises InputError.
    """
    if not sentence.strip():
        raise InputError("No change is given: write one in words.")
    edits = edits_file(_existing(house))
    seen = ["--edits", str(edits)] if edits.is_file() else []
    dry = ["--dry-run"] if only_read else []
    # Behind two dashes: a sentence may begin with one.
    return [
        "edit",
        str(house),
        *seen,
        *dry,
        *words_of({FOLDERS: assets}, "generate"),
        *_REPORT,
        "--",
        sentence.strip(),
    ]


def past(
    verb: Literal["undo", "redo", "history"], house: Path, to: int = 0, *, amend: bool = False
) -> list[str]:
    """Arguments that go along the history of the house, or list it.

    to: with "history", the number of the change to go back to. amend: what was changed since the
    latest change is part of it. Raises InputError.
    """
    more = ["--to", str(to)] if to else ["--amend"] if amend else []
    return [verb, str(_existing(house)), *more, *_REPORT]


def describe(house: Path) -> list[str]:
    """Arguments that list what the house holds, with its changes. Raises InputError."""
    return ["describe", _seen(house), *_REPORT]


def check(house: Path) -> list[str]:
    """Arguments that certify the house with its changes. Raises InputError."""
    return ["check", _seen(house), *_REPORT]


def nearest(category: str, size_m: Size, pictures: Path, assets: str = "") -> list[str]:
    """Arguments that list the models that could stand in a piece's place."""
    return [
        "assets",
        "nearest",
        category,
        "--size",
        size_text(size_m),
        "--count",
        str(MODELS_SHOWN),
        "--pictures",
        str(pictures),
        *words_of({FOLDERS: assets}, "generate"),
        *_REPORT,
    ]


def build_assets(folder: Path) -> list[str]:
    """Arguments that draw the whole mesh database, with a picture of each model."""
    return ["assets", "build", "-o", str(folder), "--overwrite", "--pictures", *_REPORT]


def render(house: Path, folder: Path, settings: RenderSettings) -> list[str]:
    """Arguments that render the house with its changes. Raises InputError."""
    return ["render", _seen(house), "-o", str(folder), *_pictures(settings), *_REPORT]


def farm(house: Path, folder: Path, settings: RenderSettings) -> list[str]:
    """Arguments that write the same pictures as a job for render farms. Raises InputError."""
    tiles = max(1, round(settings.resolution[1] / FARM_TILE_PX))
    words = [
        "farm",
        "bundle",
        _seen(house),
        "-o",
        str(folder),
        "--overwrite",
        "--tiles",
        str(tiles),
    ]
    return [*words, *_pictures(settings), *_REPORT]


def house_name(settings: GenerateSettings) -> str:
    """A new house's name: that of its plan, or the first words of its text."""
    if settings.source != "TEXT":
        return Path(settings.plan).stem
    words = re.findall(r"\w+", settings.text)[:NAME_WORDS]
    return " ".join(words)[:NAME_LETTERS].strip()


def house_folder(blend_file: str, plan: str, fallback: Path) -> Path:
    """Where a new house goes: beside the Blender file, named after the plan.

    blend_file is empty for an unsaved one; the house then goes to the fallback folder.
    """
    home = Path(blend_file).parent if blend_file else fallback
    name = "".join(c if c.isalnum() or c in "-_ " else "_" for c in Path(plan).stem).strip()
    return home / "chord-usd" / (name or "house")


def found_house(stored: str, blend_file: str) -> Path:
    """The house at hand: where it was, or beside a Blender file that was moved with it.

    Raises InputError where it is in neither place.
    """
    if not stored:
        raise InputError("Generate or open a house first.")
    house = Path(stored)
    beside = Path(blend_file).parent.joinpath(*house.parts[-3:]) if blend_file else house
    return _existing(beside if beside.is_file() and not house.is_file() else house)


def _pictures(settings: RenderSettings) -> list[str]:
    if not settings.passes:
        raise InputError("Choose at least one pass to render.")
    width, height = settings.resolution
    return [
        *(part for camera in settings.cameras for part in ("--camera", camera)),
        "--samples",
        str(settings.samples),
        "--resolution",
        f"{width}x{height}",
        "--passes",
        ",".join(settings.passes),
    ]


def _source(settings: GenerateSettings) -> list[str]:
    # In one word: a text may begin with a dash.
    text = [f"--text={settings.text.strip()}"] if settings.text.strip() else []
    if settings.source == "TEXT":
        if not text:
            raise InputError("Describe the home in the text field.")
        return text
    path = Path(settings.plan).expanduser()
    if not settings.plan.strip():
        open_plan = "Choose an open plan: outer walls with their doors and windows."
        is_open = settings.source == "OUTLINE"
        raise InputError(open_plan if is_open else "Choose a floor plan picture.")
    if not path.is_file():
        raise InputError(f"The plan {path} is not there (any more).")
    if path.suffix.lower() not in PLAN_SUFFIXES:
        raise InputError(f"{path.name} is no plan; {', '.join(PLAN_SUFFIXES)} are read.")
    return ["--outline", str(path), *text] if settings.source == "OUTLINE" else [str(path)]


def _without(options: Mapping[str, Any], names: Sequence[str]) -> dict[str, Any]:
    return {name: value for name, value in options.items() if name not in names}


def _seen(house: Path) -> str:
    """The file of a house with its changes."""
    return str(opened_file(_existing(house)))


def _existing(house: Path) -> Path:
    if not house.is_file():
        raise InputError(f"The house {house} is not there (any more). Generate it again.")
    return house
