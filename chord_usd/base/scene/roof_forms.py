"""The roofs a house can have, by name."""

from __future__ import annotations

from typing import Literal, get_args

RoofForm = Literal["none", "flat", "gable", "hip"]
ROOF_FORMS: tuple[RoofForm, ...] = get_args(RoofForm)
NO_ROOF: RoofForm = "none"
