"""A GLB as it is built up: entries of its JSON, and one buffer behind them."""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np

from chord_usd import __version__

Entry = dict[str, Any]

_COMPONENTS = {"float32": 5126, "uint32": 5125, "uint16": 5123}
_WIDTHS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
_VERTICES, _INDICES = 34962, 34963
_JSON, _BINARY = b"JSON", b"BIN\0"


class GltfFile:
    """Lists of glTF 2.0 that are referred to by place, and the bytes that they point to."""

    def __init__(self) -> None:
        self._lists: dict[str, list[Entry]] = {}
        self._data = bytearray()
        self._extensions: dict[str, Entry] = {}

    def add(self, kind: str, entry: Entry) -> int:
        """Append to `nodes`, `meshes`, ...; returns the place there."""
        entries = self._lists.setdefault(kind, [])
        entries.append(entry)
        return len(entries) - 1

    def add_light(self, light: Entry) -> int:
        """Append to the lights of KHR_lights_punctual."""
        lights = self.extend("KHR_lights_punctual").setdefault("lights", [])
        lights.append(light)
        return len(lights) - 1

    def extend(self, name: str) -> Entry:
        """Say that an extension is used; returns what the file says of it."""
        return self._extensions.setdefault(name, {})

    def add_view(self, data: bytes, **more: int) -> int:
        """Append bytes to the buffer; returns the place of their view."""
        self._data += b"\0" * (-len(self._data) % 4)
        view = {"buffer": 0, "byteOffset": len(self._data), "byteLength": len(data), **more}
        self._data += data
        return self.add("bufferViews", view)

    def add_vertices(self, values: np.ndarray, *, bounded: bool = False) -> int:
        """An accessor of (N, K) float32; bounded: with its bounds, as glTF wants of positions."""
        values = np.ascontiguousarray(values, dtype=np.float32)
        entry: Entry = {}
        if bounded:
            entry = {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()}
        return self._accessor(values, _VERTICES, entry)

    def add_indices(self, values: np.ndarray) -> int:
        """An accessor of whole numbers, as short as they fit. 65535 means something else there."""
        short = values.max() < np.iinfo(np.uint16).max
        values = np.ascontiguousarray(values.reshape(-1), np.uint16 if short else np.uint32)
        return self._accessor(values, _INDICES, {})

    def _accessor(self, values: np.ndarray, target: int, entry: Entry) -> int:
        view = self.add_view(values.tobytes(), target=target)
        width = values.shape[1] if values.ndim == 2 else 1
        kind = {"componentType": _COMPONENTS[values.dtype.name], "type": _WIDTHS[width]}
        return self.add("accessors", {"bufferView": view, "count": len(values), **kind, **entry})

    def to_bytes(self, root: int) -> bytes:
        """The GLB whose scene has this one root node."""
        document: Entry = {
            "asset": {"version": "2.0", "generator": f"chord-usd {__version__}"},
            "scene": 0,
            "scenes": [{"nodes": [root]}],
            **self._lists,
        }
        if self._extensions:
            document["extensionsUsed"] = sorted(self._extensions)
            said = {name: what for name, what in self._extensions.items() if what}
            document |= {"extensions": said} if said else {}
        if self._data:
            document["buffers"] = [{"byteLength": len(self._data)}]
        text = json.dumps(document, separators=(",", ":"), ensure_ascii=False).encode()
        chunks = _chunk(_JSON, text, b" ") + (_chunk(_BINARY, self._data, b"\0"))
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def _chunk(kind: bytes, data: bytes | bytearray, filler: bytes) -> bytes:
    data = bytes(data) + filler * (-len(data) % 4)
    return struct.pack("<I4s", len(data), kind) + data if data else b""
