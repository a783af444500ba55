"""Names and areas of rooms on pictures from straight above."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import shapely
from PIL import Image

from chord_usd.base.scene.geometry import footprint, room_polygon
from chord_usd.base.scene.types import SceneGraph
from chord_usd.line.image.room_labels import RoomLabel, read_labels, write_labels
from chord_usd.line.image.stage_cameras import StageCamera, read_views

SIZE_PX = (640, 360)


def camera(stage: Path, name: str) -> StageCamera:
    return next(one for one in read_views(stage).cameras if one.name == name)


def written_px(view: StageCamera, label: RoomLabel) -> np.ndarray:
    """(N, 2) pixels that a label changes, x and y."""
    paper = Image.new("RGB", SIZE_PX, (128, 128, 128))
    write_labels(paper, view, [label])
    return np.argwhere((np.asarray(paper) != 128).any(axis=2))[:, ::-1]


def test_rooms_have_their_names_and_areas(staged_house: Path, staged_graph: SceneGraph) -> None:
    labels = read_labels(staged_house)
    for room, label in zip(staged_graph.rooms, labels, strict=True):
        name, area = label.text.split("\n")
        same = sum(other.kind == room.kind for other in staged_graph.rooms)
        assert name.lower().startswith((room.name or room.kind).lower())
        assert name[-1].isdigit() == (same > 1) or room.name
        assert area == f"{room_polygon(room).area:.1f} m²"
    assert len({label.text.split("\n")[0] for label in labels}) == len(labels)


def test_labels_are_read_on_free_floor(staged_house: Path, staged_graph: SceneGraph) -> None:
    for room, label in zip(staged_graph.rooms, read_labels(staged_house), strict=True):
        point = shapely.Point(label.at_m[:2])
        assert room_polygon(room).contains(point)
        for item in staged_graph.items_of(room.id):
            assert not shapely.Polygon(footprint(item.box)).buffer(-0.01).contains(point)


def test_a_label_is_written_within_its_room(staged_house: Path, staged_graph: SceneGraph) -> None:
    view = camera(staged_house, "Top")
    middle_m = np.array([row[3] for row in view.matrix[:2]])
    for room, label in zip(staged_graph.rooms, read_labels(staged_house), strict=True):
        px = written_px(view, label)
        assert len(px) > 20
        from_middle = (px.mean(axis=0) - np.array(SIZE_PX) / 2) * view.aperture_m / SIZE_PX[0]
        at_m = middle_m + from_middle * (1.0, -1.0)
        assert room_polygon(room).buffer(0.1).contains(shapely.Point(at_m))


def test_other_storeys_and_views_have_no_labels(staged_house: Path) -> None:
    label = read_labels(staged_house)[0]
    upstairs = RoomLabel("Attic", (*label.at_m[:2], 2.8), label.across_m)
    top = camera(staged_house, "Top")
    assert not len(written_px(top, upstairs))
    assert not len(written_px(camera(staged_house, "Isometric"), label))
