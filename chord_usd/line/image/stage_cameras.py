"""The cameras of a stage, in metres, read with usd-core."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.base.runtime.stages import open_stage, reading, room_prims

if TYPE_CHECKING:
    from pxr import Gf, Sdf, Usd

TENTHS = 0.1
"""USD gives focal lengths and apertures in tenths of a scene unit."""

CUT_NOTE = "chord:cut_m"
"""Attribute of cameras that see the house with its walls cut at a height."""

DEFAULT_CAMERA = "Default"
_CORNER = (-0.6, -0.7, 0.45)
_FAR_RADII = 5.0
"""A default camera of 50 mm stands this many radii away, where a picture of 16 : 9 holds all."""

Matrix = tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class StageCamera:
    """One camera prim. Lengths are metres, the world is Z up."""

    name: str
    room: str
    """Name of the room prim it belongs to; empty for one that belongs to none."""
    matrix: Matrix
    """(4, 4) camera to world, column vectors; looks along its own -z, y up."""
    focal_m: float
    aperture_m: float
    """Width of the sensor; of the view, where orthographic."""
    shift: tuple[float, float]
    """How far the view is shifted right and up, over its width."""
    orthographic: bool
    clip_m: tuple[float, float]
    focus_m: float
    f_stop: float
    from_above: bool
    """Stands higher than the house, so that ceilings are in its way."""
    cut_m: float = 0.0
    """Height at which the walls are cut for it; 0 for whole walls."""
    is_alone: bool = False
    """Shows its room alone, without the walls between."""
    frame_height: float = 0.0
    """Of the picture that it was set for, over its width; 0 where nothing says."""

    def framed(self, size_px: tuple[int, int]) -> StageCamera:
        """The camera for a picture (width, height): what a taller one shows more is above, since
        below is what the near clipping plane cuts off, and the ground under the floor."""
        more = size_px[1] / size_px[0] - self.frame_height
        if self.orthographic or not self.frame_height or more <= 0.0 or self.shift[1] >= 0.0:
            return self
        return replace(self, shift=(self.shift[0], self.shift[1] + more / 2))


@dataclass(frozen=True)
class StageViews:
    """What a renderer has to know of a stage before it loads the meshes."""

    cameras: tuple[StageCamera, ...]
    rooms: tuple[str, ...]
    """Names of the room prims."""
    has_dome: bool
    """Whether the stage brings its own sky."""


def read_views(path: Path) -> StageViews:
    """The views a stage offers, without loading its payloads. Raises StageError."""
    with reading(path):
        return _views(open_stage(path, load=False))


def _views(stage: Usd.Stage) -> StageViews:
    from pxr import Usd, UsdGeom, UsdLux

    rooms = [room.GetName() for room in room_prims(stage)]
    prims = list(stage.Traverse(Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)))
    posed = [prim for prim in prims if prim.IsA(UsdGeom.Camera)]
    top_m = _top_m(stage)
    names = _distinct_names([prim.GetPath() for prim in posed])
    cameras = [
        _read_camera(prim, name, rooms, top_m) for prim, name in zip(posed, names, strict=True)
    ]
    return StageViews(
        cameras=tuple(cameras) or _default_cameras(stage),
        rooms=tuple(rooms),
        has_dome=any(prim.IsA(UsdLux.DomeLight) or prim.IsA(UsdLux.DomeLight_1) for prim in prims),
    )


def _distinct_names(paths: list[Sdf.Path]) -> list[str]:
    """Names of prims; where two are the same, with the names of what they lie in."""
    count = Counter(path.name for path in paths)
    whole = [str(path).strip("/").replace("/", "_") for path in paths]
    return [
        path.name if count[path.name] == 1 else name
        for path, name in zip(paths, whole, strict=True)
    ]


def _top_m(stage: Usd.Stage) -> float:
    """Height of the house's bounds; extentsHint gives them without any mesh."""
    from pxr import Usd, UsdGeom

    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [UsdGeom.Tokens.default_], True)
    bounds = [cache.ComputeWorldBound(room).ComputeAlignedRange() for room in room_prims(stage)]
    up = 1 if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.y else 2
    tops = [box.GetMax()[up] for box in bounds if not box.IsEmpty()]
    return max(tops, default=float("inf")) * UsdGeom.GetStageMetersPerUnit(stage)


def _read_camera(prim: Usd.Prim, name: str, rooms: list[str], top_m: float) -> StageCamera:
    from pxr import UsdGeom

    stage = prim.GetStage()
    m_per_unit = UsdGeom.GetStageMetersPerUnit(stage)
    camera = UsdGeom.Camera(prim).GetCamera()
    matrix = rigid(camera.transform, stage)
    near, far = camera.clippingRange.min, camera.clippingRange.max
    return StageCamera(
        name=name,
        room=_room_of(name, rooms),
        matrix=matrix,
        focal_m=camera.focalLength * TENTHS * m_per_unit,
        aperture_m=camera.horizontalAperture * TENTHS * m_per_unit,
        shift=(
            camera.horizontalApertureOffset / camera.horizontalAperture,
            camera.verticalApertureOffset / camera.horizontalAperture,
        ),
        orthographic=camera.projection == camera.Orthographic,
        clip_m=(near * m_per_unit, far * m_per_unit),
        focus_m=camera.focusDistance * m_per_unit,
        f_stop=camera.fStop,
        from_above=matrix[2][3] > top_m,
        cut_m=_cut_m(prim),
        frame_height=camera.verticalAperture / camera.horizontalAperture,
    )


def _cut_m(prim: Usd.Prim) -> float:
    noted = prim.GetAttribute(CUT_NOTE).Get() if prim.HasAttribute(CUT_NOTE) else None
    return max(float(noted), 0.0) if isinstance(noted, int | float) else 0.0


def rigid(transform: Gf.Matrix4d, stage: Usd.Stage) -> Matrix:
    """A place of the stage in our world: metres, Z up, column vectors, scale removed; (4, 4)."""
    from pxr import Gf, UsdGeom

    if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.y:
        transform = transform * Gf.Matrix4d().SetRotate(Gf.Rotation(Gf.Vec3d(1, 0, 0), 90))
    place_m = transform.ExtractTranslation() * UsdGeom.GetStageMetersPerUnit(stage)
    turn = transform.RemoveScaleShear().ExtractRotationMatrix().GetTranspose()
    rows = [(*turn.GetRow(row), place_m[row]) for row in range(3)]
    return (*(tuple(float(x) for x in row) for row in rows), (0.0, 0.0, 0.0, 1.0))


def _room_of(name: str, rooms: list[str]) -> str:
    """A camera is named after its room, with or without a number behind it."""
    fitting = [room for room in rooms if name == room or name.startswith(f"{room}_")]
    return max(fitting, key=len, default="")


def _default_cameras(stage: Usd.Stage) -> tuple[StageCamera, ...]:
    """A view of everything from above one corner, for a stage that has none; none for nothing."""
    from pxr import Gf, Usd, UsdGeom

    stage.Load()
    cache = UsdGeom.BBoxCache(
        Usd.TimeCode.Default(), [UsdGeom.Tokens.default_, UsdGeom.Tokens.render]
    )
    box = cache.ComputeWorldBound(stage.GetPseudoRoot()).ComputeAlignedRange()
    if box.IsEmpty():
        return ()
    radius = max(box.GetSize().GetLength() / 2, 1e-3)
    middle = box.GetMidpoint()
    y_up = UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.y
    up, towards = (Gf.Vec3d(0, 1, 0), (-0.6, 0.45, 0.7)) if y_up else (Gf.Vec3d(0, 0, 1), _CORNER)
    eye = middle + Gf.Vec3d(*towards).GetNormalized() * radius * _FAR_RADII
    look = Gf.Matrix4d().SetLookAt(eye, middle, up).GetInverse()
    radius_m = radius * UsdGeom.GetStageMetersPerUnit(stage)
    return (
        StageCamera(
            name=DEFAULT_CAMERA,
            room="",
            matrix=rigid(look, stage),
            focal_m=0.05,
            aperture_m=0.036,
            shift=(0.0, 0.0),
            orthographic=False,
            clip_m=(0.01 * radius_m, 20.0 * radius_m),
            focus_m=0.0,
            f_stop=0.0,
            from_above=False,
        ),
    )
