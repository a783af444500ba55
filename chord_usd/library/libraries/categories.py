"""From a library's words to a category of the palette."""

from __future__ import annotations

import re
from difflib import SequenceMatcher

from chord_usd.base.scene.palette import CATEGORIES, HOUSE_CATEGORIES, TABLE_CATEGORIES

_WORDS: tuple[tuple[str, str], ...] = (
    ("bedside_table", r"night ?stands?|bedside"),
    ("bed_background", r"bed (panel|background|wall)|headboard"),
    ("sofa_background", r"sofa (panel|background)|wall (art|picture)s?|paintings?"),
    ("tv_cabinet", r"tv (stand|cabinet|unit|bench|furniture)|television (stand|cabinet)|media"),
    ("shoe_cabinet", r"shoes?"),
    ("side_coffee_table", r"(side|end|corner|accent|occasional)\W+table|corner/side"),
    ("coffee_table", r"coffee table|tea table|low table"),
    ("dining_table", r"dining table|kitchen table|table.*(dining|dinner)|round table"),
    ("dining_cabinet", r"sideboard|buffet|dresser|wine cabinet|console|china cabinet|vitrine"),
    ("table", r"desk|dressing table|workbench|writing table|vanity table"),
    ("refrigerator", r"fridge|refrigerator|freezer"),
    ("cooker_cabinet", r"cooker|stove|oven|hob|range|cook ?top"),
    ("sink_cabinet", r"kitchen sink|sink cabinet|sink unit"),
    ("washing_machine", r"washing machine|washer|dryer|laundry machine"),
    ("washbasin", r"wash ?basin|wash ?stand|bathroom sink|basin|lavatory|vanity|^sink"),
    ("toilet", r"toilet|\bwc\b|bidet"),
    ("bathtub", r"bath ?tub|\bbath\b"),
    ("shower", r"shower"),
    ("single_sofa", r"arm ?chair|single[- ]sofa|club chair|wing chair"),
    ("leisure_sofa", r"lounge|lazy sofa|pouf|ottoman|bean ?bag|rocking|recliner|foot ?stool"),
    ("sofa", r"sofa|couch|settee|loveseat|futon"),
    ("bed", r"\bbeds?\b|crib|cradle|bunk"),
    ("chair", r"chair|stool|seat"),
    ("double_door_floor_cabinet", r"kitchen cabinet|base cabinet|floor cabinet"),
    ("cabinet", r"wardrobe|closet|bookcase|book ?shel|shelf|shelves|shelving|chest|cabinet|"
                r"drawers?|cupboard|armoire|commode|locker|storage"),
    ("laptop", r"laptop|notebook computer"),
    ("all_in_one_computer", r"computer|monitor|\bimac\b|\bpc\b"),
    ("table_lamp", r"table lamp|desk lamp|bedside lamp|\blamp\b"),
    ("standing_book", r"row of books|books"),
    ("lying_book", r"\bbook\b"),
    ("magazine", r"magazine|newspaper"),
    ("big_plant", r"(big|large|tall) plant|palm|ficus"),
    ("small_plant", r"plant|cactus|flower|succulent|bonsai"),
    ("photo_frame", r"photo|picture frame|frame"),
    ("coffee_cup", r"cups?|mug|tea ?cup"),
    ("drinks", r"bottle|wine|glass(es)?|carafe|drink"),
    ("food", r"fruit|bread|food|cake|pizza|apple"),
    ("dinner_set", r"plates?|dinner set|cutlery|dishes"),
    ("electronic", r"phone|speaker|clock|radio|camera|tablet"),
    ("small_ornament", r"vase|statue|sculpture|ornament|candle|figurine|bowl"),
    ("table", r"table"),
)  # fmt: skip
"""Tried in this order: the more special words stand first."""

_LEAST_LIKENESS = 0.72


def known_category(*words: str) -> str | None:
    """The category that the first of these texts names, in our words or in everyday ones."""
    for text in words:
        plain = _plain(text)
        if plain.replace(" ", "_") in _NAMES:
            return plain.replace(" ", "_")
        for name, pattern in _WORDS:
            if re.search(pattern, plain):
                return name
    return None


def nearest_category(text: str) -> str | None:
    """The category whose name is spelled most alike; None where none is much alike."""
    plain = _plain(text)
    likeness = {
        name: SequenceMatcher(None, plain, CATEGORIES[name].label.lower()).ratio()
        for name in _NAMES
    }
    best = max(likeness, key=lambda name: likeness[name])
    return best if likeness[best] >= _LEAST_LIKENESS else None


def _plain(text: str) -> str:
    """Small letters, with single blanks between words."""
    return re.sub(r"[\s_]+", " ", text).strip().lower()


_NAMES = frozenset(row.name for row in (*HOUSE_CATEGORIES, *TABLE_CATEGORIES))
