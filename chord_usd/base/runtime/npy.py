"""Arrays in bytes, as NumPy saves them: read as views, nothing in them unpickled."""

from __future__ import annotations

import io
import math
from typing import Any

import numpy as np
import numpy.typing as npt

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
