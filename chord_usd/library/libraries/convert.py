"""A model of a library becomes a component: turned, scaled, thinned out, dressed, written."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path, PurePosixPath

import numpy as np

from chord_usd.base.errors import AssetError
from chord_usd.base.scene.palette import category
from chord_usd.base.scene.types import Asset, FloatArray, frozen_array
from chord_usd.library.component import ComponentInfo, write_component
from chord_usd.library.design_tables import SizeM
from chord_usd.library.kit.model import Design, Part
from chord_usd.library.kit.solids import Solid
from chord_usd.library.libraries.categories import known_category, nearest_category
from chord_usd.library.libraries.meshes import Mesh, Sheet, read_mesh
from chord_usd.library.libraries.models import UNITS_M, Model
from chord_usd.library.surfaces.finishes import Finish

COLOURWAY = "as_modelled"
MOST_PARTS = 24
"""Materials of one model; further ones are dressed as the last of them."""

_NAME_LETTERS = 100
"""File systems hold names of 255 bytes."""

_BELIEVABLE = 1.8
"""A piece up to this much smaller or larger than the palette's range is taken as it is."""


@dataclass(frozen=True)
class Converted:
    """A component and what had to be guessed on the way."""

    asset: Asset
    warnings: tuple[str, ...]
    is_open: bool
    """Its surface has edges or is not manifold; it is shown from both sides."""


def convert(model: Model, path: Path, name: str, folder: Path, most_triangles: int) -> Converted:
    """Write the model whose mesh lies at path as component folder/name.

    most_triangles: meshes with more are reduced to it. Raises AssetError where it cannot be used.
    """
    warnings: list[str] = []
    kind = _category(model, warnings)
    library = path.parents[len(PurePosixPath(model.file).parts) - 1]
    mesh = read_mesh(path, library)
    sheets = _upright(mesh, model)
    size_m = _size_m(sheets, mesh, model, kind, warnings)
    sheets = _filling(sheets, size_m)
    count = sum(len(sheet.faces) for sheet in sheets)
    if count > most_triangles:
        sheets = _thinned(sheets, most_triangles)
        left = sum(len(sheet.faces) for sheet in sheets)
        warnings.append(f"reduced from {count:,} to {left:,} triangles")
        sheets = _filling(sheets, size_m)
    design, is_open = _design(name, kind, size_m, sheets)
    info = ComponentInfo(
        model.licence or "unknown",
        model.author or "unknown",
        model.label,
        datetime.now(UTC).date().isoformat(),
    )
    interface = write_component(design, folder, info)
    asset = Asset(name, kind, size_m, interface, info.licence, info.author, tags=model.tags)
    return Converted(asset, tuple(warnings), is_open)


def identifier(text: str) -> str:
    """Text as the name of a component: letters, digits and single underscores."""
    plain = re.sub(r"[^0-9A-Za-z]+", "_", text)[:_NAME_LETTERS].strip("_")
    return plain if plain and not plain[0].isdigit() else f"Model_{plain}".rstrip("_")


def _category(model: Model, warnings: list[str]) -> str:
    known = known_category(model.category)
    if known:
        return known
    nearest = nearest_category(model.category)
    if nearest is None:
        raise AssetError(
            f"no known category fits {model.category!r}",
            expected="a category of the palette, such as 'sofa'",
        )
    warnings.append(f"{model.category!r} is no known category; taken for '{nearest}'")
    return nearest


def _upright(mesh: Mesh, model: Model) -> list[Sheet]:
    """The sheets with z up and the front towards -y."""
    turn = _turn(model.up or mesh.up, model.front or mesh.front)
    if model.rotation:
        turn = turn @ np.array(model.rotation).reshape(3, 3)
    return [replace(sheet, points=sheet.points @ turn.T) for sheet in mesh.sheets]


def _turn(up: str, front: str) -> FloatArray:
    """(3, 3) rotation that takes up to +z and front to -y. Raises AssetError for parallel axes."""
    high, ahead = _unit(up), _unit(front)
    if abs(float(high @ ahead)) > 0.5:
        raise AssetError(f"up is {up} and front is {front}", expected="axes at a right angle")
    return np.stack([np.cross(high, ahead), -ahead, high])


def _unit(axis: str) -> FloatArray:
    vector = np.zeros(3)
    vector["xyz".index(axis[1])] = 1.0 if axis[0] == "+" else -1.0
    return vector


def _size_m(
    sheets: Sequence[Sheet], mesh: Mesh, model: Model, kind: str, warnings: list[str]
) -> SizeM:
    """The catalogue's size, else the mesh's own in the unit that makes it believable."""
    low, high = _bounds(sheets)
    span = high - low
    if not np.all(span > 1e-9):
        raise AssetError("the mesh is flat")
    if model.size_m:
        if not _is_believable(np.array(model.size_m), kind):
            raise _unbelievable(np.array(model.size_m), kind)
        return model.size_m
    said = model.unit_m or mesh.unit_m
    usual = UNITS_M.values()
    units = (said,) if model.unit_m else ((said, *usual) if said else tuple(usual))
    for unit_m in units:
        if unit_m and _is_believable(span * unit_m, kind):
            if said and unit_m != said:
                warnings.append(f"its unit was taken for {unit_m:g} m: as {said:g} m it would be "
                                f"{span[0] * said:.3g} m long")  # fmt: skip
            length, width, height = (round(float(side) * unit_m, 4) for side in span)
            return length, width, height
    raise _unbelievable(span * (said or 1.0), kind)


def _unbelievable(size_m: FloatArray, kind: str) -> AssetError:
    return AssetError(
        f"measures {' x '.join(f'{side:.3g}' for side in size_m)} m",
        expected=f"about the size of a {category(kind).label}",
        try_="say its size_m or unit in the manifest",
    )


def _is_believable(size_m: FloatArray, kind: str) -> bool:
    row = category(kind)
    spans = (row.length_m, row.width_m, row.height_m)
    return all(
        low / _BELIEVABLE <= side <= high * _BELIEVABLE
        for side, (low, high) in zip(size_m, spans, strict=True)
    )


def _filling(sheets: Sequence[Sheet], size_m: SizeM) -> list[Sheet]:
    """The sheets moved and scaled to size_m, the middle of the underside at the origin."""
    low, high = _bounds(sheets)
    base = np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])
    scale = np.array(size_m) / (high - low)
    return [replace(sheet, points=(sheet.points - base) * scale) for sheet in sheets]


def _bounds(sheets: Sequence[Sheet]) -> tuple[FloatArray, FloatArray]:
    used = np.concatenate([sheet.points[np.unique(sheet.faces)] for sheet in sheets])
    return used.min(axis=0), used.max(axis=0)


def _thinned(sheets: Sequence[Sheet], most: int) -> list[Sheet]:
    """Fewer triangles, taken from every sheet alike (quadric edge collapse)."""
    total = sum(len(sheet.faces) for sheet in sheets)
    return [_reduced(sheet, max(12, int(len(sheet.faces) * most / total))) for sheet in sheets]


def _reduced(sheet: Sheet, target: int) -> Sheet:
    import fast_simplification

    if len(sheet.faces) <= target:
        return sheet
    points, faces, collapses = fast_simplification.simplify(
        sheet.points.astype(np.float32),
        sheet.faces.astype(np.int32),
        target_count=target,
        return_collapses=True,
    )
    if not len(faces):
        return sheet
    uvs = None
    if sheet.uvs is not None:
        _, _, moved_to = fast_simplification.replay_simplification(
            sheet.points.astype(np.float32), sheet.faces.astype(np.int32), collapses
        )
        uvs = np.zeros((len(points), 2))
        uvs[moved_to[::-1]] = sheet.uvs[::-1]
    return replace(
        sheet, points=np.asarray(points, dtype=np.float64), faces=np.asarray(faces), uvs=uvs
    )


def _design(name: str, kind: str, size_m: SizeM, sheets: Sequence[Sheet]) -> tuple[Design, bool]:
    """Parts and finishes of the model, in the form of a parametric one; whether it is open."""
    finishes: dict[str, Finish] = {}
    parts = []
    open_edges = False
    for index, sheet in enumerate(sheets):
        slot = f"material_{min(index, MOST_PARTS - 1) + 1}"
        finishes.setdefault(slot, _finish(sheet))
        part = _part(f"Part_{index + 1}", sheet, slot)
        if part is not None:
            parts.append(part)
            open_edges = open_edges or not _is_closed(part.solid)
    if not parts:
        raise AssetError("the mesh has no face larger than a point")
    design = Design(
        id=name,
        category=kind,
        size_m=size_m,
        draw=lambda size: tuple(parts),
        colourways={COLOURWAY: {slot: slot for slot in finishes}},
        finishes=finishes,
    )
    return design, open_edges


def _finish(sheet: Sheet) -> Finish:
    from PIL import Image

    picture = None if sheet.texture is None else Image.fromarray(sheet.texture)
    rgb = sheet.rgb if picture is None else (255, 255, 255)
    metallic = min(max(sheet.metallic, 0.0), 1.0)
    roughness = min(max(sheet.roughness, 0.05), 1.0)
    return Finish(rgb, roughness, metallic, max(sheet.opacity, 0.05), texture=picture)


def _part(name: str, sheet: Sheet, slot: str) -> Part | None:
    """The sheet with equal points made one, without triangles that cover nothing."""
    keys = np.round(sheet.points / 1e-5).astype(np.int64)
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    faces = inverse.reshape(-1)[sheet.faces]
    points = sheet.points[first]
    edges = points[faces[:, 1:]] - points[faces[:, :1]]
    covers = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1) > 1e-10
    if not covers.any():
        return None
    uvs = sheet.uvs[sheet.faces[covers]].reshape(-1, 2) if sheet.uvs is not None else None
    used, faces = np.unique(faces[covers], return_inverse=True)
    solid = Solid(frozen_array(points[used]), frozen_array(faces.reshape(-1, 3), np.int64))
    return Part(name, solid, slot, uvs=uvs, two_sided=True)


def _is_closed(solid: Solid) -> bool:
    """Whether every edge joins two triangles that run against each other along it."""
    edges = np.concatenate([solid.faces[:, [i, (i + 1) % 3]] for i in range(3)])
    forth = np.unique(edges, axis=0)
    back = np.unique(edges[:, ::-1], axis=0)
    return len(forth) == len(edges) and bool(np.array_equal(forth, back))
