"""Values of a reader's process as JSON and npy: bytes that call no code when they are read back.

A message is one line of JSON, then npy arrays, which the JSON names by number. Lists, tuples,
dicts, sets, paths, bytes and arrays come back as they were, dataclasses of this package as copies.
"""

from __future__ import annotations

import io
import json
import math
import sys
from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path, PurePath
from typing import Any

import numpy as np
import numpy.typing as npt

from chord_usd.base.errors import ChordError

_PACKAGE = "chord_usd."
_LIST_TYPES = {"list": list, "tuple": tuple, "set": set, "frozenset": frozenset}
_ALIGNED_BYTES = 64
"""Arrays begin at multiples: OpenCV and GEOS copy others."""


def packed(value: object) -> Iterable[Any]:
    """The parts of a message, bytes or views of arrays. Raises TypeError for other types."""
    packer = _Packer()
    head = json.dumps(packer.tree(value)).encode()
    yield head + b" " * (-(len(head) + 1) % _ALIGNED_BYTES) + b"\n"
    for array in packer.arrays:
        header = io.BytesIO()
        described = np.lib.format.header_data_from_array_1_0(array)
        np.lib.format.write_array_header_1_0(header, described)
        yield header.getvalue()
        yield array.data.cast("B") if array.size else b""
        yield bytes(-array.nbytes % _ALIGNED_BYTES)


def unpacked(message: bytes) -> Any:
    """The value of a message; its arrays are views of it, and cannot be written to.

    Raises ValueError for bytes that are no message, and for classes that are not loaded here, or
    are neither dataclasses nor errors of this package.
    """
    head, _, _ = message.partition(b"\n")
    return _Reader(message, len(head) + 1).value(json.loads(head))


class _Packer:
    def __init__(self) -> None:
        self.arrays: list[np.ndarray[Any, Any]] = []
        self._numbers: dict[int, int] = {}
        self._held: list[object] = []  # else another object could take the place of a known one

    def tree(self, value: Any) -> Any:
        """JSON: scalars as they are, everything else as a list that begins with its kind."""
        if value is None or type(value) in (bool, int, float, str):
            return value
        for kind, of_type in _LIST_TYPES.items():
            if type(value) is of_type:
                return [kind, [self.tree(item) for item in value]]
        if isinstance(value, Mapping):
            return ["dict", [[self.tree(key), self.tree(item)] for key, item in value.items()]]
        if isinstance(value, PurePath):
            return ["path", str(value)]
        if isinstance(value, bytes | bytearray):
            return [type(value).__name__, self._number(value, np.frombuffer(value, np.uint8))]
        if isinstance(value, np.ndarray | np.generic):
            kind = "array" if isinstance(value, np.ndarray) else "scalar"
            return [kind, self._number(value, np.asarray(value))]
        if is_dataclass(value):
            parts = {field.name: self.tree(getattr(value, field.name)) for field in fields(value)}
            return ["data", *_named(type(value)), parts]
        if isinstance(value, ChordError):
            parts = {name: self.tree(part) for name, part in vars(value).items()}
            return ["error", *_named(type(value)), parts]
        raise TypeError(f"{type(value).__name__} is no value that can be sent")

    def _number(self, value: object, array: np.ndarray[Any, Any]) -> int:
        """The place of an array in the message; the same for the same object."""
        if array.dtype.hasobject:
            raise TypeError("an array of objects cannot be sent")
        if id(value) not in self._numbers:
            self._held.append(value)
            self._numbers[id(value)] = len(self.arrays)
            self.arrays.append(np.asarray(array, order="C"))
        return self._numbers[id(value)]


class _Reader:
    def __init__(self, message: bytes, begin: int) -> None:
        self._message, self._end = message, begin
        self._arrays: list[np.ndarray[Any, Any]] = []

    def value(self, tree: Any) -> Any:
        if not isinstance(tree, list):
            return tree
        kind, *parts = tree
        if kind in _LIST_TYPES:
            return _LIST_TYPES[kind](self.value(item) for item in parts[0])
        if kind == "dict":
            return {self.value(key): self.value(item) for key, item in parts[0]}
        if kind == "path":
            return Path(parts[0])
        if kind in ("bytes", "bytearray"):
            data = self._array(parts[0]).data
            return bytes(data) if kind == "bytes" else bytearray(data)
        if kind in ("array", "scalar"):
            return self._array(parts[0])[() if kind == "scalar" else ...]
        if kind in ("data", "error"):
            values = {name: self.value(part) for name, part in parts[2].items()}
            return _made(kind, _loaded(parts[0], parts[1]), values)
        raise ValueError(f"{kind!r} is no kind of value")

    def _array(self, number: int) -> np.ndarray[Any, Any]:
        while len(self._arrays) <= number:
            self._arrays.append(self._next())
        return self._arrays[number]

    def _next(self) -> np.ndarray[Any, Any]:
        array, end = array_in(self._message, self._end)
        self._end = end + -array.nbytes % _ALIGNED_BYTES
        return array


def _named(kind: type) -> tuple[str, str]:
    return kind.__module__, kind.__qualname__


def _loaded(module: str, name: str) -> type:
    """A class of this package by its name; nothing is imported for it."""
    loaded = getattr(sys.modules.get(module), name, None) if module.startswith(_PACKAGE) else None
    if not isinstance(loaded, type) or not (is_dataclass(loaded) or issubclass(loaded, ChordError)):
        raise ValueError(f"{module}.{name} is no class of values")
    return loaded


def _made(kind: str, of_type: type, values: dict[str, Any]) -> Any:
    if kind == "data" and is_dataclass(of_type):
        return of_type(
            **{field.name: values[field.name] for field in fields(of_type) if field.init}
        )
    if kind == "error" and issubclass(of_type, ChordError):
        known = {name: values.pop(name) for name in ("what", "where", "expected", "try_")}
        error = ChordError.__new__(of_type)
        ChordError.__init__(error, known.pop("what"), **known)
        vars(error).update(values)
        return error
    raise ValueError(f"{of_type.__name__} is no {kind}")


# Arrays in bytes, as NumPy saves them: read as views, nothing in them unpickled ------------------

_HEADERS = {
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
}


def array_in(data: bytes, begin: int = 0) -> tuple[npt.NDArray[Any], int]:
    """The array that begins at a byte, a view of data, and where it ends.

    Its header is believed only as far as there are bytes. Raises ValueError for what is no array of
    numbers or words.
    """
    file = io.BytesIO(data)  # shares the bytes
    file.seek(begin)
    try:
        shape, is_fortran, dtype = _HEADERS[np.lib.format.read_magic(file)](file)
    except (KeyError, TypeError, OverflowError, SyntaxError) as problem:
        raise ValueError(str(problem)) from None
    if dtype.hasobject or min(shape, default=0) < 0:
        raise ValueError("holds objects, or less than nothing")
    count = math.prod(shape)
    if count * dtype.itemsize > len(data) - file.tell():
        raise ValueError("holds less than it says")
    values = np.frombuffer(data, dtype, count, file.tell()) if count else np.empty(0, dtype)
    ends = file.tell() + values.nbytes
    return values.reshape(shape, order="F" if is_fortran else "C"), ends
