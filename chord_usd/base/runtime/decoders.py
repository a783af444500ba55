"""Every format that is decoded: its reader, the library calls that it makes, and its limits.

Decoders of pictures, meshes, drawings and stages are the parts of a program that strangers' bytes
break. They run in a process of their own (confined.py), by the name of their row here and
not otherwise; tests/unit/test_decoders.py looks for calls elsewhere.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from chord_usd.base.errors import ChordError
from chord_usd.base.runtime.confined import DEFAULT, Limits, confined


@dataclass(frozen=True)
class Decoder:
    """A row of the table."""

    reader: str
    """module:function below chord_usd; nothing else names the function."""
    calls: dict[str, str]
    """Modules below chord_usd, each with the decoders of libraries that it calls."""
    limits: Limits = DEFAULT


_VECTOR = {
    "line.plan.vector.dxf": "ezdxf.recover.readfile",
    "line.plan.vector.ifc": "ifcopenshell.open",
    "line.plan.vector.safe_xml": "xml.etree.ElementTree.XMLPullParser",
}

DECODERS = {
    "plan picture": Decoder("line.plan.picture:_read", {"line.plan.picture": "PIL.Image.open"}),
    "layout raster": Decoder(
        "base.raster.raster_files:_open", {"base.raster.raster_files": "PIL.Image.open"}
    ),
    "PDF page": Decoder(
        "line.plan.vector.pdf:_read_page", {"line.plan.vector.pdf": "pypdfium2.PdfDocument"}
    ),
    "SVG page": Decoder(
        "line.plan.vector.svg_page:_read_page", {"line.plan.vector.svg_page": "PIL.Image.open"}
    ),
    "vector plan": Decoder("line.plan.vector.formats:_read_plan", _VECTOR),
    "vector storeys": Decoder("line.plan.vector.formats:_read_storeys", _VECTOR),
    "backdrop": Decoder("line.plan.vector.backdrop:_backdrop", _VECTOR),
    "sky": Decoder(
        "base.raster.hdri:_developed", {"base.raster.hdri": "OpenEXR.InputFile cv2.imread"}
    ),
    "mesh": Decoder(
        "library.libraries.meshes:_read_here",
        {"library.libraries.meshes": "trimesh.load PIL.Image.open"},
        Limits(cpu_s=100),
    ),
    "stages": Decoder(
        "base.runtime.stages:_try_all",
        {"base.runtime.stages": "pxr.Usd.Stage.Open pxr.Sdf.Layer.FindOrOpen"},
        Limits(cpu_s=40),
    ),
}


def decode(
    name: str,
    *arguments: object,
    where: str,
    error: type[ChordError] = ChordError,
    meanwhile: Callable[[], object] | None = None,
) -> Any:
    """What the reader of a row makes of its arguments, in a process with the row's limits.

    where, error, meanwhile: as confined has them. Raises what confined raises.
    """
    row = DECODERS[name]
    module, _, function = row.reader.partition(":")
    reader = getattr(import_module(f"chord_usd.{module}"), function)
    return confined(
        reader, *arguments, where=where, limits=row.limits, error=error, meanwhile=meanwhile
    )
