"""How a notebook shows a result: its metrics as a table, and its figures."""

from __future__ import annotations

import base64
import io
from collections.abc import Mapping
from html import escape

from ev_sim.report.figures.figure import DPI, Figure
from ev_sim.report.metric import Metric
from ev_sim.report.metric_table import metric_table


def html_of(metrics: Mapping[str, Metric], figures: Mapping[str, Figure], signal_hash: str) -> str:
    """A piece of HTML that needs nothing else."""
    table = f"<pre>{escape(metric_table(metrics))}\nsignal hash {signal_hash}</pre>"
    return table + "".join(_image(name, figure) for name, figure in figures.items())


def _image(name: str, figure: Figure) -> str:
    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=DPI)
    text = base64.b64encode(file.getvalue()).decode()
    return f'<img alt="{escape(name)}" src="data:image/png;base64,{text}">'
