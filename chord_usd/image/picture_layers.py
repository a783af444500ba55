"""Layers over a stage for one picture, which leave the stage itself alone."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.errors import RenderError
from chord_usd.runtime.scratch import scratch_folder
from chord_usd.runtime.stages import open_layer, open_stage

if TYPE_CHECKING:
    from pxr import Sdf

VARIANT_SET = "lighting"
"""On the default prim."""

_KEPT = ("defaultPrim", "upAxis", "metersPerUnit")
"""Metadata that a stage takes from its topmost layer alone."""


@contextmanager
def lit_stage(path: Path, lighting: str) -> Iterator[Path]:
    """Yield a stage with this choice of its variant set `lighting`; "" yields the stage itself.

    It is a layer over the stage, thrown away afterwards. Raises StageError for a stage that cannot
    be read, RenderError with the choices there are.
    """
    from pxr import Sdf

    if not lighting:
        yield path
        return
    house = _check(path, lighting)
    with layer_over(path) as (layer, file):
        prim = Sdf.PrimSpec(layer, house, Sdf.SpecifierOver)
        prim.variantSelections[VARIANT_SET] = lighting
        layer.Save()
        yield file


@contextmanager
def layer_over(path: Path) -> Iterator[tuple[Sdf.Layer, Path]]:
    """Yield an empty layer over a stage and its file, which goes away afterwards."""
    from pxr import Sdf

    below = open_layer(path.absolute())
    with scratch_folder() as folder:
        file = folder / "over.usda"
        layer = Sdf.Layer.CreateNew(str(file))
        layer.subLayerPaths.append(str(path.absolute()))
        for key in _KEPT:
            if below.pseudoRoot.HasInfo(key):
                layer.pseudoRoot.SetInfo(key, below.pseudoRoot.GetInfo(key))
        yield layer, file


def _check(path: Path, lighting: str) -> str:
    """Name of the prim with the variant set."""
    stage = open_stage(path, load=False)
    house = stage.GetDefaultPrim()
    choices = house.GetVariantSet(VARIANT_SET).GetVariantNames() if house else []
    if lighting not in choices:
        raise RenderError(
            f"has no lighting '{lighting}'",
            where=str(path),
            expected=f"one of {', '.join(choices)}" if choices else "a stage with such variants",
        )
    return str(house.GetName())
