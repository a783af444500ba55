"""Which class of IFC4 a category of ours is."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple


class IfcClass(NamedTuple):
    """A class of elements and its predefined type."""

    element: str
    """Its type's class has Type behind it."""
    predefined: str = "NOTDEFINED"


_OTHER = IfcClass("IfcFurniture")

_CLASSES: Mapping[IfcClass, tuple[str, ...]] = {
    IfcClass("IfcFurniture", "BED"): ("bed",),
    IfcClass("IfcFurniture", "CHAIR"): ("chair", "leisure_sofa"),
    IfcClass("IfcFurniture", "SOFA"): ("sofa", "single_sofa"),
    IfcClass("IfcFurniture", "TABLE"): (
        "table", "coffee_table", "side_coffee_table", "dining_table", "bedside_table",
    ),
    IfcClass("IfcFurniture", "SHELF"): ("wall_shelf",),
    IfcClass("IfcSanitaryTerminal", "BATH"): ("bathtub",),
    IfcClass("IfcSanitaryTerminal", "SHOWER"): ("shower",),
    IfcClass("IfcSanitaryTerminal", "TOILETPAN"): ("toilet",),
    IfcClass("IfcSanitaryTerminal", "WASHHANDBASIN"): ("washbasin",),
    IfcClass("IfcSanitaryTerminal", "SINK"): ("sink_cabinet",),
    IfcClass("IfcElectricAppliance", "REFRIGERATOR"): ("refrigerator",),
    IfcClass("IfcElectricAppliance", "ELECTRICCOOKER"): ("cooker_cabinet",),
    IfcClass("IfcElectricAppliance", "WASHINGMACHINE"): ("washing_machine", "washing_set"),
    IfcClass("IfcElectricAppliance"): ("electrical_floor_cabinet", "cooker_hood"),
    IfcClass("IfcLightFixture", "POINTSOURCE"): (
        "ceiling_lamp", "pendant_lamp", "floor_lamp", "wall_lamp",
    ),
    IfcClass("IfcSpaceHeater", "RADIATOR"): ("radiator",),
    IfcClass("IfcSwitchingDevice", "TOGGLESWITCH"): ("light_switch",),
    IfcClass("IfcOutlet", "POWEROUTLET"): ("socket",),
}  # fmt: skip

_BY_CATEGORY = {name: one for one, names in _CLASSES.items() for name in names}


def ifc_class(category: str) -> IfcClass:
    """The class of a category; furniture of no particular kind for all others."""
    return _BY_CATEGORY.get(category, _OTHER)
