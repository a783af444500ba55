"""Designs of the embedded database, each made from its row when somebody needs its geometry."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from functools import cache, lru_cache, partial
from importlib import import_module
from types import ModuleType
from typing import Any

from chord_usd.library.design_tables import Entry, colour_sets, entries
from chord_usd.library.kit.model import Design, Light
from chord_usd.library.surfaces.finishes import Finish, finish_table

_FINISHES = {
    "textiles": "surfaces.textiles.TEXTILES",
    "bed_linen": "surfaces.textiles.BED_LINEN",
    "dry_textiles": "surfaces.textiles.DRY_TEXTILES",
    "printed": "pictures.prints_and_screens.PRINTED",
}
"""Finishes that are made, by their name in the column `finishes`; others are in finishes.tsv."""


@lru_cache(maxsize=1)
def designs() -> tuple[Design, ...]:
    """All designs, sorted by category and id. Imports all geometry."""
    return tuple(design_of(name) for name in entries())


@cache
def design_of(name: str) -> Design:
    """The design of this id; imports the geometry of its family only. Raises KeyError."""
    entry = entries()[name]
    return Design(
        entry.id,
        entry.category,
        entry.size_m,
        resolved(entry.draw, entry.folder),
        colour_sets(entry.folder)[entry.colours],
        _finishes(entry),
        entry.styles,
        _light(entry.light),
    )


def _finishes(entry: Entry) -> Mapping[str, Finish]:
    """A table of finishes, or one that a function makes for the design's id and size."""
    if entry.finishes in _FINISHES:
        return resolved(_FINISHES[entry.finishes], "")
    if entry.finishes.isidentifier():
        return finish_table(entry.finishes)
    return resolved(entry.finishes, entry.folder)(entry.id, entry.size_m)


def _light(cell: str) -> Light | None:
    if not cell:
        return None
    place, radius_m, lumens = cell.split(",")
    x, y, z = map(float, place.split())
    return Light((x, y, z), float(radius_m), ast.literal_eval(lumens.strip()))


def resolved(cell: str, folder: str) -> Any:
    """What a cell names: `module.name` of the folder, `folder.module.name` of the library.

    `name(key=value)` is that function with these arguments given, or an instance of that class.
    Values are literals, such names, and bare names of the outermost function's module.
    """
    tree = ast.parse(cell, mode="eval").body
    outermost = tree.func if isinstance(tree, ast.Call) else tree
    assert isinstance(outermost, ast.Attribute), cell
    return _value(tree, folder, _module(outermost, folder))


def _value(node: ast.expr, folder: str, module: ModuleType) -> Any:
    if isinstance(node, ast.Call):
        target = _value(node.func, folder, module)
        given = {str(key.arg): _value(key.value, folder, module) for key in node.keywords}
        return target(**given) if isinstance(target, type) else partial(target, **given)
    if isinstance(node, ast.Attribute):
        return getattr(_module(node, folder), node.attr)
    if isinstance(node, ast.Name):
        return getattr(module, node.id)
    return ast.literal_eval(node)


def _module(node: ast.Attribute, folder: str) -> ModuleType:
    """The module of `module.name` or `folder.module.name`."""
    *above, name = ast.unparse(node.value).split(".")
    return import_module(".".join(("chord_usd.library", *(above or [folder]), name)))
