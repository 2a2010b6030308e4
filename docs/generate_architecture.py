"""The architecture picture, from the import graph: a box per package in its layer, a line per direct import.

python docs/generate_architecture.py     # writes docs/images/architecture.svg; a test holds it current
"""

import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TARGET = ROOT / "docs" / "images" / "architecture.svg"
WIDTH, ROW, BOX, HIGH = 1000, 96, 150, 44  # px
# what each package answers, in a few words
SAYS = {
    "nodes": "ROS 2 nodes", "cli": "verbs", "api": "import winch_friction", "report": "pages and pictures",
    "fleet": "many cranes", "importing": "foreign logs", "replay": "a recording again", "discrepancy": "what lacks",
    "commissioning": "can this be so?", "online": "inputs, time, models", "compensation": "feedforward",
    "identification": "fits", "simulation": "plant, sea, sensors", "estimation": "Kalman filter",
    "records": "files and messages", "physics": "terms, crane, units",
}  # fmt: skip


def layers() -> list[list[str]]:
    """The layers from the top, as import-linter enforces them."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    rows = next(each["layers"] for each in contracts if each["name"] == "Imports go down only")
    return [[name.strip() for name in row.split("|")] for row in rows]


def imports() -> dict[tuple[str, str], int]:
    """(importer, imported) -> number of direct imports between the packages."""
    import grimp

    graph = grimp.build_graph("winch_friction", include_external_packages=False, cache_dir=None)
    known = {name for row in layers() for name in row}
    found: dict[tuple[str, str], int] = {}
    for module in graph.modules:
        own = _package(module)
        for other in graph.find_modules_directly_imported_by(module):
            pair = (own, _package(other))
            if pair[0] != pair[1] and set(pair) <= known:
                found[pair] = found.get(pair, 0) + 1
    return found


def _package(module: str) -> str:
    return (module.split(".") + [""])[1]


def picture() -> str:
    """The SVG."""
    rows, edges = layers(), imports()
    place = {
        name: (WIDTH * (k + 1) / (len(row) + 1), 40 + ROW * level)
        for level, row in enumerate(rows)
        for k, name in enumerate(row)
    }
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {ROW * len(rows) + 20}" role="img" '
        'aria-label="Packages in layers; imports go down only" font-family="sans-serif">',
        f'<rect width="{WIDTH}" height="{ROW * len(rows) + 20}" fill="#ffffff"/>',
    ]
    for importer, imported in sorted(edges):
        (x1, y1), (x2, y2) = place[importer], place[imported]
        parts.append(
            f'<line x1="{x1:.0f}" y1="{y1 + HIGH / 2:.0f}" x2="{x2:.0f}" y2="{y2 - HIGH / 2:.0f}" stroke="#7a8794" '
            'stroke-width="1" stroke-opacity="0.55"/>'
        )
    for name, (x, y) in place.items():
        parts += [
            f'<rect x="{x - BOX / 2:.0f}" y="{y - HIGH / 2:.0f}" width="{BOX}" height="{HIGH}" rx="6" fill="#eef4fa" '
            'stroke="#2f5f8f"/>',
            f'<text x="{x:.0f}" y="{y - 3:.0f}" text-anchor="middle" font-size="15" font-weight="bold" '
            f'fill="#12304d">{name}</text>',
            f'<text x="{x:.0f}" y="{y + 14:.0f}" text-anchor="middle" font-size="12" '
            f'fill="#3b4a58">{SAYS[name]}</text>',
        ]
    return "\n".join([*parts, "</svg>", ""])


if __name__ == "__main__":
    TARGET.write_text(picture(), encoding="utf-8")
