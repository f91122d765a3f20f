"""The table of docs/zhileykin2018.md on neutral steer says what linear model and plant say."""

from pathlib import Path

from documentation.neutral_steer import neutral_steer_table

PAGE = (Path(__file__).parents[3] / "docs" / "zhileykin2018.md").read_text()


def test_neutral_steer_table_is_that_of_the_models():
    assert neutral_steer_table().strip() in PAGE
