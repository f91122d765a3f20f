"""The pictures of the README and of two pages, drawn small."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pictures import split_friction
from pictures.browser import FOUND
from pictures.writing import SIZE, save_pictures
from PIL import Image

ROOT = Path(__file__).parents[2]


def extent(strip: np.ndarray, colour: str) -> tuple[int, int]:
    """Width and height [px] of what has about this colour in a strip of the moving picture."""
    wanted = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)])
    rows, columns = np.nonzero(np.abs(strip.astype(int) - wanted).max(axis=-1) < 40)
    return int(np.ptp(columns)), int(np.ptp(rows))


def test_the_car_without_a_law_turns_across_the_road_and_the_other_one_does_not(tmp_path: Path):
    """Before the brakes both cars lie along the road.

    Two seconds after them one is turned by about 100 degrees.
    """
    split_friction.save_moving_picture(tmp_path, (split_friction.BEGIN, 3.0))
    with Image.open(tmp_path / split_friction.NAME) as picture:
        assert (picture.size, picture.n_frames) == (split_friction.SIZE, 2)
        frames = []
        for number in range(2):
            picture.seek(number)
            frames.append(np.array(picture.convert("RGB")))
    half = split_friction.SIZE[1] // 2
    before, after = (
        [
            extent(strip, colour)
            for strip, colour in zip(
                (frame[:half], frame[half:]), split_friction.BODIES, strict=True
            )
        ]
        for frame in frames
    )
    # 6 degrees with the law
    assert all(width > 1.8 * height for width, height in (*before, after[1]))
    assert after[0][1] > 1.5 * after[0][0]


def test_the_readme_has_the_picture_and_its_braking_distances():
    text = (ROOT / "README.md").read_text()
    file = ROOT / "docs" / "images" / split_friction.NAME
    assert f"](docs/images/{split_friction.NAME})" in text
    assert file.stat().st_size < 1_500_000
    with Image.open(file) as picture:
        assert picture.size == split_friction.SIZE and picture.n_frames > 100
    without, with_law = (f"{each.way:.0f} m" for each in split_friction.drive())
    assert f"stands after {without}" in text and f"stands after {with_law}" in text


@pytest.mark.slow
@pytest.mark.skipif(FOUND is None, reason="no Chromium on this machine")
@pytest.mark.weekly
def test_both_pages_are_photographed_with_something_on_them(tmp_path: Path):
    """An empty page, or one without plots, has fewer colours."""
    save_pictures(tmp_path)
    for name, size in SIZE.items():
        picture = Image.open(tmp_path / f"{name}.png")
        assert picture.size == size
        assert len(picture.convert("RGB").getcolors(1 << 16)) > 100
