"""Other packages of a house: a flat .usdz for web viewers, a GLB for everything else."""

from __future__ import annotations

from pathlib import Path

from chord_usd.errors import OutputError
from chord_usd.runtime.files import deliver
from chord_usd.runtime.stages import open_stage, own_files, reading
from chord_usd.stage.gltf import scene_of
from chord_usd.stage.web import write_web

PACKAGES = {"web": ".usdz", "gltf": ".glb"}
"""Kinds of packages and the suffix of their file."""


def export_stage(stage: Path, path: Path, package: str) -> None:
    """Write the stage at stage as a package of this kind, one of PACKAGES.

    Variants are those that the stage has selected. Raises StageError for a file that cannot be
    opened or that points out of its folder, OutputError for a target of another suffix or one
    that cannot be written.
    """
    if path.suffix != PACKAGES[package]:
        raise OutputError(
            f"{path.suffix or 'no suffix'} is not the suffix of a {package} package",
            where=str(path),
            expected=PACKAGES[package],
            try_=f"-o {path.with_suffix(PACKAGES[package]).name}",
        )
    # A package holds what the stage points to: not a file from elsewhere on this machine.
    own_files(stage)
    with reading(stage), deliver() as delivery:
        target = delivery.place(path)
        if package == "web":
            write_web(open_stage(stage), target)
        else:
            target.write_bytes(scene_of(open_stage(stage)).export(file_type="glb"))
