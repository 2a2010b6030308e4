"""Still pictures with one look, written as files, readable on light and on dark paper."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from winch_friction.records.atomic import atomic_path

# readable on white and on near-black, told apart by people who do not see red and green
COLOURS = ("#2f7fc1", "#d9782d", "#3c9a6b", "#b5528f", "#8c7ad1", "#a98a1f", "#5f9ea8", "#c25b56")
_INK = "#1a1b1e"


@contextmanager
def look() -> Iterator[None]:
    """Matplotlib settings of every picture of this package."""
    import matplotlib
    from cycler import cycler

    settings: Any = {
        "font.size": 10, "axes.titlesize": 10.5, "axes.labelsize": 10, "legend.fontsize": 9,
        "axes.prop_cycle": cycler(color=COLOURS), "lines.linewidth": 1.4, "axes.spines.top": False,
        "axes.spines.right": False, "axes.grid": True, "grid.alpha": 0.25, "legend.frameon": False,
        "svg.fonttype": "none", "svg.hashsalt": "winch_friction", "figure.dpi": 110, "axes.titlelocation": "left",
        **dict.fromkeys(("text.color", "axes.labelcolor", "axes.edgecolor", "xtick.color", "ytick.color"), _INK),
    }  # fmt: skip
    with matplotlib.rc_context(settings):
        yield


def new_figure(rows: int = 1, columns: int = 1, height: float = 2.8, width: float = 8.6, **options: Any) -> Any:
    """A figure and its axes, as from `plt.subplots`, without global state; `height` in inches per row."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with look():
        figure = Figure(figsize=(width, height * rows), layout="constrained")
        FigureCanvasAgg(figure)
        return figure, figure.subplots(rows, columns, **options)


def legend_above(axes: Any, columns: int = 1) -> None:
    """A legend that covers no curve."""
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns, frameon=False, borderaxespad=0.2)


def save_figure(figure: Any, path: Path | str, dpi: int = 130) -> Path:
    """Write a picture file atomically, in the format of its suffix, on white."""
    path = Path(path)
    with look(), atomic_path(path) as temporary:
        figure.savefig(temporary, dpi=dpi, facecolor="white", format=path.suffix.lstrip(".") or "png")
    return path
