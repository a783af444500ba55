"""Boxes, masks and camera matrices, without a stage."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from chord_usd.line.image.annotations import category_ids, intrinsics_px, run_lengths, semantic_mask
from chord_usd.line.image.job import Job, Negative, Part, Quality, read_job, write_job
from chord_usd.line.image.marks import Thing
from chord_usd.line.image.stage_cameras import StageCamera

IDENTITY = tuple(tuple(float(i == j) for j in range(4)) for i in range(4))
VIEW = StageCamera(
    name="A", room="", matrix=IDENTITY, focal_m=0.018, aperture_m=0.036, shift=(0.0, 0.0),
    orthographic=False, clip_m=(0.1, 100.0), focus_m=0.0, f_stop=0.0, from_above=False,
)  # fmt: skip


@given(arrays.arrays(np.bool_, st.tuples(st.integers(1, 7), st.integers(1, 7))))
def test_run_lengths_say_the_mask(mask: np.ndarray) -> None:
    told = run_lengths(mask)
    flat = np.repeat(np.arange(len(told["counts"])) % 2 == 1, told["counts"])
    np.testing.assert_array_equal(flat.reshape(told["size"], order="F"), mask)


def test_a_category_has_the_same_id_in_every_house() -> None:
    one, other = category_ids(["bed", "wall", "teapot"]), category_ids(["anvil", "wall", "bed"])
    assert one["bed"] == other["bed"]
    assert one["wall"] == other["wall"]
    assert one["teapot"] > max(one["bed"], one["wall"])
    assert len(set(one.values())) == 3


def test_the_semantic_mask_replaces_numbers_by_categories() -> None:
    things = [Thing(n, "/p", label, "", IDENTITY, (1, 1, 1)) for n, label in ((1, "bed"), (2, "a"))]
    ids = category_ids(["bed", "a"])
    told = semantic_mask(np.array([[0, 1], [2, 1]], dtype=np.uint16), things)
    assert told.tolist() == [[0, ids["bed"]], [ids["a"], ids["bed"]]]


def test_the_lens_in_pixels() -> None:
    """90 degrees wide: the focal length is half the width."""
    assert intrinsics_px(VIEW, (200, 100)) == [[100, 0, 100], [0, 100, 50], [0, 0, 1]]
    shifted = intrinsics_px(replace(VIEW, shift=(0.1, -0.2)), (200, 100))
    assert [row[2] for row in shifted[:2]] == [80, 10]


def test_a_job_crosses_as_json() -> None:
    job = Job(
        "f", "s", (VIEW,), 4, 3, Quality(samples=5), 1, part=Part((0, 2), (1, 4)),
        rooms=("A", "B"), joined=(("A", "B"),), negatives=(Negative("a", "b", 1.0),),
    )  # fmt: skip
    assert read_job(write_job(job)) == job


@given(st.integers(1, 40), st.integers(1, 40))
def test_bands_cover_every_row_once(height: int, count: int) -> None:
    rows = [Part((tile, count)).rows_px(height) for tile in range(count)]
    assert [row for first, last in rows for row in range(first, last)] == list(range(height))


def test_a_taller_picture_shows_no_more_below():
    view = replace(VIEW, shift=(0.0, -0.1), frame_height=9 / 16)

    def lowest(size_px):
        framed = view.framed(size_px)
        return framed.shift[1] - size_px[1] / size_px[0] / 2

    assert lowest((400, 300)) == pytest.approx(lowest((1600, 900)))
    assert view.framed((2000, 900)) is view
    assert replace(view, frame_height=0.0).framed((300, 400)).shift == (0.0, -0.1)
