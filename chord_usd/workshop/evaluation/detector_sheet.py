"""A sheet of what the networks propose, drawn over the layouts, to be looked at."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from chord_usd.base.scene.palette import ROOM_RGB, category
from chord_usd.base.scene.types import ByteArray
from chord_usd.line.graph.detect import ItemDetector, RoomSegmenter
from chord_usd.workshop.evaluation.detector_cases import Case
from chord_usd.workshop.evaluation.report import enlarged

COLUMNS = 4
ENLARGE = 3
_ROOM_OPACITY = 0.45


PICTURES = (".png", ".jpg")


def draw_sheet(
    cases: Sequence[Case], detector: ItemDetector, segmenter: RoomSegmenter, suffix: str = ".png"
) -> bytes:
    """A picture file: per row COLUMNS layouts with the boxes proposed, below them the rooms.

    suffix: one of PICTURES.
    """
    rows = []
    for start in range(0, len(cases), COLUMNS):
        part = cases[start : start + COLUMNS]
        blank = [np.full_like(_boxes(part[0], detector), 255)] * (COLUMNS - len(part))
        rows.append(np.hstack([_boxes(case, detector) for case in part] + blank))
        rows.append(np.hstack([_rooms(case, segmenter) for case in part] + blank))
    done, data = cv2.imencode(suffix, cv2.cvtColor(np.vstack(rows), cv2.COLOR_RGB2BGR))
    assert done
    return bytes(data.tobytes())


def _boxes(case: Case, detector: ItemDetector) -> ByteArray:
    picture = enlarged(case.layout.rgb, ENLARGE)
    for detection in detector.detect(case.layout.rgb):
        corners = np.rint(detection.corners_px * ENLARGE).astype(np.int32)
        row = category(detection.category)
        # Colours darkened: they lie over the same colour.
        colour = tuple(int(value * 0.6) for value in row.rgb)
        cv2.polylines(picture, [corners], True, colour, 1, cv2.LINE_AA)
        at = (int(corners[:, 0].min()), int(corners[:, 1].min()) - 1)
        cv2.putText(picture, row.label[:7], at, cv2.FONT_HERSHEY_PLAIN, 0.6, colour)
    return picture


def _rooms(case: Case, segmenter: RoomSegmenter) -> ByteArray:
    rgb = case.layout.rgb.astype(np.float32)
    proposals = segmenter.segment(case.layout.rgb)
    for proposal in reversed(proposals):
        tint = np.array(ROOM_RGB[proposal.kind], dtype=np.float32)
        rgb[proposal.mask] = (1 - _ROOM_OPACITY) * rgb[proposal.mask] + _ROOM_OPACITY * tint
    picture = enlarged(rgb.astype(np.uint8), ENLARGE)
    for proposal in proposals:
        rows, columns = np.nonzero(proposal.mask)
        if len(rows):
            at = (int(columns.mean() - 8) * ENLARGE, int(rows.mean()) * ENLARGE)
            text = f"{proposal.kind} {proposal.score:.2f}"
            cv2.putText(picture, text, at, cv2.FONT_HERSHEY_PLAIN, 0.8, (0, 0, 0))
    return picture
