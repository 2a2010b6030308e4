"""The dashboard's page: live plots and tables, everything in one document, so that it works without a network."""

import json
from pathlib import Path

from winch_friction.records.telemetry import SIGNALS
from winch_friction.report.base import TextSection, render
from winch_friction.report.plots import packed_plotly

_TEMPLATES = Path(__file__).parent / "templates"
_PANELS = (
    ("torque", "Friction torque", "What is fed forward, what the learned model says, the truth where it is simulated."),
    ("loop", "Torque over speed", "The friction loop of the last two minutes."),
    ("speed", "Speed", "Measured and commanded motor speed."),
    ("error", "Tracking error", "Position error of the load, where it is known (simulation)."),
)  # fmt: skip


def dashboard_page() -> str:
    """The page as text; it listens to `events` beside it."""
    figures = "".join(
        f'<figure hidden aria-label="{title}"><h3>{title}</h3>'
        f'<div class="canvas" id="{name}" style="height:260px"></div>'
        f"<figcaption>{about}</figcaption></figure>"
        for name, title, about in _PANELS
    )
    link = '<p><span id="link" role="status">connecting</span> · <span id="time">no samples yet</span></p>'
    link += '<p id="faults" class="good">nothing heard yet</p>'
    sections = [
        TextSection("State", link + _table("state", ("part", "says"))),
        TextSection("Signals", figures),
        TextSection("Estimates", _table("estimates", ("parameter, SI", "value", "± 1 σ", "status"))),
        TextSection("Inputs", _table("inputs", ("input", "rate [Hz]", "age [s]"))),
    ]
    script = (_TEMPLATES / "dashboard.js").read_text(encoding="utf-8")
    scripts = (
        f'<script type="text/plain" id="plotly">{packed_plotly()}</script>\n'
        f'<script type="application/json" id="signals">{json.dumps(SIGNALS)}</script>\n<script>\n{script}\n</script>'
    )
    return render("Winch friction, live", sections).replace("</body>", f"{scripts}\n</body>")


def _table(name: str, columns: tuple[str, ...]) -> str:
    head = "".join(f'<th scope="col">{column}</th>' for column in columns)
    return (
        f'<div class="scroll" tabindex="0" role="group" aria-label="{name}"><table><thead><tr>{head}</tr></thead>'
        f'<tbody id="{name}"></tbody></table></div>'
    )
