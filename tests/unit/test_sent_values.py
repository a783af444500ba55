"""What a reader's process sends comes back as it was, and nothing in it can call code."""

from __future__ import annotations

import json
import os
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from chord_usd.base.errors import PlanError
from chord_usd.base.runtime.confined import confined
from chord_usd.base.runtime.sent_values import packed, unpacked
from chord_usd.base.scene.types import Box, Room

pytestmark = pytest.mark.usefixtures("fresh_readers")


def through(value: object) -> Any:
    return unpacked(b"".join(packed(value)))


class Trap:
    """Pickle would call os.mkdir while it reads this."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def __reduce__(self) -> tuple[Any, tuple[str]]:
        return os.mkdir, (str(self.folder),)


def answer_in_pickle(folder: Path) -> None:
    """A reader that was taken over writes its answer itself."""
    for descriptor in range(3, 16):
        try:
            os.write(descriptor, pickle.dumps(("result", Trap(folder), "")))
        except OSError:
            continue
    os._exit(0)


def test_values_come_back_as_they_were() -> None:
    corners = np.arange(8.0).reshape(4, 2)[:, ::-1]
    value = {
        "deep": [(1, 2.5, None, True, "é\ud800"), {3}, frozenset({"a"}), b"\0\n", bytearray(b"x")],
        (1, "key"): Path("a/b"),
        "empty": np.empty((0, 3), np.float32),
        "scalars": [np.float64(1.5), np.int64(3)],
        "nan": float("inf"),
    }
    found = through(value)
    assert found["deep"] == value["deep"]
    assert found[1, "key"] == Path("a/b")
    assert found["empty"].shape == (0, 3)
    assert found["empty"].dtype == np.float32
    assert [type(one) for one in found["scalars"]] == [np.float64, np.int64]
    assert found["nan"] == float("inf")
    room = through(Room("r", "bedroom", corners, extra={"box": Box((0, 0, 0), (1, 1, 1), 0.0)}))
    assert np.array_equal(room.polygon_m, corners)
    assert room.extra["box"] == Box((0, 0, 0), (1, 1, 1), 0.0)


def test_arrays_are_views_and_the_same_array_is_sent_once() -> None:
    pixels = np.ones((500, 500, 3), np.uint8)
    message = b"".join(packed([pixels, pixels]))
    assert len(message) < pixels.nbytes + 500
    first, second = unpacked(message)
    assert np.shares_memory(first, second)
    assert not first.flags.writeable
    assert first.flags.aligned


def test_errors_keep_their_parts() -> None:
    error = PlanError("is odd", where="x.pdf", expected="even", try_="again")
    found = through(error)
    assert (type(found), vars(found), str(found)) == (PlanError, vars(error), str(error))


@pytest.mark.parametrize(
    "tree",
    [
        ["data", "os", "system", {"command": "true"}],
        ["data", "chord_usd.base.runtime.confined", "confined", {}],
        ["data", "chord_usd.not_loaded", "Name", {}],
        ["error", "builtins", "SystemExit", {}],
        ["error", "chord_usd.base.scene.types", "Box", {}],
        ["call", "os.system", ["true"]],
    ],
)
def test_no_other_class_is_made(tree: list[Any]) -> None:
    with pytest.raises(ValueError, match="no "):
        unpacked(json.dumps(tree).encode() + b"\n")


def test_objects_inside_arrays_are_not_read() -> None:
    with pytest.raises(TypeError):
        through(np.array([{}], object))
    whole = b"".join(packed(np.zeros(4)))
    with pytest.raises(ValueError, match="objects"):
        unpacked(whole.replace(b"<f8'", b"|O' "))


def test_a_reader_that_was_taken_over_runs_no_code_here(tmp_path: Path) -> None:
    with pytest.raises(PlanError, match="damaged"):
        confined(answer_in_pickle, tmp_path / "made", where="plan.pdf", error=PlanError)
    assert not (tmp_path / "made").exists()
