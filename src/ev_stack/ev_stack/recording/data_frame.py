"""Tables of pandas, which is an extra of the package."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pandas import DataFrame


def data_frame(columns: Mapping[str, Any], units: Mapping[str, str], index: str = "") -> DataFrame:
    """Columns by name, of which one may be the index; `attrs["units"]` has their units by name.

    ImportError with how to get pandas.
    """
    try:
        from pandas import DataFrame, Index
    except ImportError as error:
        raise ImportError(
            f"a data frame needs pandas ({error}): pip install 'ev_stack[frame]'"
        ) from None
    others = {name: each for name, each in columns.items() if name != index}
    found = DataFrame(others, index=Index(columns[index], name=index) if index else None)
    found.attrs["units"] = dict(units)
    return found
