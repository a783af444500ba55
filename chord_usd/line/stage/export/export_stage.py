"""Other packages of a house: one table of their kinds."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from pathlib import Path

from chord_usd.base.errors import OutputError
from chord_usd.base.runtime.files import Copies, deliver, output_folder
from chord_usd.base.runtime.locations import absolute
from chord_usd.base.runtime.stages import open_stage, own_files, reading
from chord_usd.base.runtime.targets import FolderMode
from chord_usd.line.stage.author.attribution import attribution_file

PACKAGES = {
    "web": ".usdz", "ar": ".usdz", "gltf": ".glb", "ifc": ".ifc", "dxf": ".dxf", "ros": "",
    "robot": ".json", "mujoco": "", "urdf": "", "sdf": "", "habitat": "", "materialx": "",
}  # fmt: skip
"""Kinds of packages and the suffix of their file; "" for a folder."""

_WRITERS = {
    "web": "web.write_web",
    "ar": "web.write_ar",
    "gltf": "gltf.write_glb",
    "ifc": "exchange.ifc_model.write_ifc",
    "dxf": "exchange.dxf_drawing.write_dxf",
    "ros": "exchange.robot_map.write_map",
    "robot": "exchange.robot_layer.write_robot_layer",
    "mujoco": "exchange.mjcf_model.write_mjcf",
    "urdf": "exchange.urdf_model.write_urdf",
    "sdf": "exchange.sdf_model.write_sdf",
    "habitat": "exchange.habitat.write_habitat",
    "materialx": "exchange.materialx.write_materialx",
}
"""What writes each, in this folder: a function of the open stage and of where to write."""

_FILES = (".yaml", ".pgm", ".json", ".xml", ".mjcf", ".urdf", ".sdf")
"""Suffixes of what lies in folders: whoever names such a file means its folder."""


def export_stage(
    stage: Path, path: Path, package: str, mode: FolderMode = "new", *, photometric: bool = False
) -> None:
    """Write the stage at stage as a package of this kind, one of PACKAGES.

    Variants are those that the stage has selected. mode: what becomes of a folder that is there.
    photometric: lights of a .glb in candela and lux. Raises StageError for a file that cannot be
    opened or that points out of its folder, OutputError for a target of another suffix or one that
    cannot be written, MissingExtraError.
    """
    if package not in PACKAGES:
        raise OutputError(
            f"{package!r} is no kind of package", where=str(path),
            expected=f"one of {', '.join(PACKAGES)}",
        )  # fmt: skip
    suffix = PACKAGES[package]
    if suffix and path.suffix != suffix:
        raise OutputError(
            f"{path.suffix or 'no suffix'} is not the suffix of a {package} package",
            where=str(path),
            expected=suffix,
            try_=f"-o {path.with_suffix(suffix).name}",
        )
    if not suffix and path.suffix in _FILES:
        raise OutputError(
            f"is named as a file, and a {package} package is a folder",
            where=str(path),
            expected="the name of a folder",
            try_=f"-o {path.stem}",
        )
    module, _, name = _WRITERS[package].rpartition(".")
    write: Callable[..., None] = getattr(
        importlib.import_module(f"chord_usd.line.stage.export.{module}"), name
    )
    more = {"photometric": True} if photometric else {}
    # A package holds what the stage points to: not a file from elsewhere on this machine.
    own_files(stage)
    with reading(stage), deliver() as delivery:
        target = delivery.place(path) if suffix else delivery.place_folder(path, mode)
        write(open_stage(stage), target, **more)


def copy_stage(stage: Path, folder: Path, mode: FolderMode = "new") -> Path:
    """Copy the stage, all it points to and its list of makers into a folder; returns the copy.

    mode: what becomes of a folder that is there. Raises StageError for a file that cannot be opened
    or that points out of its folder, OutputError.
    """
    with output_folder(folder, mode) as staged:
        copy_files(stage, staged)
    return folder / stage.name


def copy_files(stage: Path, folder: Path) -> list[Path]:
    """Copy the stage, all it points to and its list of makers into a folder of our own; returns the
    copies of its layers, its own first. Raises StageError as copy_stage does."""
    files, home = own_files(stage), absolute(stage).parent
    makers = attribution_file(absolute(stage))
    copies = Copies()
    for file in (*files.layers, *files.others, *([makers] if makers.is_file() else [])):
        copies.add(file, folder / file.relative_to(home))
    return [folder / layer.relative_to(home) for layer in files.layers]
