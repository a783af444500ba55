"""A small lit room as a stage, for the tests that render."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from PIL import Image
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdShade

from chord_usd.line.image.options import RenderOptions

SIZE_PX = (64, 36)
TINY = RenderOptions(resolution_px=SIZE_PX, samples=4, device="cpu")
FROM_ABOVE = replace(TINY, cameras=("Top",), exposure_ev=-1.8)
"""As the meter finds it, which takes as long as the picture."""

ROOM_M = (4.0, 3.5, 2.6)


def define_box(stage: Usd.Stage, path: str, low: tuple, high: tuple, rgb: tuple) -> None:
    """A box with flat normals and a material of its own."""
    mesh = UsdGeom.Mesh.Define(stage, path)
    (x0, y0, z0), (x1, y1, z1) = low, high
    ring = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    mesh.CreatePointsAttr([(x, y, z) for z in (z0, z1) for x, y in ring])
    mesh.CreateFaceVertexCountsAttr([4] * 6)
    faces = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    mesh.CreateFaceVertexIndicesAttr([corner for face in faces for corner in face])
    normals = [(0, 0, -1), (0, 0, 1), (0, -1, 0), (1, 0, 0), (0, 1, 0), (-1, 0, 0)]
    mesh.CreateNormalsAttr([normal for normal in normals for _ in range(4)])
    mesh.SetNormalsInterpolation("faceVarying")
    mesh.CreateSubdivisionSchemeAttr("none")
    mesh.CreateExtentAttr([low, high])
    material = UsdShade.Material.Define(stage, f"/House/Materials/{Sdf.Path(path).name}")
    surface = UsdShade.Shader.Define(stage, f"{material.GetPath()}/Surface")
    surface.CreateIdAttr("UsdPreviewSurface")
    surface.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(rgb)
    material.CreateSurfaceOutput().ConnectToSource(surface.ConnectableAPI(), "surface")
    UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(material)


def paint_red(stage: Usd.Stage, path: str, picture: Path) -> None:
    """Let a box wear a red texture, given by its path relative to the stage."""
    picture.parent.mkdir()
    Image.new("RGB", (4, 4), (200, 40, 40)).save(picture)
    st = UsdGeom.PrimvarsAPI(stage.GetPrimAtPath(path)).CreatePrimvar(
        "st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.faceVarying
    )
    st.Set([(0, 0), (1, 0), (1, 1), (0, 1)] * 6)
    texture = UsdShade.Shader.Define(stage, f"/House/Materials/{Sdf.Path(path).name}/Map")
    texture.CreateIdAttr("UsdUVTexture")
    texture.CreateInput("file", Sdf.ValueTypeNames.Asset).Set(f"./{picture.parent.name}/red.png")
    output = texture.CreateOutput("rgb", Sdf.ValueTypeNames.Float3)
    reader = UsdShade.Shader.Define(stage, f"/House/Materials/{Sdf.Path(path).name}/St")
    reader.CreateIdAttr("UsdPrimvarReader_float2")
    reader.CreateInput("varname", Sdf.ValueTypeNames.String).Set("st")
    texture.CreateInput("st", Sdf.ValueTypeNames.Float2).ConnectToSource(
        reader.CreateOutput("result", Sdf.ValueTypeNames.Float2)
    )
    surface = UsdShade.Shader.Get(stage, f"/House/Materials/{Sdf.Path(path).name}/Surface")
    surface.GetInput("diffuseColor").ConnectToSource(output)


def define_cameras(stage: Usd.Stage) -> None:
    length_m, width_m, _ = ROOM_M
    UsdGeom.Scope.Define(stage, "/House/Cameras")
    room = UsdGeom.Camera.Define(stage, "/House/Cameras/Bedroom_0")
    look = Gf.Matrix4d().SetLookAt(
        Gf.Vec3d(3.7, 0.3, 1.5), Gf.Vec3d(1, 2.6, 0.8), Gf.Vec3d(0, 0, 1)
    )
    room.AddTransformOp().Set(look.GetInverse())
    room.CreateFocalLengthAttr(0.2)
    room.CreateHorizontalApertureAttr(0.36)
    room.CreateVerticalApertureOffsetAttr(-0.018)
    top = UsdGeom.Camera.Define(stage, "/House/Cameras/Top")
    top.AddTransformOp().Set(Gf.Matrix4d().SetTranslate((length_m / 2, width_m / 2, 12)))
    top.CreateProjectionAttr("orthographic")
    top.CreateHorizontalApertureAttr(64.0)
    room.CreateClippingRangeAttr((0.05, 100))
    top.CreateClippingRangeAttr((0.05, 100))


def write_house(path: Path) -> Path:
    """One room with a red floor, a ceiling, four walls, a blue box, a lamp and two cameras."""
    path.parent.mkdir(exist_ok=True)
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/House").GetPrim())
    for name in ("Rooms", "Rooms/Bedroom_0", "Rooms/Bedroom_0/Geometry"):
        UsdGeom.Xform.Define(stage, f"/House/{name}")
    UsdGeom.Scope.Define(stage, "/House/Materials")
    geometry = "/House/Rooms/Bedroom_0/Geometry"
    length, width, height = ROOM_M
    white = (0.8, 0.8, 0.78)
    define_box(stage, f"{geometry}/Floor", (0, 0, -0.1), (length, width, 0), white)
    paint_red(stage, f"{geometry}/Floor", path.parent / "maps" / "red.png")
    define_box(stage, f"{geometry}/Ceiling", (0, 0, height), (length, width, height + 0.1), white)
    define_box(stage, f"{geometry}/Wall_0", (0, -0.1, 0), (length, 0, height), white)
    define_box(stage, f"{geometry}/Wall_1", (0, width, 0), (length, width + 0.1, height), white)
    define_box(stage, f"{geometry}/Wall_2", (-0.1, 0, 0), (0, width, height), white)
    define_box(stage, f"{geometry}/Wall_3", (length, 0, 0), (length + 0.1, width, height), white)
    define_box(stage, f"{geometry}/Bed", (0.4, 1.4, 0), (2.0, 3.4, 0.5), (0.05, 0.1, 0.6))
    lamp = UsdLux.RectLight.Define(stage, f"{geometry}/AreaLight")
    lamp.CreateIntensityAttr(30.0)
    UsdGeom.XformCommonAPI(lamp).SetTranslate((length / 2, width / 2, height - 0.05))
    define_cameras(stage)
    stage.Save()
    return path
