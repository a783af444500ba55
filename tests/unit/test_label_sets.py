"""Our labels in the label sets of others."""

from __future__ import annotations

import re

import numpy as np
import pytest

from chord_usd.base.scene.category_rows import category_rows
from chord_usd.base.scene.label_sets import LABEL_SETS, OWN, class_of, classes_of, wikidata_item
from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.line.image.annotations import BUILDING, coco

OTHERS = [name for name in LABEL_SETS if name != OWN]

PUBLISHED = {
    "coco": (80, {"person": 1, "chair": 62, "couch": 63, "dining table": 67, "toothbrush": 90}),
    "ade20k": (150, {"wall": 1, "bed": 8, "sofa": 24, "light": 83, "sconce": 135, "flag": 150}),
    "nyu40": (40, {"wall": 1, "curtain": 16, "refridgerator": 24, "lamp": 35, "otherprop": 40}),
}
"""How many classes a set has, and some of their ids, gaps and all."""


@pytest.mark.parametrize("name", OTHERS)
def test_classes_have_their_published_ids(name: str) -> None:
    count, known = PUBLISHED[name]
    classes = classes_of(name)
    assert len(classes) == len(set(classes.values())) == count
    assert known.items() <= classes.items()


def test_every_label_has_a_row_of_classes_that_the_sets_have() -> None:
    assert category_rows().keys() >= {*CATEGORIES, *BUILDING}
    for label in category_rows():
        assert re.fullmatch(r"Q[1-9]\d+", wikidata_item(label))
        for name in OTHERS:
            assert class_of(label, name) in {*classes_of(name), None}
        assert class_of(label, "nyu40") is not None  # it has classes for all that is left over


def test_labels_that_are_not_ours_stand_for_themselves() -> None:
    assert class_of("traffic_light", "coco") == "traffic light"
    assert class_of("no such thing", "ade20k") is None
    assert class_of("no such thing", "nyu40") == "otherprop"


@pytest.mark.parametrize("name", OTHERS)
def test_annotations_hold_only_what_the_set_has(name: str) -> None:
    labels = ("sofa", "candle", "wall", "leisure_sofa")
    things = [
        {"id": n, "label": label, "category_id": 500 + n, "box_px": [0, n, 1, 1], "area_px": 1,
         "path": f"/House/{label}"}
        for n, label in enumerate(labels, start=1)
    ]  # fmt: skip
    mask = np.arange(1, 5, dtype=np.uint16)[:, None]
    told = coco([("A.png", {"instances": things}, mask)], name)
    assert {c["name"]: c["id"] for c in told["categories"]} == classes_of(name)
    wanted = {
        f"/House/{label}": classes_of(name)[found]
        for label in labels
        if (found := class_of(label, name)) is not None
    }
    assert {a["prim_path"]: a["category_id"] for a in told["annotations"]} == wanted
    assert [a["id"] for a in told["annotations"]] == [n + 1 for n in range(len(wanted))]
