"""Philox and what is made of its words."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest
from numba import njit

from ev_core.compiling.machine_code import register_functions
from ev_core.sensors.random_numbers import WORD, normals, philox, uniform

COUNT = 20_000
# Counter, key and result of philox4x32 with 10 rounds in the file kat_vectors of Random123, the
# authors' own library.
PUBLISHED = (
    ((0, 0, 0, 0), (0, 0), (0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8)),
    ((WORD, WORD, WORD, WORD), (WORD, WORD), (0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD)),
    (
        (0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344),
        (0xA4093822, 0x299F31D0),
        (0xD16CFE09, 0x94FDCCEB, 0x5001E420, 0x24126EA1),
    ),
)


@njit(error_model="numpy")
def many(counters: np.ndarray, words: np.ndarray, numbers: np.ndarray) -> None:
    for i in range(len(counters)):
        c0, c1, c2, c3, k0, k1 = counters[i]
        w0, w1, w2, w3 = philox(c0, c1, c2, c3, k0, k1)
        words[i, 0], words[i, 1], words[i, 2], words[i, 3] = w0, w1, w2, w3
        numbers[i, 0] = uniform(w0, w1)
        numbers[i, 1], numbers[i, 2] = normals(w0, w1, w2, w3)


def compiled(counters: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Words and numbers of rows of counter and key."""
    register_functions()
    words, numbers = np.empty((len(counters), 4), np.int64), np.empty((len(counters), 3))
    many(counters, words, numbers)
    return words, numbers


@pytest.mark.parametrize(("counter", "key", "words"), PUBLISHED)
def test_the_words_are_the_published_ones(counter, key, words):
    assert philox(*counter, *key) == words
    assert tuple(compiled(np.array([[*counter, *key]]))[0][0]) == words


def test_compiled_code_gives_the_same_bits():
    """All combinations of the smallest and largest words, and any others."""
    extreme = np.array(list(product((0, 1, 2**31 - 1, 2**31, WORD), repeat=6)))
    rows = np.vstack([extreme, np.random.default_rng(0).integers(0, 2**32, (COUNT // 10, 6))])
    words, numbers = compiled(rows)
    for row, got, made in zip(rows.tolist(), words.tolist(), numbers.tolist(), strict=True):
        expected = philox(*row)
        assert tuple(got) == expected
        assert made == [uniform(*expected[:2]), *normals(*expected)]


def test_uniform_numbers_are_below_one_and_have_53_bits():
    assert uniform(0, 0) == 0.0
    assert uniform(WORD, WORD) == 1.0 - 2.0**-53
    assert uniform(1 << 5, 0) == 2.0**-27
    assert uniform(0, 1 << 6) == 2.0**-53


def test_no_normal_number_is_infinite():
    """The largest radius belongs to the largest uniform number: sqrt(2 log(2^53)) = 8.57."""
    assert normals(WORD, WORD, 0, 0) == (
        pytest.approx(math.sqrt(2 * 53 * math.log(2)), rel=1e-15),
        0.0,
    )
    assert normals(0, 0, WORD, WORD) == (0.0, 0.0)


@pytest.mark.slow
def test_distributions():
    """Four standard errors.

    Both normal numbers of a block, their correlation, neighbours, and tails.
    """
    blocks = np.zeros((COUNT, 6), np.int64)
    blocks[:, 0] = np.arange(COUNT)
    _, numbers = compiled(blocks)
    u, pairs = numbers[:, 0], numbers[:, 1:]
    assert u.mean() == pytest.approx(0.5, abs=4 / math.sqrt(12 * COUNT))
    occupied, _ = np.histogram(u, 100, (0.0, 1.0))
    chi_square = ((occupied - COUNT / 100) ** 2).sum() / (COUNT / 100)  # 99 degrees of freedom
    assert chi_square == pytest.approx(99, abs=4 * math.sqrt(2 * 99))
    for n in pairs.T:
        assert abs(n.mean()) < 4 / math.sqrt(COUNT)
        assert n.std() == pytest.approx(1.0, abs=4 / math.sqrt(2 * COUNT))
        assert (n**4).mean() == pytest.approx(3.0, abs=4 * math.sqrt(96 / COUNT))
        assert abs((n[1:] * n[:-1]).mean()) < 4 / math.sqrt(COUNT)
        beyond = 0.0455  # share beyond two standard deviations
        assert (np.abs(n) > 2).mean() == pytest.approx(beyond, abs=4 * math.sqrt(beyond / COUNT))
    assert abs((pairs[:, 0] * pairs[:, 1]).mean()) < 4 / math.sqrt(COUNT)
    assert abs(np.corrcoef(pairs[:, 0] ** 2, pairs[:, 1] ** 2)[0, 1]) < 4 / math.sqrt(COUNT)
