"""Contact sheets: a small picture of each mesh, drawn without a renderer.

Surfaces are sprinkled with points, the nearest point of a pixel is seen. Glass lets through the
share of the points that its opacity says.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from chord_usd.base.errors import AssetError
from chord_usd.base.runtime.asset_stages import open_asset, try_assets
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.runtime.stages import open_known
from chord_usd.base.scene.types import Asset, ByteArray, FloatArray

if TYPE_CHECKING:
    from PIL import Image
    from pxr import Usd

    from chord_usd.library.kit.model import Design, Part

TILE_PX = 260
_CAPTION_PX = 30
_MARGIN = 0.06
_SUPERSAMPLE = 2
_POINTS_PER_PX = 6.0
"""Enough that a pixel of a surface stays empty once in four hundred."""

_AZIMUTH_DEG, _ELEVATION_DEG = 30.0, 28.0
"""The camera stands to the right of the front and above."""

_LIGHT = np.array([0.35, -0.6, 0.72])
_AMBIENT = 0.42
_PAPER = np.array([246, 246, 244], dtype=np.float64)


@dataclass(frozen=True, eq=False)
class Picture:
    """The triangles of one mesh as they are to be drawn."""

    corners_m: FloatArray
    """(T, 3, 3)."""
    rgb: FloatArray
    """(T, 3) colour, sRGB, 0 to 1."""
    opacity: FloatArray
    """(T,), 0 to 1."""


def draw_sheet(
    assets: Sequence[Asset], *, columns: int = 6, colours: bool = False,
    progress: Progress | None = None,
) -> Image.Image:  # fmt: skip
    """A sheet with a picture of each asset, its name and size below it.

    colours: one picture for each colourway. Raises AssetError for a mesh that cannot be read.
    """
    from PIL import Image, ImageDraw

    try_assets(asset.usd_path for asset in assets)
    cells = [(a, name) for a in assets for name in (colourways(a) if colours else [""])]
    rows = -(-len(cells) // columns)
    tall = TILE_PX + _CAPTION_PX
    sheet = Image.new("RGB", (columns * TILE_PX, rows * tall), tuple(_PAPER.astype(int)))
    pen = ImageDraw.Draw(sheet)
    for index, (asset, colourway) in enumerate(cells):
        if progress is not None:
            progress(index, len(cells))
        left, top = index % columns * TILE_PX, index // columns * tall
        sheet.paste(Image.fromarray(draw_asset(asset, TILE_PX, colourway)), (left, top))
        size = " x ".join(f"{side:.2f}" for side in asset.size_m)
        pen.text((left + 6, top + TILE_PX), f"{asset.id} {colourway}", fill=(40, 40, 40))
        pen.text((left + 6, top + TILE_PX + 13), f"{asset.category} {size}", fill=(120, 120, 120))
    if progress is not None:
        progress(len(cells), len(cells))
    return sheet


def draw_asset(asset: Asset, side_px: int = TILE_PX, colourway: str = "") -> ByteArray:
    """A square picture of one asset, (side_px, side_px, 3). Raises AssetError."""
    return _draw(_read(asset.usd_path, colourway), side_px)


def picture_of(design: Design, parts: Sequence[Part], side_px: int) -> ByteArray:
    """A square picture of a design in its first colours, (side_px, side_px, 3).

    side_px is even. Drawn at half of it and enlarged: a sixteenth of the work of draw_asset, since
    a house that finds no cached meshes draws a hundred of them.
    """
    from PIL import Image

    looks = next(iter(design.colourways.values()))
    corners, rgb, opacity = [], [], []
    for part in parts:
        finish = design.finishes[looks[part.slot]]
        triangles = part.solid.points_m[part.solid.faces]
        corners.append(triangles)
        rgb.append(np.tile(np.array(finish.linear_rgb()) ** (1 / 2.2), (len(triangles), 1)))
        opacity.append(np.full(len(triangles), finish.opacity))
    picture = Picture(np.concatenate(corners), np.concatenate(rgb), np.concatenate(opacity))
    small = Image.fromarray(_draw(picture, side_px // 2, supersample=1))
    return np.asarray(small.resize((side_px, side_px), Image.Resampling.LANCZOS))


def colourways(asset: Asset) -> list[str]:
    """Names of the colours an asset comes in; one empty name where it has no choice.

    Raises AssetError.
    """
    try_assets([asset.usd_path])
    stage = open_known(asset.usd_path, load=False)
    return stage.GetDefaultPrim().GetVariantSet("colour").GetVariantNames() or [""]


def _read(path: Path, colourway: str) -> Picture:
    """The triangles of a component, their colours from its materials."""
    from pxr import Usd, UsdGeom

    stage = open_asset(path)
    root = stage.GetDefaultPrim()
    if colourway:
        root.GetVariantSet("colour").SetVariantSelection(colourway)
    corners, rgb, opacity = [], [], []
    for prim in Usd.PrimRange(root, Usd.TraverseInstanceProxies()):
        if not prim.IsA(UsdGeom.Mesh) or not _is_seen(prim):
            continue
        triangles = _triangles(prim)
        colour, solid = _finish(prim)
        corners.append(triangles)
        rgb.append(np.tile(colour, (len(triangles), 1)))
        opacity.append(np.full(len(triangles), solid))
    if not corners:
        raise AssetError("holds no mesh", where=str(path))
    return Picture(np.concatenate(corners), np.concatenate(rgb), np.concatenate(opacity))


def _is_seen(prim: Usd.Prim) -> bool:
    from pxr import UsdGeom

    shape = UsdGeom.Imageable(prim)
    return shape.ComputePurpose() != UsdGeom.Tokens.guide and (
        shape.ComputeVisibility() != UsdGeom.Tokens.invisible
    )


def _triangles(prim: Usd.Prim) -> FloatArray:
    """(T, 3, 3) corners in the frame of the component."""
    from pxr import Usd, UsdGeom

    mesh = UsdGeom.Mesh(prim)
    points = np.array(mesh.GetPointsAttr().Get(), dtype=np.float64)
    matrix = np.array(UsdGeom.Imageable(prim).ComputeLocalToWorldTransform(Usd.TimeCode.Default()))
    points = points @ matrix[:3, :3] + matrix[3, :3]
    counts = np.array(mesh.GetFaceVertexCountsAttr().Get())
    starts = np.cumsum(counts) - counts
    index = np.array(mesh.GetFaceVertexIndicesAttr().Get())
    fans = [
        (start, start + step, start + step + 1)
        for start, count in zip(starts, counts, strict=True)
        for step in range(1, count - 1)
    ]
    return points[index[np.array(fans)]]


def _finish(prim: Usd.Prim) -> tuple[FloatArray, float]:
    """(sRGB colour, opacity) of the material of a mesh; a texture counts as light grey."""
    from pxr import UsdShade

    material = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
    surface = material.ComputeSurfaceSource()[0] if material else None
    colour, opacity = None, None
    if surface:
        colour, opacity = (surface.GetInput(name) for name in ("diffuseColor", "opacity"))
    value = colour.Get() if colour else None
    linear = np.array(value if value is not None else (0.55, 0.55, 0.55), dtype=np.float64)
    solid = opacity.Get() if opacity else None
    return linear ** (1 / 2.2), float(1.0 if solid is None else solid)


def _draw(picture: Picture, side_px: int, supersample: int = _SUPERSAMPLE) -> ByteArray:
    side = side_px * supersample
    right, up, ahead = _camera()
    flat = picture.corners_m @ np.stack([right, up, ahead], axis=1)
    low, high = flat.reshape(-1, 3).min(axis=0), flat.reshape(-1, 3).max(axis=0)
    px_per_m = side * (1 - 2 * _MARGIN) / max(high[0] - low[0], high[1] - low[1], 1e-6)
    middle = (low + high) / 2
    points, owner = _sprinkled(picture, flat, px_per_m)
    x = ((points[:, 0] - middle[0]) * px_per_m + side / 2).astype(int)
    y = (side / 2 - (points[:, 1] - middle[1]) * px_per_m).astype(int)
    pixel = y * side + x
    nearest = np.full(side * side, np.inf, dtype=points.dtype)
    np.minimum.at(nearest, pixel, points[:, 2])
    seen = points[:, 2] == nearest[pixel]
    canvas = np.tile(_PAPER, (side * side, 1))
    canvas[pixel[seen]] = (_lit(picture) * 255.0)[owner[seen]]
    small = canvas.reshape(side_px, supersample, side_px, supersample, 3).mean(axis=(1, 3))
    return np.clip(np.round(small), 0, 255).astype(np.uint8)


def _camera() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Unit vectors to the right, up and away from the camera."""
    azimuth, elevation = np.radians(_AZIMUTH_DEG), np.radians(_ELEVATION_DEG)
    away = np.array([-np.sin(azimuth) * np.cos(elevation), np.cos(azimuth) * np.cos(elevation),
                     -np.sin(elevation)])  # fmt: skip
    right = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    return right, np.cross(right, away), away


def _sprinkled(
    picture: Picture, flat: FloatArray, px_per_m: float
) -> tuple[FloatArray, np.ndarray]:
    """(N, 3) points of the surfaces in the camera's frame and the triangle of each."""
    rng = np.random.default_rng(0)
    sides = flat[:, 1:] - flat[:, :1]
    area_px = np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0])
    wanted = area_px / 2 * px_per_m**2 * _POINTS_PER_PX * picture.opacity
    counts = np.floor(wanted + rng.random(len(wanted))).astype(int)
    owner = np.repeat(np.arange(len(counts)), counts)
    u, v = rng.random((2, len(owner)), dtype=np.float32)
    folded = u + v > 1.0
    np.subtract(1.0, u, out=u, where=folded)
    np.subtract(1.0, v, out=v, where=folded)
    first, along, across = (
        part.astype(np.float32) for part in (flat[:, 0], *np.moveaxis(sides, 1, 0))
    )
    points = first[owner]
    points += u[:, None] * along[owner]
    points += v[:, None] * across[owner]
    return points, owner


def _lit(picture: Picture) -> FloatArray:
    """(T, 3) colours under one lamp and an even sky; both sides of a face are lit."""
    edges = picture.corners_m[:, 1:] - picture.corners_m[:, :1]
    normals = np.cross(edges[:, 0], edges[:, 1])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-18)
    away = _camera()[2]
    normals = np.where((normals @ away > 0.0)[:, None], -normals, normals)
    light = _LIGHT / np.linalg.norm(_LIGHT)
    shade = _AMBIENT + (1.0 - _AMBIENT) * np.clip(normals @ light, 0.0, 1.0)
    return np.clip(picture.rgb * shade[:, None], 0.0, 1.0)
