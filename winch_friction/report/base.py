"""A report is a list of sections on one page: one self-contained HTML file that needs no network."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Protocol

from winch_friction import __version__
from winch_friction.records.atomic import write_text
from winch_friction.report.decision import provenance_html
from winch_friction.report.plots import has_plots, plot_scripts

_TEMPLATES = Path(__file__).parent / "templates"


class Section(Protocol):
    """One section of a report: a title and ready HTML. It shows results; it does not compute them."""

    @property
    def title(self) -> str:
        """Heading, plain text."""

    def html(self) -> str:
        """The section's content, as HTML."""


@dataclass(frozen=True)
class TextSection:
    """A section whose HTML is at hand."""

    title: str
    content: str

    def html(self) -> str:
        """The content as it stands."""
        return self.content


def write_report(
    path: Path | str,
    title: str,
    sections: Sequence[Section],
    subtitle: str = "",
    provenance: Mapping[str, Any] | None = None,
) -> Path:
    """Write the page atomically and return its path; where it comes from, if that is given, stands last."""
    last = [TextSection("Provenance", provenance_html(provenance))] if provenance else []
    return write_text(Path(path), render(title, [*sections, *last], subtitle))


def render(title: str, sections: Sequence[Section], subtitle: str = "") -> str:
    """The page as text; titles are escaped, the sections' HTML is taken as it is."""
    from jinja2 import Environment, FileSystemLoader
    from markupsafe import Markup

    bodies = [each.html() for each in sections]
    environment = Environment(loader=FileSystemLoader(_TEMPLATES), autoescape=True, trim_blocks=True)
    return environment.get_template("page.html.j2").render(
        title=title,
        subtitle=subtitle,
        sections=[{"title": each.title, "body": Markup(body)} for each, body in zip(sections, bodies, strict=True)],
        scripts=Markup(plot_scripts() if any(map(has_plots, bodies)) else ""),
        style=Markup((_TEMPLATES / "style.css").read_text(encoding="utf-8")),
        version=__version__,
        written=datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
    )
