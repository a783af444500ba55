"""Takes a library in: every usable model becomes a component of a mesh database."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from chord_usd.base.errors import AssetError
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.scene.types import Asset
from chord_usd.base.terms import worded
from chord_usd.library.database import INDEX_NAME, read_index, write_index
from chord_usd.library.libraries.convert import convert, identifier
from chord_usd.library.libraries.models import Model, Refused, free_name
from chord_usd.library.libraries.readers import open_library

MOST_TRIANGLES = 20_000
"""Meshes above this are reduced: a house has forty of them."""


@dataclass
class Added:
    """What became of a library."""

    assets: list[Asset] = field(default_factory=list)
    refused: list[Refused] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)


def add_library(
    path: Path, folder: Path, *, most_triangles: int = MOST_TRIANGLES,
    tags: Sequence[str] = (), progress: Progress | None = None,
) -> Added:  # fmt: skip
    """Convert the models of the library at path into the database in folder, beside those there.

    tags: names of library.database.TAGS that every model gets, beside the manifest's tags.
    A model whose id is taken gets a number. What cannot be used is refused, with its reason; the
    others are taken. Raises AssetError where the library cannot be read or nothing of it used.
    """
    library = open_library(path)
    models = library.models()
    present = list(read_index(folder)) if (folder / INDEX_NAME).is_file() else []
    taken = {asset.id for asset in present}
    added = Added()
    open_surfaces = 0
    for done, model in enumerate(models):
        if progress is not None:
            progress(done, len(models))
        wanted = identifier(model.id)
        name = free_name(wanted, taken)
        try:
            with library.opened(model) as mesh:
                made = convert(model, mesh, name, folder, most_triangles)
        except AssetError as error:
            added.refused.append(Refused(model.id, _why(error)))
            continue
        if name != wanted:
            added.warnings.append(f"{model.id}: this id was there already; it is called {name}")
        taken.add(name)
        both = tuple(dict.fromkeys((*made.asset.tags, *tags)))
        added.assets.append(replace(made.asset, tags=both))
        added.warnings += [f"{name}: {warning}" for warning in made.warnings]
        open_surfaces += made.is_open
    if progress is not None:
        progress(len(models), len(models))
    if not added.assets:
        raise _nothing(path, models, added)
    if open_surfaces:
        added.warnings.append(
            f"{open_surfaces} models have open or non-manifold surfaces, shown from both sides"
        )
    write_index([*present, *added.assets], folder)
    return added


def _why(error: AssetError) -> str:
    expected = worded(error.expected)
    return f"{error.what}; expected {expected}" if expected else error.what


def _nothing(path: Path, models: list[Model], added: Added) -> AssetError:
    first = f"; {added.refused[0].id}: {added.refused[0].why}" if added.refused else ""
    return AssetError(
        f"none of its {len(models)} models can be used{first}",
        where=str(path),
        expected="at least one mesh of furniture",
    )
