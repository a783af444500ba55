"""The mesh database as a Blender asset library: its files, catalogs and entries."""

from __future__ import annotations

import json
import uuid
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from .errors import InputError

NAME = "CHOrD furniture"
"""As Blender's preferences list it."""

MODELS = "models"
"""The folder in the library that `assets build` fills."""

INDEX = "index.json"
"""What `assets build` lists the models in."""

CATALOGS = "blender_assets.cats.txt"
"""Where Blender looks for catalogs."""

WORKER = Path(__file__).parents[1] / "library_worker.py"
"""The script that a second Blender runs."""

_NAMESPACE = uuid.UUID("6f0f3f0e-5d0b-4c0e-9a55-3f1f9e2f6a11")
"""Makes the same catalog the same one for ever, so that libraries can be built again."""

_HEAD = (
    "# Asset catalogs of the furniture that chord-usd draws.\nVERSION 1\n"
    "# UUID:path/of/catalog:simple name\n"
)


def library_folder(chosen: Path) -> Path:
    """Where the library goes: the folder that was chosen, or one in it where that is in use.

    Building replaces the models of a library: they must be none but ours. Raises InputError.
    """
    for folder in (chosen, chosen / NAME):
        if _is_free_or_ours(folder):
            return folder
    raise InputError(f"{chosen / NAME} holds other files. Choose another folder for the library.")


def _is_free_or_ours(folder: Path) -> bool:
    if not folder.exists():
        return True
    if not folder.is_dir():
        return False
    held = {entry.name for entry in folder.iterdir()}
    if not held:
        return True
    try:
        categories = models(folder)
    except (OSError, ValueError, KeyError, TypeError):
        return False
    # A library whose making was stopped has no catalogs yet, and perhaps not all of its files.
    ours = {f"{category}.blend{number}" for category in categories for number in ("", "1", "2")}
    return held <= {MODELS, CATALOGS, *ours}


@dataclass(frozen=True)
class Model:
    """An entry of the library."""

    id: str
    category: str
    usd: Path
    picture: Path
    licence: str
    author: str

    @property
    def label(self) -> str:
        """As the asset browser shows it."""
        return self.id.replace("_", " ")


def models(folder: Path) -> dict[str, list[Model]]:
    """The models in a library's folder by category. Raises OSError, ValueError or KeyError."""
    home = folder / MODELS
    entries = json.loads((home / INDEX).read_text(encoding="utf-8"))["assets"]
    by_category: dict[str, list[Model]] = {}
    for entry in entries:
        by_category.setdefault(entry["category"], []).append(
            Model(
                id=entry["id"],
                category=entry["category"],
                usd=home / entry["path"],
                picture=home / "pictures" / f"{entry['id']}.png",
                licence=entry.get("licence", ""),
                author=entry.get("author", ""),
            )
        )
    return by_category


def catalog_id(category: str) -> str:
    """The catalog of a category."""
    return str(uuid.uuid5(_NAMESPACE, category))


def catalogs(categories: Iterable[str]) -> str:
    """The text of the file of catalogs, all of them below one."""
    lines = []
    for category in sorted(categories):
        words = category.replace("_", " ").capitalize()
        lines.append(f"{catalog_id(category)}:{NAME}/{words}:{NAME}-{words}")
    return _HEAD + "".join(f"{line}\n" for line in lines)


def command(blender: str, python: str, folder: Path) -> list[str]:
    """The command line that builds the library from the models in its folder.

    blender: path of Blender; empty where Blender is a module of a Python, which then runs it.
    """
    if not blender:
        return [python, str(WORKER), "--", str(folder)]
    return [
        blender,
        "--background",
        "--factory-startup",
        "--python-exit-code",
        "2",
        "--python",
        str(WORKER),
        "--",
        str(folder),
    ]
