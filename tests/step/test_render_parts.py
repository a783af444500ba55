"""Tiles and sample blocks: they fit together exactly, and only with their like."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from render_house import TINY, write_house

from chord_usd.base.errors import RenderError
from chord_usd.line.image.exr import read_exr, write_exr
from chord_usd.line.image.made import settings_record
from chord_usd.line.image.options import RenderOptions
from chord_usd.line.image.products import read_mask
from chord_usd.line.image.render import render_stage
from tests.every import later

SIZE_PX = (32, 19)
"""An odd height: bands of 9 and 10 rows."""

WANTED = replace(
    TINY, cameras=("Bedroom_0",), resolution_px=SIZE_PX, passes=("rgb", "depth", "instance")
)
"""Each part meters the light of the whole picture, which takes as long as the part."""

FIXED = replace(WANTED, exposure_ev=0.0)
DIVISION = [((tile, 2), (block, 2)) for tile in range(2) for block in range(2)]


@pytest.fixture(scope="module")
def house(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_house(tmp_path_factory.mktemp("house") / "house.usda")


@pytest.fixture(scope="module", params=[FIXED, *later(WANTED)], ids=["fixed", "metered"])
def wanted(request: pytest.FixtureRequest) -> RenderOptions:
    return request.param  # type: ignore[no-any-return]


@pytest.fixture(scope="module")
def parts(house: Path, wanted: RenderOptions, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the four parts of a picture, the last one made first."""
    folder = tmp_path_factory.mktemp("parts")
    for tile, block in reversed(DIVISION):
        made = render_stage(house, folder, replace(wanted, tile=tile, sample_block=block))
        assert len(made.files) == 1
    return folder


@pytest.fixture(scope="module")
def merged(house: Path, parts: Path, wanted: RenderOptions) -> Path:
    made = render_stage(house, parts, replace(wanted, merge=True))
    assert made.pictures == (parts / "Bedroom_0.png",)
    return parts


@pytest.fixture(scope="module")
def whole(house: Path, wanted: RenderOptions, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same picture as a single part."""
    folder = tmp_path_factory.mktemp("whole")
    render_stage(house, folder, replace(wanted, tile=(0, 1)))
    render_stage(house, folder, replace(wanted, merge=True))
    return folder


def part(folder: Path, tile: int, block: int) -> Path:
    return folder / f"Bedroom_0.tile-{tile}-of-2.block-{block}-of-2.exr"


def light_of(path: Path) -> np.ndarray:
    channels, _ = read_exr(path)
    return np.stack([channels[name] for name in "RGB"], axis=-1)


def test_parts_are_bands_with_their_own_light(parts: Path) -> None:
    assert [light_of(part(parts, tile, 0)).shape for tile in (0, 1)] == [(9, 32, 3), (10, 32, 3)]
    first, second = (light_of(part(parts, 0, block)) for block in (0, 1))
    assert not np.array_equal(first, second)


def test_only_the_first_block_holds_depth(parts: Path) -> None:
    """Cycles gives later blocks a depth of 1e10."""
    channels, _ = read_exr(part(parts, 0, 0))
    assert channels["Z"].max() < 10
    assert "Z" not in read_exr(part(parts, 0, 1))[0]


def test_equal_blocks_of_tiles_make_exactly_the_whole_picture(merged: Path, whole: Path) -> None:
    linear = light_of(whole / "Bedroom_0.tile-0-of-1.block-0-of-1.exr")
    mean = np.concatenate(
        [
            np.mean([light_of(part(merged, t, b)).astype(float) for b in (0, 1)], axis=0)
            for t in (0, 1)
        ]
    )
    np.testing.assert_allclose(mean, linear, rtol=2e-6, atol=1e-7)
    for name in ("Bedroom_0.exr", "Bedroom_0.depth.exr"):
        ours, theirs = (read_exr(folder / name)[0] for folder in (merged, whole))
        assert ours.keys() == theirs.keys()
        for channel in ours:
            np.testing.assert_allclose(ours[channel], theirs[channel], rtol=1e-3)
    masks = [read_mask(folder / "Bedroom_0.instance.png") for folder in (merged, whole)]
    np.testing.assert_array_equal(*masks)
    pictures = [np.asarray(Image.open(f / "Bedroom_0.png")).astype(int) for f in (merged, whole)]
    assert np.abs(pictures[0] - pictures[1]).max() <= 1


def test_a_tile_is_the_same_pixels_as_in_the_whole(
    house: Path, whole: Path, wanted: RenderOptions, tmp_path: Path
) -> None:
    render_stage(house, tmp_path, replace(wanted, tile=(1, 3)))
    tile = light_of(tmp_path / "Bedroom_0.tile-1-of-3.block-0-of-1.exr")
    linear = light_of(whole / "Bedroom_0.tile-0-of-1.block-0-of-1.exr")
    np.testing.assert_array_equal(tile, linear[19 // 3 : 19 * 2 // 3])


def test_a_merged_picture_has_its_annotations(merged: Path) -> None:
    sidecar = json.loads((merged / "Bedroom_0.json").read_text())
    assert sidecar["camera"]["width_px"] == 32
    assert {thing["path"].rsplit("/", 1)[1] for thing in sidecar["instances"]} >= {"Bed", "Floor"}
    assert len(json.loads((merged / "coco.json").read_text())["images"]) == 1


def test_finished_parts_are_skipped_and_damaged_ones_made_again(
    house: Path, parts: Path, wanted: RenderOptions, tmp_path: Path
) -> None:
    for tile, block in DIVISION:
        source = part(parts, tile[0], block[0])
        (tmp_path / source.name).write_bytes(source.read_bytes())
    options = replace(wanted, tile=(0, 2), sample_block=(0, 2), skip_existing=True)
    assert render_stage(house, tmp_path, options).rendered == 0
    damaged = part(tmp_path, 0, 0)
    channels, header = read_exr(damaged)
    channels["R"] = channels["R"] + 0.5
    write_exr(damaged, channels, {"chordPart": str(header["chordPart"])})
    with pytest.raises(RenderError, match=r"tile-0-of-2\.block-0-of-2\.exr: is damaged"):
        render_stage(house, tmp_path, replace(wanted, merge=True))
    assert render_stage(house, tmp_path, options).rendered == 1
    np.testing.assert_array_equal(light_of(damaged), light_of(part(parts, 0, 0)))


def test_a_missing_part_is_named_with_the_options_that_make_it(
    parts: Path, house: Path, wanted: RenderOptions, tmp_path: Path
) -> None:
    for source in (part(parts, 0, 0), part(parts, 0, 1), part(parts, 1, 1)):
        (tmp_path / source.name).write_bytes(source.read_bytes())
    with pytest.raises(RenderError, match=r"is missing.*expected a part of a picture. Try: tile="):
        render_stage(house, tmp_path, replace(wanted, merge=True))
    assert len(list(tmp_path.iterdir())) == 3


@pytest.mark.parametrize("change", [{"samples": 8}, {"seed": 3}, {"resolution_px": (32, 20)}])
def test_parts_of_another_picture_are_refused(
    house: Path, parts: Path, wanted: RenderOptions, change: dict
) -> None:
    """Cycles itself would average blocks of unequal size as if they were equal."""
    with pytest.raises(RenderError, match="was made with other options"):
        render_stage(house, parts, replace(wanted, merge=True, **change))


def test_two_divisions_in_one_folder_are_refused(
    house: Path, parts: Path, wanted: RenderOptions, tmp_path: Path
) -> None:
    for name in (part(parts, 0, 0).name, "Bedroom_0.tile-0-of-3.block-0-of-1.exr"):
        (tmp_path / name).write_bytes(part(parts, 0, 0).read_bytes())
    with pytest.raises(RenderError, match="more than one division"):
        render_stage(house, tmp_path, replace(wanted, merge=True))


def test_a_part_says_nothing_of_a_whole_picture() -> None:
    """Options of a part and of a whole picture are never taken for one another."""
    tile = settings_record(RenderOptions(tile=(0, 2)))
    assert tile != settings_record(RenderOptions())
    assert tile == settings_record(RenderOptions(tile=(1, 2)))
    assert tile == settings_record(RenderOptions(merge=True))


def test_a_sky_s_file_counts_by_its_content(tmp_path: Path) -> None:
    records = []
    for name, content in (("a", "x"), ("b", "x"), ("c", "y")):
        sky = tmp_path / f"{name}.hdr"
        sky.write_text(content)
        records.append(settings_record(RenderOptions(sky=str(sky)))["sky"])
    assert records[0] == records[1] != records[2]
