"""What our labels are called in the label sets that others train with, and in Wikidata.

Names and ids are the published ones: of COCO's 80 things (1 to 90, with gaps; Lin et al. 2014),
of ADE20K's 150 classes as `objectInfo150` of its scene parsing benchmark counts them (1 to 150;
Zhou et al. 2017), of the 40 classes of NYU Depth v2 as `classMapping40` has and spells them (1 to
40; Gupta et al. 2013). In all of them 0 is nothing.
"""

from __future__ import annotations

from functools import cache

from chord_usd.base.scene.category_rows import category_rows

OWN = "chord"
"""Our own labels."""

# In the order of their ids, from 1; blanks are "_", "-" is an id that was never given.
_COCO = """
person bicycle car motorcycle airplane bus train truck boat traffic_light fire_hydrant - stop_sign
parking_meter bench bird cat dog horse sheep cow elephant bear zebra giraffe - backpack umbrella - -
handbag tie suitcase frisbee skis snowboard sports_ball kite baseball_bat baseball_glove skateboard
surfboard tennis_racket bottle - wine_glass cup fork knife spoon bowl banana apple sandwich orange
broccoli carrot hot_dog pizza donut cake chair couch potted_plant bed - dining_table - - toilet -
tv laptop mouse remote keyboard cell_phone microwave oven toaster sink refrigerator - book clock
vase scissors teddy_bear hair_drier toothbrush
"""
_ADE20K = """
wall building sky floor tree ceiling road bed windowpane grass cabinet sidewalk person earth door
table mountain plant curtain chair car water painting sofa shelf house sea mirror rug field armchair
seat fence desk rock wardrobe lamp bathtub railing cushion base box column signboard
chest_of_drawers counter sand sink skyscraper fireplace refrigerator grandstand path stairs runway
case pool_table pillow screen_door stairway river bridge bookcase blind coffee_table toilet flower
book hill bench countertop stove palm kitchen_island computer swivel_chair boat bar arcade_machine
hovel bus towel light truck tower chandelier awning streetlight booth television_receiver airplane
dirt_track apparel pole land bannister escalator ottoman bottle buffet poster stage van ship
fountain conveyer_belt canopy washer plaything swimming_pool stool barrel basket waterfall tent bag
minibike cradle oven ball food step tank trade_name microwave pot animal bicycle lake dishwasher
screen blanket sculpture hood sconce vase traffic_light tray ashcan fan pier crt_screen plate
monitor bulletin_board shower radiator glass clock flag
"""
_NYU40 = """
wall floor cabinet bed chair sofa table door window bookshelf picture counter blinds desk shelves
curtain dresser pillow mirror floor_mat clothes ceiling books refridgerator television paper towel
shower_curtain box whiteboard person night_stand toilet sink lamp bathtub bag otherstructure
otherfurniture otherprop
"""
_CLASSES = {"coco": _COCO, "ade20k": _ADE20K, "nyu40": _NYU40}

LABEL_SETS = (OWN, *_CLASSES)

_ELSE = {"nyu40": "otherprop"}
"""What a set calls everything that it has no name for; without one that is left out."""


@cache
def classes_of(label_set: str) -> dict[str, int]:
    """Id of each class of one of LABEL_SETS but OWN, by name, in the order of ids."""
    names = _CLASSES[label_set].split()
    return {
        name.replace("_", " "): number for number, name in enumerate(names, start=1) if name != "-"
    }


def wikidata_item(label: str) -> str:
    """The Wikidata item (Q and a number) of a label of this package. Raises KeyError for others."""
    return category_rows()[label]["wikidata"]


def class_of(label: str, label_set: str) -> str | None:
    """The class of this label in a set; None where the set has nothing of the kind.

    Labels of others, such as of a stage that somebody else made, stand for themselves
    where the set has them.
    """
    row = category_rows().get(label)
    if row is not None:
        return None if row[label_set] == "-" else row[label_set]
    spaced = label.replace("_", " ")
    return spaced if spaced in classes_of(label_set) else _ELSE.get(label_set)
