"""Vector files -> Plan: SVG, DXF, IFC, Sweet Home 3D. One file per format, `assemble` for all."""

from __future__ import annotations

from pathlib import Path

READERS = {
    ".svg": ("svg", "read_svg"),
    ".dxf": ("dxf", "read_dxf"),
    ".ifc": ("ifc", "read_ifc"),
    ".sh3d": ("sweethome", "read_sweethome"),
}
"""Module and function by suffix."""

SUFFIXES = tuple(READERS)


def is_vector(path: Path) -> bool:
    """Whether a file is read as shapes, by its suffix."""
    return path.suffix.lower() in READERS


def is_svg(path: Path) -> bool:
    """Whether a vector file is drawn for the eye, too, and can be read by its looks."""
    return path.suffix.lower() == ".svg"
