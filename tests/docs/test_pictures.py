"""The pictures of the README, made anew in little."""

from __future__ import annotations

from pathlib import Path

import pytest
from pictures.browser import FOUND
from pictures.writing import SIZE, save_pictures
from PIL import Image

pytestmark = [pytest.mark.slow, pytest.mark.skipif(FOUND is None, reason="no Chromium on this machine")]


@pytest.mark.weekly
def test_both_pages_are_photographed_with_something_on_them(tmp_path: Path):
    """An empty page, or one without plots, has fewer colours."""
    save_pictures(tmp_path)
    for name, size in SIZE.items():
        picture = Image.open(tmp_path / f"{name}.png")
        assert picture.size == size
        assert len(picture.convert("RGB").getcolors(1 << 16)) > 100
