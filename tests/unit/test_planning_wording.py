"""Texts and the wishes that are read in them."""

import numpy as np
import pytest

from chord_usd.base.errors import ChordError
from chord_usd.base.scene.wish import Wish
from chord_usd.line.layout.config import FLOOR
from chord_usd.line.planning.wording import read_wish
from chord_usd.line.planning.words import (
    PROGRAMME_CHANNELS,
    PROGRAMME_ROWS,
    TEXT_CHANNELS,
    TEXT_ROWS,
    WORDS,
    condition_words,
)
from chord_usd.workshop.data.descriptions import describe
from chord_usd.workshop.data.houses import random_plan
from tests.every import for_every

READ = {
    "This is a 40-square-meter flat with 0 living rooms, 1 bedroom, 0 kitchens, and 1 bathroom.": (
        {"living": 0, "bedroom": 1, "kitchen": 0, "bathroom": 1}, 40.0, False,
    ),
    "two-bed flat with an open kitchen, about 70 m²": ({"bedroom": 2, "kitchen": 1}, 70.0, True),
    "2 bed 2 bath, no balcony": ({"bedroom": 2, "bathroom": 2, "balcony": 0}, None, False),
    "a house for a family of four with three bedrooms and a home office": (
        {"bedroom": 3, "study": 1}, None, False,
    ),
    "no dining room or balcony, one bedroom": (
        {"dining": 0, "balcony": 0, "bedroom": 1}, None, False,
    ),
    "1,200 sq ft three-bedroom house with two baths, a den and a walk-in closet": (
        {"bedroom": 3, "bathroom": 2, "study": 1, "store": 1}, 111.5, False,
    ),
    "seventy-five square metres, one bedroom": ({"bedroom": 1}, 75.0, False),
    "studio, 30 sqm": ({"living": 1, "bedroom": 0}, 30.0, False),
    "3-Zimmer-Wohnung mit Küche, Bad und Balkon, 75 qm": (
        {"living": 1, "bedroom": 2, "kitchen": 1, "bathroom": 1, "balcony": 1}, 75.0, False,
    ),
    "appartement avec deux chambres, une cuisine ouverte et une salle de bain, 60 m²": (
        {"bedroom": 2, "kitchen": 1, "bathroom": 1}, 60.0, True,
    ),
    "piso con 3 dormitorios, cocina, 2 baños y salón de 90 metros cuadrados": (
        {"bedroom": 3, "kitchen": 1, "bathroom": 2, "living": 1}, 90.0, False,
    ),
    "apartamento com 2 quartos, sala, cozinha e banheiro": (
        {"bedroom": 2, "living": 1, "kitchen": 1, "bathroom": 1}, None, False,
    ),
    "lägenhet med två sovrum, kök och badrum, 65 kvm": (
        {"bedroom": 2, "kitchen": 1, "bathroom": 1}, 65.0, False,
    ),
    "kaksi makuuhuonetta, keittiö ja kylpyhuone": (
        {"bedroom": 2, "kitchen": 1, "bathroom": 1}, None, False,
    ),
    "三室两厅一卫 90平米": ({"bedroom": 3, "living": 2, "bathroom": 1}, 90.0, False),
    "2LDK 60㎡": ({"bedroom": 2, "living": 1, "kitchen": 1}, 60.0, False),
}  # fmt: skip


@pytest.mark.parametrize("text", READ)
def test_texts_in_nine_languages_are_read(text: str) -> None:
    counts, area_m2, open_kitchen = READ[text]
    wish = read_wish(text).wish
    assert dict(wish.counts) == counts
    assert wish.area_m2 == (area_m2 if area_m2 is None else pytest.approx(area_m2, abs=0.1))
    assert wish.open_kitchen == open_kitchen


REFUSED = {
    "": "is empty",
    "   \n": "is empty",
    "hello world": "names no rooms",
    "квартира с двумя спальнями": "names no rooms",
    "a flat": "names no rooms",
    "a bedroom " * 1000: "has 10000 characters",
    "0 rooms, 500 bedrooms in 20 m²": "500 bedrooms and 20 m²",
    "2 rooms, three of them bedrooms, 3 bedrooms": "contradicts itself",
    "40 bedrooms": "more rooms than can be planned",
    "one bedroom, 5000 m²": "cannot be planned",
    "eight bedrooms and four bathrooms in 50 sqm": "at least 56 m²",
}


@pytest.mark.parametrize("text", REFUSED)
def test_what_cannot_be_built_is_refused_with_what_was_understood(text: str) -> None:
    with pytest.raises(ChordError) as caught:
        read_wish(text)
    assert REFUSED[text] in str(caught.value)
    assert "\n" not in str(caught.value)


@for_every("seed", range(60))
def test_descriptions_mean_what_they_stand_for(seed: int) -> None:
    """What the model learns to hear is what the reader reads."""
    said = describe(random_plan(np.random.default_rng(seed)), np.random.default_rng(seed + 7))
    found = read_wish(said.text)
    assert dict(found.wish.counts) == dict(said.wish.counts), said.text
    assert found.wish.open_kitchen == said.wish.open_kitchen
    assert found.english
    assert found.wish.area_m2 == pytest.approx(said.wish.area_m2) if said.wish.area_m2 else True


def test_a_wish_reads_back_from_its_own_sentence() -> None:
    wish = Wish({"living": 1, "bedroom": 3, "study": 2, "store": 0}, 104.0, open_kitchen=False)
    assert read_wish(wish.sentence).wish == wish


def test_words_tell_numbers_apart_and_leave_the_unsaid_blank() -> None:
    two, three = (condition_words(Wish({"bedroom": n}, 70.0)) for n in (2, 3))
    assert two.shape == (WORDS, TEXT_CHANNELS + PROGRAMME_CHANNELS)
    assert not np.array_equal(two, three)
    assert not two[PROGRAMME_ROWS:].any()
    unsaid = condition_words(Wish())
    assert np.array_equal(unsaid[0], condition_words(Wish({"bedroom": 2}))[0])
    long_text = np.ones((TEXT_ROWS + 9, TEXT_CHANNELS), np.float32)
    assert condition_words(Wish(), long_text)[PROGRAMME_ROWS:, :TEXT_CHANNELS].all()


def test_the_network_is_made_for_these_words() -> None:
    assert (FLOOR.words, FLOOR.word_channels) == (WORDS, TEXT_CHANNELS + PROGRAMME_CHANNELS)
