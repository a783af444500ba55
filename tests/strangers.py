"""A victim's folder with a secret, and ways to make a stage point to it."""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image
from pxr import Sdf

from chord_usd.base.scene.types import Asset
from chord_usd.library.database import write_index

SECRET = b"-----BEGIN PRIVATE KEY----- of somebody else"


def tree(folder: Path) -> dict[str, str]:
    """Hash of every file, and what every link leads to."""
    found = {}
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        if path.is_symlink():
            found[name] = f"-> {path.readlink()}"
        elif path.is_file():
            found[name] = hashlib.sha256(path.read_bytes()).hexdigest()
        else:
            found[name] = "folder"
    return found


def leaks(folder: Path) -> list[str]:
    """Files that hold the secret, also inside archives, which store it as it is."""
    files = (f for f in folder.rglob("*") if f.is_file() and not f.is_symlink())
    return [str(file) for file in files if SECRET in file.read_bytes()]


@contextmanager
def victim_in(tmp_path: Path, block: Asset) -> Iterator[Path]:
    """A folder with a key, an asset beside it, a house; afterwards it must be the same."""
    folder = tmp_path / "victim"
    shutil.copytree(block.usd_path.parent, folder / "Block")
    own = replace(block, usd_path=folder / "Block" / "Block.usda")
    write_index([own], folder)
    (folder / "id_rsa").write_bytes(SECRET)
    (folder / "Block" / "id_rsa").write_bytes(SECRET)
    picture = Image.fromarray(np.full((8, 8, 3), 77, np.uint8))
    picture.save(folder / "private.png")
    with (folder / "private.png").open("ab") as file:
        file.write(SECRET)
    (folder / "house.usda").write_text('#usda 1.0\n(\n defaultPrim="House"\n)\ndef "House"\n{\n}\n')
    before = tree(folder)
    yield folder
    assert tree(folder) == before
    assert [leak for leak in leaks(tmp_path) if not leak.startswith(str(folder))] == []


def edited(path: Path, change: Callable[[Sdf.Layer], None]) -> Path:
    layer = Sdf.Layer.OpenAsAnonymous(str(path))
    change(layer)
    layer.Export(str(path))
    return path


def with_sublayer(target: str) -> Callable[[Sdf.Layer], None]:
    return lambda layer: layer.subLayerPaths.append(target)


def with_reference(target: str) -> Callable[[Sdf.Layer], None]:
    def change(layer: Sdf.Layer) -> None:
        prim = Sdf.CreatePrimInLayer(layer, "/House/Stranger")
        prim.specifier = Sdf.SpecifierDef
        prim.referenceList.prependedItems.append(Sdf.Reference(target))

    return change


def with_texture(target: str) -> Callable[[Sdf.Layer], None]:
    def change(layer: Sdf.Layer) -> None:
        prim = Sdf.CreatePrimInLayer(layer, "/House")
        value = Sdf.AttributeSpec(prim, "look", Sdf.ValueTypeNames.Asset)
        value.default = Sdf.AssetPath(target)

    return change


WAYS = [with_sublayer, with_reference, with_texture]


def names(way: Callable[..., object], victim: Path) -> str:
    return "private.png" if way is with_texture else "house.usda"
