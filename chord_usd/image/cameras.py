"""The cameras of a stage, in metres, read with usd-core."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd.errors import StageError

if TYPE_CHECKING:
    from pxr import Gf, Usd

TENTHS = 0.1
"""USD gives focal lengths and apertures in tenths of a scene unit."""

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
    from pxr import Usd, UsdGeom, UsdLux

    stage = open_stage(path)
    rooms = _room_prims(stage)
    prims = list(stage.Traverse(Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)))
    top_m = _top_m(stage)
    return StageViews(
        cameras=tuple(
            _read_camera(prim, [room.GetName() for room in rooms], top_m)
            for prim in prims
            if prim.IsA(UsdGeom.Camera)
        ),
        rooms=tuple(room.GetName() for room in rooms),
        has_dome=any(prim.IsA(UsdLux.DomeLight) or prim.IsA(UsdLux.DomeLight_1) for prim in prims),
    )


def open_stage(path: Path) -> Usd.Stage:
    """Open a stage with its payloads left out. Raises StageError."""
    from pxr import Tf, Usd

    if not path.is_file():
        raise StageError(
            "there is no such file",
            where=str(path),
            expected="a .usda, .usdc or .usdz stage",
            try_=f"chord-usd generate plan.png -o {path.name}",
        )
    try:
        return Usd.Stage.Open(str(path), Usd.Stage.LoadNone)
    except Tf.ErrorException as error:
        raise StageError(
            "cannot be opened as a stage",
            where=str(path),
            expected="a .usda, .usdc or .usdz stage",
            try_=f"chord-usd check {path.name}",
        ) from error


def _room_prims(stage: Usd.Stage) -> list[Usd.Prim]:
    house = stage.GetDefaultPrim()
    rooms = house.GetChild("Rooms") if house else None
    return list(rooms.GetChildren()) if rooms else []


def _top_m(stage: Usd.Stage) -> float:
    """Height of the house's bounds; extentsHint gives them without any mesh."""
    from pxr import Usd, UsdGeom

    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [UsdGeom.Tokens.default_], True)
    bounds = [cache.ComputeWorldBound(room).ComputeAlignedRange() for room in _room_prims(stage)]
    up = 1 if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.y else 2
    tops = [box.GetMax()[up] for box in bounds if not box.IsEmpty()]
    return max(tops, default=float("inf")) * UsdGeom.GetStageMetersPerUnit(stage)


def _read_camera(prim: Usd.Prim, rooms: list[str], top_m: float) -> StageCamera:
    from pxr import UsdGeom

    stage = prim.GetStage()
    m_per_unit = UsdGeom.GetStageMetersPerUnit(stage)
    camera = UsdGeom.Camera(prim).GetCamera()
    matrix = _matrix(camera.transform, m_per_unit, UsdGeom.GetStageUpAxis(stage))
    near, far = camera.clippingRange.min, camera.clippingRange.max
    return StageCamera(
        name=prim.GetName(),
        room=_room_of(prim, rooms),
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
    )


def _matrix(transform: Gf.Matrix4d, m_per_unit: float, up_axis: Any) -> Matrix:
    """Gf's row vectors to column vectors, scene units to metres, Y up to Z up, scale removed."""
    from pxr import Gf, UsdGeom

    if up_axis == UsdGeom.Tokens.y:
        transform = transform * Gf.Matrix4d().SetRotate(Gf.Rotation(Gf.Vec3d(1, 0, 0), 90))
    place_m = transform.ExtractTranslation() * m_per_unit
    turn = transform.RemoveScaleShear().ExtractRotationMatrix().GetTranspose()
    rows = [(*turn.GetRow(row), place_m[row]) for row in range(3)]
    return (*(tuple(float(x) for x in row) for row in rows), (0.0, 0.0, 0.0, 1.0))


def _room_of(prim: Usd.Prim, rooms: list[str]) -> str:
    """A camera is named after its room, with or without a number behind it."""
    name = prim.GetName()
    fitting = [room for room in rooms if name == room or name.startswith(f"{room}_")]
    return max(fitting, key=len, default="")
