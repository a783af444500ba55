"""Category code words keep their distance."""

import itertools

import numpy as np
import pytest

from chord_usd.line.layout.draft import CLASS_COUNT, CODE_BITS, codebook


def test_any_two_words_differ_in_half_their_bits_or_more():
    words = codebook()
    assert words.shape == (CLASS_COUNT, CODE_BITS)
    for one, other in itertools.combinations(words, 2):
        assert np.count_nonzero(one != other) in (CODE_BITS // 2, CODE_BITS)


def test_more_words_than_the_code_has_are_refused():
    assert len(codebook(2 * CODE_BITS)) == 2 * CODE_BITS
    with pytest.raises(ValueError, match="33 asked for"):
        codebook(2 * CODE_BITS + 1)
