"""Every format that is decoded: its reader, the library calls that it makes, and its limits.

Decoders of pictures, meshes, drawings and stages are the parts of a program that strangers' bytes
break. They run in a process of their own (runtime/confined.py), by the name of their row here and
not otherwise; tests/unit/test_decoders.py looks for calls elsewhere.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from chord_usd.errors import ChordError
from chord_usd.runtime.confined import DEFAULT, Limits, confined


@dataclass(frozen=True)
class Decoder:
    """A row of the table."""

    reader: str
    """module:function below chord_usd; nothing else names the function."""
    calls: dict[str, str]
    """Modules below chord_usd, each with the decoders of libraries that it calls."""
    limits: Limits = DEFAULT


_VECTOR = {
    "plan.vector.dxf": "ezdxf.recover.readfile",
    "plan.vector.ifc": "ifcopenshell.open",
    "plan.vector.safe_xml": "xml.etree.ElementTree.XMLPullParser",
}

DECODERS = {
    "plan picture": Decoder("plan.picture:_read", {"plan.picture": "PIL.Image.open"}),
    "layout raster": Decoder(
        "raster.raster_files:_open", {"raster.raster_files": "PIL.Image.open"}
    ),
    "PDF page": Decoder("plan.vector.pdf:_read_page", {"plan.vector.pdf": "pypdfium2.PdfDocument"}),
    "SVG page": Decoder(
        "plan.vector.svg_page:_read_page", {"plan.vector.svg_page": "PIL.Image.open"}
    ),
    "vector plan": Decoder("plan.vector.formats:_read_plan", _VECTOR),
    "vector storeys": Decoder("plan.vector.formats:_read_storeys", _VECTOR),
    "backdrop": Decoder("plan.vector.backdrop:_backdrop", _VECTOR),
    "sky": Decoder("raster.hdri:_developed", {"raster.hdri": "OpenEXR.InputFile cv2.imread"}),
    "mesh": Decoder(
        "assets.libraries.meshes:_read_here",
        {"assets.libraries.meshes": "trimesh.load PIL.Image.open"},
        Limits(cpu_s=100),
    ),
    "stages": Decoder(
        "runtime.stages:_try_all",
        {"runtime.stages": "pxr.Usd.Stage.Open pxr.Sdf.Layer.FindOrOpen"},
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
