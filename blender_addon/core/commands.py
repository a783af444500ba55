"""Command lines of chord-usd for what the panel's buttons do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from .edits import opened_file

Source = Literal["PLAN", "TEXT", "OUTLINE"]

PLAN_SUFFIXES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".webp", ".json")
"""What a plan may be: a picture, or CHOrD JSON."""

MAX_STEPS = 1000

_REPORT = ("--json", "--progress", "json")


class InputError(Exception):
    """The panel's fields do not make a job yet; the text says what is missing, for people."""


@dataclass(frozen=True)
class GenerateSettings:
    """The panel's fields for a new house."""

    source: Source
    plan: str
    """Path of the plan picture, or of the outline."""
    text: str
    seed: int
    steps: int
    """0 for the model's own number."""
    assets: str
    """Folder of further meshes, or empty."""


def generate(settings: GenerateSettings, house: Path) -> list[str]:
    """Arguments that write a house. Raises InputError naming the field to fill in."""
    return [
        "generate",
        *_source(settings),
        "-o",
        str(house),
        "--seed",
        str(settings.seed),
        *_steps(settings.steps),
        *_assets(settings.assets),
        *_REPORT,
    ]


def regenerate(house: Path, room: str, seed: int, assets: str = "") -> list[str]:
    """Arguments that furnish one room of the house anew."""
    if not room:
        raise InputError("Choose a room first.")
    return [
        "regenerate",
        str(_existing(house)),
        "--room",
        room,
        "--seed",
        str(seed),
        *_assets(assets),
        *_REPORT,
    ]


def check(house: Path) -> list[str]:
    """Arguments that certify the house with its changes."""
    return ["check", str(opened_file(_existing(house))), *_REPORT]


def render(
    house: Path, folder: Path, cameras: Sequence[str], samples: int, resolution: tuple[int, int]
) -> list[str]:
    """Arguments that render cameras, all of them where none is named, with the changes."""
    chosen = [part for camera in cameras for part in ("--camera", camera)]
    width, height = resolution
    return [
        "render",
        str(opened_file(_existing(house))),
        "-o",
        str(folder),
        *chosen,
        "--samples",
        str(samples),
        "--resolution",
        f"{width}x{height}",
        *_REPORT,
    ]


def house_folder(blend_file: str, plan: str, fallback: Path) -> Path:
    """Where a new house goes: beside the Blender file, named after the plan.

    blend_file is empty for an unsaved one; the house then goes to the fallback folder.
    """
    home = Path(blend_file).parent if blend_file else fallback
    name = "".join(c if c.isalnum() or c in "-_ " else "_" for c in Path(plan).stem).strip()
    return home / "chord-usd" / (name or "house")


def _source(settings: GenerateSettings) -> list[str]:
    if settings.source == "TEXT":
        if not settings.text.strip():
            raise InputError("Describe the home in the text field.")
        return ["--text", settings.text.strip()]
    path = Path(settings.plan).expanduser()
    if not settings.plan.strip():
        raise InputError("Choose a floor plan picture.")
    if not path.is_file():
        raise InputError(f"The plan {path} is not there (any more).")
    if path.suffix.lower() not in PLAN_SUFFIXES:
        raise InputError(f"{path.name} is no picture; {', '.join(PLAN_SUFFIXES)} are read.")
    return ["--outline", str(path)] if settings.source == "OUTLINE" else [str(path)]


def _steps(steps: int) -> list[str]:
    return ["--steps", str(min(steps, MAX_STEPS))] if steps > 0 else []


def _assets(folder: str) -> list[str]:
    if not folder.strip():
        return []
    path = Path(folder).expanduser()
    if not path.is_dir():
        raise InputError(f"The assets folder {path} is not there.")
    return ["--assets", str(path)]


def _existing(house: Path) -> Path:
    if not house.is_file():
        raise InputError(f"The house {house} is not there (any more). Generate it again.")
    return house
