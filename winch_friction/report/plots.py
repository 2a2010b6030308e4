"""Interactive pictures: what is to be drawn as plain data, which the page draws with plotly, themes and exports as CSV.

A `Plot` holds frames (columns with their unit in the label) and the lines drawn from them; the same numbers are what a
reader downloads. The page's one script draws plots when they come into view, in the colours of light, dark or paper.
"""

import base64
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import FloatArray
from winch_friction.report.packed import packed

MOST_POINTS = 1500  # per line on a page; a screen has no more columns, and a dozen runs stay below a megabyte
ROLES = ("measured", "before", "after", "noise", "truth", "plain", "other")
KINDS = ("lines", "dots", "bars", "band", "area")
_TEMPLATES = Path(__file__).parent / "templates"


@dataclass(frozen=True)
class Frame:
    """Equally long columns; the key is the label with its unit, `motor speed [rpm]`."""

    name: str
    columns: Mapping[str, FloatArray | Sequence[float] | Sequence[str]]


@dataclass(frozen=True)
class Line:
    """One line (or dots, bars, band) of a plot: which columns of which frame, in which panel.

    `role` fixes its look wherever it appears: measured, before, after, noise, truth; `plain` takes the next colour,
    `other` is faint. A band takes `y` as its lower and `upper` as its upper edge.
    """

    label: str
    x: str
    y: str
    frame: int = 0
    row: int = 0
    role: str = "plain"
    kind: str = "lines"
    upper: str = ""
    like: int = -1  # the number of the plain line whose colour it takes; -1: its own


@dataclass(frozen=True)
class Heat:
    """A map of mean values over two signals: `values` (len(y), len(x)), NaN where there are no data; one per panel."""

    x: FloatArray
    y: FloatArray
    values: FloatArray
    title: str
    x_label: str
    y_label: str
    unit: str


@dataclass(frozen=True)
class Plot:
    """A figure: `rows` are the y labels of its panels, `link` names plots that zoom together along x."""

    title: str
    frames: Sequence[Frame]
    lines: Sequence[Line]
    x: str
    rows: Sequence[str]
    caption: str = ""
    link: str = ""
    heats: Sequence[Heat] = ()
    names: Mapping[str, str] = field(default_factory=dict)
    height: int = 210  # pixels per panel

    def __post_init__(self) -> None:
        for line in self.lines:
            missing = {line.x, line.y, *([line.upper] if line.upper else [])} - set(self.frames[line.frame].columns)
            if missing or line.role not in ROLES or line.kind not in KINDS or line.row >= len(self.rows):
                raise InputError(
                    f"plot '{self.title}': line '{line.label}' asks for what is not there: {missing or line}"
                )


def plot_html(plot: Plot, *, most_points: int = MOST_POINTS) -> str:
    """The figure with its data, its caption and the CSV of exactly what is drawn."""
    content = json.dumps(_content(plot, most_points), separators=(",", ":"), allow_nan=False).replace("</", "<\\/")
    tall = plot.height * max(len(plot.rows), 1) + 90 if not plot.heats else plot.height + 150
    caption = f"<figcaption>{escape(plot.caption or plot.title)}</figcaption>"
    head = escape("data:text/csv;charset=utf-8," + _csv_head(plot), quote=True)
    file = f"{re.sub(r'[^a-z0-9]+', '_', plot.title.lower()).strip('_')}.csv"
    return (
        f'<figure class="plot" aria-label="{escape(plot.title, quote=True)}">'
        f'<div class="canvas" style="height:{tall}px"></div>'
        f"{caption}"
        f'<p class="tools"><a class="csv" download="{escape(file)}" href="{head}">Data as CSV</a></p>'
        f'<script type="application/json">{content}</script></figure>'
    )


def has_plots(html: str) -> bool:
    """Whether a page needs the plotting script."""
    return '<figure class="plot"' in html


def plot_scripts() -> str:
    """The page's scripts, once: plotly (packed, so that a page stays small) and what draws the figures."""
    drawing = (_TEMPLATES / "plots.js").read_text(encoding="utf-8")
    return f'<script type="text/plain" id="plotly">{packed_plotly()}</script>\n<script>\n{drawing}\n</script>'


@lru_cache(maxsize=1)
def packed_plotly() -> str:
    """plotly's script, gzipped and in base64."""
    try:
        import plotly
    except ModuleNotFoundError as error:
        raise InputError("reports need the library 'plotly': pip install 'winch_friction[desk]'") from error
    source = (Path(plotly.__file__).parent / "package_data" / "plotly.min.js").read_bytes()
    return packed(source)


def plotly_figure(plot: Plot) -> Any:
    """The same figure as a plotly `Figure`, for a notebook."""
    import plotly.graph_objects as go
    from plotly.subplots import make_subplots

    figure = make_subplots(rows=max(len(plot.rows), 1), cols=1, shared_xaxes=True, vertical_spacing=0.06)
    dashes = {"before": "dash", "noise": "dot"}
    for line in plot.lines:
        columns = plot.frames[line.frame].columns
        style = {"mode": "markers"} if line.kind == "dots" else {"mode": "lines"}
        trace = go.Scatter(x=columns[line.x], y=columns[line.y], name=line.label, **style)
        trace.line.dash = dashes.get(line.role, "solid")
        figure.add_trace(trace, row=line.row + 1, col=1)
    for k, label in enumerate(plot.rows):
        figure.update_yaxes(title_text=label, row=k + 1, col=1)
    figure.update_xaxes(title_text=plot.x, row=max(len(plot.rows), 1), col=1)
    return figure.update_layout(title=plot.title, height=120 + plot.height * max(len(plot.rows), 1))


def _content(plot: Plot, most_points: int) -> dict[str, Any]:
    return {
        "title": plot.title, "x": plot.x, "rows": list(plot.rows), "link": plot.link,
        "frames": [_frame(frame, most_points) for frame in plot.frames],
        "lines": [[e.label, e.x, e.y, e.frame, e.row, e.role, e.kind, e.upper, e.like] for e in plot.lines],
        "heats": [
            {"x": _packed(h.x), "y": _packed(h.y), "z": [_packed(row) for row in np.asarray(h.values, float)],
             "title": h.title, "xl": h.x_label, "yl": h.y_label, "unit": h.unit} for h in plot.heats
        ],
    }  # fmt: skip


def _frame(frame: Frame, most_points: int) -> dict[str, Any]:
    """The columns, every k-th sample where there are more than a screen can show; the ends stay."""
    length = max((len(values) for values in frame.columns.values()), default=0)
    step = max(1, -(-length // most_points))
    thin = {label: values if step == 1 else _thinned(values, step) for label, values in frame.columns.items()}
    return {"name": frame.name, "columns": {label: _packed(values) for label, values in thin.items()}}


def _thinned(values: Any, step: int) -> Any:
    return list(values)[::step] if isinstance(values[0], str) else np.asarray(values, float)[::step]


def _packed(values: Any) -> Any:
    """Numbers as base64 of 32-bit floats, words as a list."""
    if len(values) and isinstance(values[0], str):
        return list(values)
    return base64.b64encode(np.asarray(values, "<f4").tobytes()).decode()


def _csv_head(plot: Plot) -> str:
    labels = dict.fromkeys(label for frame in plot.frames for label in frame.columns)
    return ",".join(label.replace(",", " ").replace("%", "percent") for label in labels) + "%0A"
