"""Other packages of a house: a flat .usdz for web viewers, a GLB for everything else.

Web viewers (three.js, tinyusdz) load no payloads and know no instances: for them the stage is
written out plainly, with what is not seen left away.
"""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from pxr import Sdf, Usd, UsdGeom, UsdUtils

from chord_usd.errors import OutputError
from chord_usd.files import deliver
from chord_usd.stage.author import ARCHIVE_TIME_S
from chord_usd.stage.gltf import scene_of
from chord_usd.stage.read import open_stage

PACKAGES = {"web": ".usdz", "gltf": ".glb"}
"""Kinds of packages and the suffix of their file."""

_UNSEEN = ("PhysicsScene", "PhysicsRevoluteJoint", "DomeLight", "RenderSettings", "RenderProduct")


def export_stage(stage: Path, path: Path, package: str) -> None:
    """Write the stage at stage as a package of this kind, one of PACKAGES.

    Variants are those that the stage has selected. Raises StageError for a file that cannot be
    opened, OutputError for a target of another suffix or one that cannot be written.
    """
    if path.suffix != PACKAGES[package]:
        raise OutputError(
            f"{path.suffix or 'no suffix'} is not the suffix of a {package} package",
            where=str(path),
            expected=PACKAGES[package],
            try_=f"-o {path.with_suffix(PACKAGES[package]).name}",
        )
    opened = open_stage(stage)
    with deliver() as delivery:
        target = delivery.place(path)
        if package == "web":
            _write_web(opened, target)
        else:
            target.write_bytes(scene_of(opened).export(file_type="glb"))


def _write_web(stage: Usd.Stage, target: Path) -> None:
    stage.SetEditTarget(stage.GetSessionLayer())
    for prim in list(stage.Traverse()):
        if prim.IsInstanceable():
            prim.SetInstanceable(False)
    for prim in list(stage.Traverse()):
        if prim.IsValid() and _is_unseen(prim):
            prim.SetActive(False)
    with tempfile.TemporaryDirectory(dir=target.parent) as folder:
        layer = stage.Flatten(addSourceFileComment=False)
        _drop_inactive(layer)
        flat = Path(folder) / f"{target.stem}.usdc"
        layer.Export(str(flat))
        for file in Path(folder).iterdir():  # the archive notes their times
            os.utime(file, (ARCHIVE_TIME_S, ARCHIVE_TIME_S))
        # While it renames textures, USD complains that their new names are not there yet.
        quiet = UsdUtils.CoalescingDiagnosticDelegate()
        UsdUtils.CreateNewUsdzPackage(Sdf.AssetPath(str(flat)), str(target))
        quiet.TakeUncoalescedDiagnostics()


def _is_unseen(prim: Usd.Prim) -> bool:
    """Colliders, hinges, skies and render settings, and the scopes of colliders."""
    guide = UsdGeom.Imageable(prim).GetPurposeAttr().Get() == UsdGeom.Tokens.guide
    return prim.GetTypeName() in _UNSEEN or prim.GetName() == "Colliders" or guide


def _drop_inactive(layer: Sdf.Layer) -> None:
    """Remove what is switched off, and the classes that nothing inherits any more."""
    found: list[Sdf.Path] = []

    def note(path: Sdf.Path) -> None:
        prim = layer.GetPrimAtPath(path) if path.IsPrimPath() else None
        if prim and (not prim.active or path == "/__class__"):
            found.append(path)

    layer.Traverse(Sdf.Path.absoluteRootPath, note)
    edit = Sdf.BatchNamespaceEdit()
    for path in found:
        if not any(path != other and path.HasPrefix(other) for other in found):
            edit.Add(path, Sdf.Path.emptyPath)
    layer.Apply(edit)
