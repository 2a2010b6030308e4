"""The documentation site: `make docs`. Reference pages are generated from the code, tutorials are executed."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from generate import write_reference

from winch_friction import __version__

project, author, release = "winch_friction", "The winch_friction developers", __version__
extensions = ["myst_nb", "sphinx.ext.autodoc"]
html_theme, html_title = "furo", "winch_friction"
exclude_patterns = ["_build", "images"]
html_theme_options = {"source_edit_link": ""}
myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 3
nb_execution_mode, nb_execution_timeout, nb_execution_raise_on_error = "force", 120, True
nb_merge_streams = True
autodoc_typehints, autodoc_member_order = "signature", "bysource"
templates_path: list[str] = []
html_show_sourcelink = False
# MathJax would be fetched from a network: formulas are set by the browser from MathML instead
html_math_renderer = "mathml"
suppress_warnings = ["misc.highlighting_failure"]


def setup(app):  # type: ignore[no-untyped-def]
    """Generate the reference before Sphinx reads, and set formulas as MathML."""
    write_reference(Path(__file__).parent / "reference")
    app.add_html_math_renderer("mathml", inline_renderers=(_inline, None), block_renderers=(_block, None))
    app.connect("autodoc-process-docstring", _absolute_values)
    return {"parallel_read_safe": True}


def _absolute_values(app, what, name, obj, options, lines):  # type: ignore[no-untyped-def]
    """|x| in a docstring is an absolute value, not a substitution."""
    lines[:] = [line.replace("|", r"\|") for line in lines]


def _inline(writer, node):  # type: ignore[no-untyped-def]
    _set(writer, node, "inline")


def _block(writer, node):  # type: ignore[no-untyped-def]
    _set(writer, node, "block")


def _set(writer, node, display):  # type: ignore[no-untyped-def]
    from docutils import nodes
    from latex2mathml.converter import convert

    writer.body.append(convert(node.astext(), display=display))
    raise nodes.SkipNode
