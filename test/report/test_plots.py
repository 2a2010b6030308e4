"""Plots as data, equations as MathML, effects in words."""

import base64
import json
import re
from pathlib import Path

import numpy as np
import pytest

from winch_friction.discrepancy.catalogue import all_candidates
from winch_friction.physics.effects import effect_texts
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import registered_terms, term_named
from winch_friction.report import plots
from winch_friction.report.equations import latex_html, term_html
from winch_friction.report.plots import Frame, Heat, Line, Plot, plot_html, plotly_figure


def plot(points=10):
    frame = Frame("run </script>", {"time [s]": np.linspace(0, 1, points), "torque [N·m]": np.full(points, np.nan)})
    return Plot("A run", [frame], [Line("torque", "time [s]", "torque [N·m]")], "time [s]", ["torque [N·m]"])


def test_a_plot_carries_its_data_safely():
    html = plot_html(plot())
    content = json.loads(re.search(r'application/json">(.*)</script></figure>', html).group(1))
    assert content["frames"][0]["name"] == "run </script>"
    assert html.count("</script>") == 1
    assert "data:text/csv" in html


def test_long_runs_are_thinned():
    assert len(plot_html(plot(100_000))) < 30_000


def test_a_line_without_its_column_is_refused():
    with pytest.raises(InputError, match="asks for what is not there"):
        Plot("A", [Frame("a", {"t": np.zeros(1)})], [Line("x", "t", "missing")], "t", ["y"])


@pytest.mark.parametrize("name", sorted(registered_terms()))
def test_every_term_can_be_set_and_each_symbol_is_explained(name):
    html = term_html(term_named(name))
    assert "<math" in html
    assert "mfenced" not in html
    assert not re.search(r"e-\d\d|10</mn><mrow><mo>-", html.partition("<table>")[0].replace("aria", ""))
    for parameter in term_named(name).parameters:
        assert f"<td>{parameter.name}</td>" in html
        assert parameter.doc


def test_the_regularisation_of_a_power_is_not_shown():
    formula = term_html(term_named("churning")).partition("<table>")[0]
    assert "0.0047" not in formula
    assert "2000\u00a0rpm" in term_html(term_named("churning"))


def test_a_law_in_latex_becomes_mathml():
    assert "<math" in latex_html(r"\Delta J\,\dot\omega")


def test_every_effect_of_the_catalogue_is_described():
    described = effect_texts()
    missing = {each.name for each in all_candidates()} - set(described)
    assert not missing, "say what the reader is told of them in winch_friction/physics/effects.yaml"
    for text in described.values():
        assert text.title
        assert text.look
        assert text.physics.count(".") >= 1


def _luminance(colour):
    parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
    return np.dot((0.2126, 0.7152, 0.0722), linear)


@pytest.mark.parametrize("scheme", ["LIGHT", "DARK"])
def test_every_line_stands_out_from_its_card(scheme):
    """WCAG 2.2, 1.4.11: 3 to 1 for what has to be seen of a picture; axe-core looks at text alone."""
    script = (Path(plots.__file__).parent / "templates" / "plots.js").read_text()
    text = re.search(rf"const {scheme} = {{(.*?)}};", script, re.DOTALL)[1]
    colours = dict(re.findall(r'(\w+): "(#\w{6})"', text))
    lines = [colours[role] for role in plots.ROLES if role != "plain"]
    lines += re.findall(r"#\w{6}", re.search(r"plain: \[(.*?)\]", text, re.DOTALL)[1])
    card = _luminance(colours["card"])
    for each in lines:
        low, high = sorted((card, _luminance(each)))
        assert (high + 0.05) / (low + 0.05) >= 3.0, each


def two_panels():
    frames = [Frame("a", {"t [s]": np.arange(4.0), "p, low [bar]": np.arange(4.0) + 10.0}),
              Frame("b", {"t [s]": np.arange(3.0), "share [%]": np.arange(3.0) + 20.0})]  # fmt: skip
    lines = [Line("p", "t [s]", "p, low [bar]", role="before"),
             Line("s", "t [s]", "share [%]", 1, 1, "after", "dots")]  # fmt: skip
    return Plot("A Run: 5 t!", frames, lines, "t [s]", ["p [bar]", "s [%]"], "said", "runs", height=100)


def numbers(packed):
    return np.frombuffer(base64.b64decode(packed), "<f4").tolist()


def test_what_a_page_draws_is_what_the_plot_says():
    html = plot_html(two_panels())
    content = json.loads(re.search(r'application/json">(.*)</script></figure>', html).group(1))
    assert content["lines"] == [["p", "t [s]", "p, low [bar]", 0, 0, "before", "lines", "", -1],
                                ["s", "t [s]", "share [%]", 1, 1, "after", "dots", "", -1]]  # fmt: skip
    assert (content["x"], content["rows"], content["link"]) == ("t [s]", ["p [bar]", "s [%]"], "runs")
    assert numbers(content["frames"][1]["columns"]["share [%]"]) == [20.0, 21.0, 22.0]
    assert 'download="a_run_5_t.csv"' in html
    assert "charset=utf-8,t [s],p  low [bar],share [percent]%0A" in html
    assert "<figcaption>said</figcaption>" in html
    assert "height:290px" in html


def test_a_thinned_line_keeps_every_k_th_sample_of_all_columns_and_at_most_as_many_as_a_screen():
    frame = Frame("a", {"t": np.arange(10.0), "y": 2.0 * np.arange(10.0), "m": [f"m{k}" for k in range(10)]})
    for most, kept in ((10, list(range(10))), (9, [0, 2, 4, 6, 8]), (4, [0, 3, 6, 9]), (3, [0, 4, 8])):
        columns = plots._frame(frame, most)["columns"]
        assert numbers(columns["t"]) == kept
        assert numbers(columns["y"]) == [2 * k for k in kept]
        assert columns["m"] == [f"m{k}" for k in kept]


def test_a_map_keeps_its_axes_and_rows():
    heat = Heat(np.array([1.0, 2.0]), np.array([3.0, 4.0, 5.0]), np.arange(6.0).reshape(3, 2), "h", "x", "y", "bar")
    html = plot_html(Plot("A", [], [], "", [], heats=[heat], height=100))
    (drawn,) = json.loads(re.search(r'application/json">(.*)</script></figure>', html).group(1))["heats"]
    assert [numbers(drawn[k]) for k in "xy"] == [[1.0, 2.0], [3.0, 4.0, 5.0]]
    assert [numbers(row) for row in drawn["z"]] == [[0.0, 1.0], [2.0, 3.0], [4.0, 5.0]]
    assert (drawn["xl"], drawn["yl"], drawn["unit"], drawn["title"]) == ("x", "y", "bar", "h")


def test_a_notebooks_figure_has_the_same_lines_panels_and_looks():
    figure = plotly_figure(two_panels())
    first, second = figure.data
    assert (first.name, list(first.y), first.mode, first.line.dash) == ("p", [10.0, 11.0, 12.0, 13.0], "lines", "dash")
    assert (second.name, list(second.y), second.mode, second.line.dash) == ("s", [20.0, 21.0, 22.0], "markers", "solid")
    assert (first.yaxis, second.yaxis) == ("y", "y2")
    assert figure.layout.yaxis.title.text == "p [bar]"
    assert figure.layout.yaxis2.title.text == "s [%]"
    assert figure.layout.xaxis2.title.text == "t [s]"
    assert figure.layout.height == 320


@pytest.mark.parametrize(
    "wrong", [{"role": "after that"}, {"kind": "bands"}, {"row": 1}, {"upper": "missing"}, {"x": "x"}]
)
def test_a_line_that_cannot_be_drawn_is_refused(wrong):
    known = {"label": "l", "x": "t", "y": "t", **wrong}
    with pytest.raises(InputError, match="plot 'A': line 'l' asks for what is not there"):
        Plot("A", [Frame("a", {"t": np.zeros(1)})], [Line(**known)], "t", ["y"])
