"""The page: self-contained, escaped, with pictures that follow the page's colours."""

import re

import numpy as np
import pytest

from winch_friction.report.base import TextSection, render, write_report
from winch_friction.report.decision import decision_html, list_html, provenance_html
from winch_friction.report.figures import new_figure, save_figure
from winch_friction.report.tables import (
    estimate_for_people,
    for_people,
    number,
    paragraph,
    table_html,
    value_for_people,
)


def picture(points=50):
    figure, axes = new_figure()
    axes.plot(np.linspace(0, 1, points), np.random.default_rng(0).normal(size=points))
    axes.set_xlabel("time, s")
    return figure


def page():
    table = table_html(["speed", "error"], [["0–50 rpm", 1.25], ["<script>", float("nan")]], caption="Errors")
    sections = [
        TextSection("Result", paragraph("5 < 6 & done") + table),
    ]
    return render("Winch <150 t>", sections)


def test_a_page_refers_to_nothing_outside_itself():
    text = re.sub(r'xmlns(:\w+)?="[^"]*"', "", page())
    assert not re.findall(r'(?:src|href)="(?!#|data:)[^"]*"', text)
    assert "http" not in text
    assert "@import" not in text


def test_what_people_wrote_is_escaped():
    text = page()
    assert "Winch &lt;150 t&gt;" in text
    assert "&lt;script&gt;" in text
    assert "5 &lt; 6 &amp; done" in text
    assert "<script" not in text.partition("</footer>")[0]  # behind it stands the page's own


def test_a_table_can_be_folded_to_the_width_of_a_phone():
    """Its title stands outside what scrolls, long names may break after an underscore, a hash anywhere."""
    table = table_html(["name", "hash"], [["oil_temperature", "f612bf17f8a2f2126c7b7e7edc4f615e"]], caption="Files")
    before, _, inside = table.partition("<table>")
    assert "Files" in before.partition('<div class="scroll"')[0]
    assert "Files" not in inside
    assert "oil_<wbr>temperature" in inside
    assert "f612bf17f8a2f212<wbr>6c7b7e7edc4f615e" in inside


def test_files_are_written(tmp_path):
    path = write_report(tmp_path / "deep" / "report.html", "Title", [TextSection("One", "<p>x</p>")])
    assert path.read_text(encoding="utf-8").startswith("<!doctype html>")
    assert save_figure(picture(), tmp_path / "a.png").read_bytes()[:4] == b"\x89PNG"


def test_numbers_are_written_for_people():
    assert [number(v) for v in (0.0, 1234.56, 123456.7, 1.5e-7, float("nan"))] == [
        "0",
        "1235",
        "123457",
        "1.5e-07",
        "–",
    ]


def test_a_quantity_stays_on_one_line():
    """On a phone `55 t, 215 cm³/rev` otherwise takes four lines."""
    table = table_html(["leg", "left"], [["55 t, 215 cm³/rev", "1.0 (−89 %)"], ["10 tests of 12 cranes", "a/b_c"]])
    assert "55\u00a0t, 215\u00a0cm³/rev" in table
    assert "(−89\u00a0%)" in table
    assert "<wbr>" not in table
    assert "10 tests of" in table


def test_a_unit_in_a_sentence_reads_as_in_a_heading():
    table = table_html(["where"], [["main.displacement < 215 cm^3/rev"], ["less than 0.0012 m^3 would not show"]])
    assert "215\u00a0cm³/rev" in table
    assert "0.0012\u00a0m³ would" in table
    assert "x.unit=cm^3/<wbr>rev" in table_html(["command"], [["import --set x.unit=cm^3/rev"]])  # to be typed as it is


@pytest.mark.parametrize(
    ("value", "shown"),
    [(0.0, "0"), (0.00123456, "0.001235"), (0.000123456, "0.0001235"), (123456.0, "123456"), (1234567.0, "1.235e+06"),
     (-54321.4, "-54321"), (float("inf"), "–")],
)  # fmt: skip
def test_a_number_has_no_exponent_where_it_stays_short(value, shown):
    assert number(value) == shown


def test_counts_are_whole_and_a_column_of_numbers_and_words_is_one_of_words():
    text = table_html(["count", "size", "mixed"], [[12345678, 1.23456789, 3.0], [7, None, "none"]])
    assert '<td class="number">12345678</td><td class="number">1.235</td><td>3</td>' in text
    assert '<td class="number">7</td><td class="number">–</td><td>none</td>' in text


def test_a_long_word_is_no_sentence():
    words, word = "it is a sentence of more than forty characters", "a" * 50
    assert table_html(["x"], [[words]]).count('class="words"') == 1
    assert 'class="words"' not in table_html(["x"], [[word]])


@pytest.mark.parametrize(
    ("value", "unit", "shown", "said"),
    [(np.pi, "rad/s", 30.0, "rpm"), (2e5, "Pa", 2.0, "bar"), (5500.0, "kg", 5.5, "t"), (3.0, "N*m", 3.0, "N·m"),
     (40.0, "degC", 40.0, "°C"), (2.0, "kg*m^2", 2.0, "kg·m²"),
     (0.1e-6 / (2 * np.pi), "m^3/rad/K", 0.1, "cm³/rev/K"), (2e4, "Pa/K", 0.2, "bar/K"),
     (1e3, "Pa/K^2", 0.01, "bar/K²")],
)  # fmt: skip
def test_a_quantity_has_the_unit_that_people_read_it_in(value, unit, shown, said):
    assert value_for_people(value, unit) == pytest.approx(shown)
    assert for_people(unit) == said


def test_an_instant_is_a_date_and_a_duration_a_duration():
    assert estimate_for_people(1.741788e9, 82800.0, "s") == ("2025-03-12 14:00 UTC", 23.0, "h")
    assert estimate_for_people(1.2e6, 3600.0, "s") == (1.2e6, 3600.0, "s")
    assert estimate_for_people(np.pi, 0.0, "rad/s") == (pytest.approx(30.0), 0.0, "rpm")


def test_a_channels_name_folds_behind_its_group():
    """On a phone the sentence beside `main.pressure_a` was cut off."""
    assert "main.<wbr>pressure_a" in table_html(["channel"], [["main.pressure_a"]])
    assert "<wbr>" not in table_html(["value"], [["0.1234567890123"]])


def test_where_a_page_comes_from_is_said_as_far_as_it_is_known():
    known = {"command": "winch-friction gap", "commit": "", "seed": 0, "data_sha256": {"a": "1f", "b": "2e"}}
    html = provenance_html(known | {"runs": ["a", "b"], "files": [{"name": "a.csv", "sha256": "1f"}]})
    cells = [re.findall(r"<td[^>]*>(.*?)</td>", row) for row in re.findall(r"<tr>(.*?)</tr>", html)]
    assert [row for row in cells if row] == [
        ["command", "winch-friction gap"], ["seed", "0"], ["data sha256", "a 1f, b 2e"], ["runs", "a, b"],
        ["a.csv", "1f"],
    ]  # fmt: skip
    assert "Files" not in provenance_html({"seed": 1})
    assert re.findall(r"<td[^>]*>(.*?)</td>", provenance_html({"files": {"c.csv": "3d"}})) == ["c.csv", "3d"]


def test_a_fact_without_a_value_and_a_list_without_lines_are_left_out():
    html = decision_html("Do `this`.", [("size", "3 bar"), ("heave", "")], "<p>after</p>")
    assert re.findall(r"<dt>(.*?)</dt><dd>(.*?)</dd>", html) == [("size", "3 bar")]
    assert html.startswith('<p class="verdict">Do <code>this</code>.</p>')
    assert html.endswith("<p>after</p>")
    assert "<dl" not in decision_html("s", [("heave", "")])
    assert list_html(["a"], ordered=True) == "<ol><li>a</li></ol>"
    assert (list_html(["a", "<"]), list_html([])) == ("<ul><li>a</li><li>&lt;</li></ul>", "")


def test_the_last_section_says_where_the_page_comes_from(tmp_path):
    text = write_report(tmp_path / "a.html", "T", [TextSection("One", "1")], "sub", {"seed": 7}).read_text("utf-8")
    assert text.index("One") < text.index("Provenance")
    assert "sub" in text
    assert "Provenance" not in write_report(tmp_path / "b.html", "T", [TextSection("One", "1")]).read_text("utf-8")
