"""The commissioning page: the verdict's facts, the balance and every channel's numbers under their own headings."""

import re
from html import unescape
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.commissioning.balance import Closure
from winch_friction.commissioning.channels import Finding
from winch_friction.commissioning.commissioning import RunBalance
from winch_friction.commissioning.kinematics import Agreement
from winch_friction.commissioning.summaries import ChannelSummary
from winch_friction.physics.channels import CM3_PER_REV, RPM
from winch_friction.physics.signals import Run
from winch_friction.report import check as page

RUN = Run(
    "a.csv",
    {
        "time": 100.0 + np.arange(3.0),
        "motor_speed": np.array([-10.0, 0.0, 40.0]) * RPM,
        "main.pressure_a": np.array([1e7, 2e7, 3e7]),
        "main.pressure_b": np.array([1e6, 2e6, 3e6]),
        "main.displacement": np.full(3, 215 * CM3_PER_REV),
    },
)


def rows(html):
    """The cells of every row of every table, without marks."""
    found = re.findall(r"<tr>(.*?)</tr>", html)
    return [
        [unescape(re.sub("<[^>]*>", "", each)) for each in re.findall(r"<t[dh][^>]*>(.*?)</t[dh]>", row)]
        for row in found
    ]


def result(**more):
    balance = (
        RunBalance("a.csv", 1.5, 300.0, 40.0, 5000.0, {}, (Agreement("wire_out", 0.98, 0.99, 0.1),)),
        RunBalance("b.csv", 7.25, 900.0, 80.0, 6000.0, {}, ()),
    )
    closure = Closure(
        "b.csv", 7.25, 900.0, 80.0, 6000.0, {}, np.array([5.0, 6.0]), np.array([4e3, 5e3]), np.array([1e3, 2e3])
    )
    mistake = SimpleNamespace(words="hook_load is in kg", channel="hook_load")
    hypotheses = tuple(SimpleNamespace(mistake=mistake, score=0.5 + k) for k in range(10))
    base = {
        "plausible": True, "findings": (), "balance": balance, "limit": 6.0, "log_next": (), "sentence": "Said.",
        "closures": (closure,), "diagnosis": SimpleNamespace(score=9.0, hypotheses=hypotheses), "runs": (RUN,),
        "channels": {"a.csv": [ChannelSummary("main.pressure_a", "Pa", 1e7, 3e7, 0.25, 0.1, 4.0)]},
        "identifiable": (SimpleNamespace(name="C3", before=0.5, after=0.125, words="a little"),),
    }  # fmt: skip
    return SimpleNamespace(**(base | more))


def facts(html):
    return dict(re.findall(r"<dt>(.*?)</dt><dd>(.*?)</dd>", html))


def test_the_decision_says_the_largest_misfit_of_all_runs_beside_its_limit():
    assert facts(page._decision(result())) == {"verdict": "plausible", "largest misfit": "7.25 (limit 6)"}
    findings = tuple(Finding(severity, "unit", f"{severity}!") for severity in ("error", "warning", "error"))
    wrong = page._decision(result(plausible=False, findings=findings, log_next=("wire_out",)))
    assert facts(wrong)["verdict"] == "not this crane&#x27;s as it stands"
    assert facts(wrong)["contradictions"] == "2"
    assert "<h3>Log next</h3><ul><li>wire_out</li></ul>" in wrong


def test_a_balance_stands_before_and_after_ordinary_errors_in_its_columns():
    head, first, second = rows(page._balance(result(closures=())))
    assert head == ["run", "misfit", "as it stands [N·m]", "after ordinary errors [N·m]", "load [N·m]", "speed told by"]
    assert first == ["a.csv", "1.5", "300", "40", "5000", "wire_out 0.98"]
    assert second == ["b.csv", "7.25", "900", "80", "6000", ""]


def test_what_was_measured_and_what_was_expected_are_drawn_in_kn_m_over_the_runs_time():
    plot = page._balance_plot(result(), 0)
    columns, lines = plot.frames[0].columns, {line.label: line for line in plot.lines}
    assert columns["time [s]"].tolist() == [0.0, 1.0]
    assert columns[lines["measured"].y].tolist() == [4.0, 5.0]
    assert columns[lines["expected"].y].tolist() == [1.0, 2.0]
    assert [lines[each].role for each in ("measured", "expected")] == ["measured", "before"]


def test_the_mistakes_stand_below_the_data_as_they_are_at_most_eight():
    head, first, second, *others = rows(page._ranking(result()))
    assert head == ["if", "misfit", "channel"]
    assert first == ["as it stands", "9", ""]
    assert second == ["hook_load is in kg", "0.5", "hook_load"]
    assert len(others) == 7
    assert page._ranking(result(diagnosis=SimpleNamespace(score=9.0, hypotheses=()))) == ""


def test_a_channels_range_is_in_the_unit_that_people_read():
    assert rows(page._numbers(result(), RUN)) == [
        ["channel", "unit", "smallest", "largest", "missing [%]", "longest still [s]"],
        ["main.pressure_a", "bar", "100", "300", "25", "4"],
    ]


@pytest.mark.parametrize(
    ("column", "value", "shown", "unit"),
    [("motor_speed", np.pi, 30.0, "rpm"), ("main.pressure_a", 2e7, 200.0, "bar"), ("hook_load", 55e3, 55.0, "t"),
     ("oil_temperature", 40.0, 40.0, "°C"), ("main.displacement", 215 * CM3_PER_REV, 215.0, "cm³/rev"),
     ("nobody_knows", 3.0, 3.0, "SI")],
)  # fmt: skip
def test_a_channel_is_drawn_in_its_own_unit(column, value, shown, unit):
    values, said = page._shown(column, np.array([value]))
    assert values == pytest.approx([shown])
    assert said == unit


def test_channels_of_one_unit_share_a_panel(monkeypatch):
    drawn = []
    monkeypatch.setattr(page, "plot_html", lambda plot: drawn.append(plot) or "")
    page._drawn(RUN)
    (plot,) = drawn
    assert list(plot.rows) == ["[rpm]", "[bar]", "[cm³/rev]"]
    assert {line.label: line.row for line in plot.lines} == {
        "motor_speed": 0, "main.pressure_a": 1, "main.pressure_b": 1, "main.displacement": 2,
    }  # fmt: skip
    columns = plot.frames[0].columns
    assert columns["time [s]"].tolist() == [0.0, 1.0, 2.0]
    assert columns["motor_speed [rpm]"] == pytest.approx([-10.0, 0.0, 40.0])
    assert columns["main.pressure_b [bar]"] == pytest.approx([10.0, 20.0, 30.0])


def test_of_many_runs_the_first_are_drawn_and_it_is_said(monkeypatch):
    monkeypatch.setattr(page, "plot_html", lambda plot: plot.title)
    many = tuple(Run(f"r{k:02d}", RUN.columns) for k in range(page.MOST_RUNS_DRAWN + 1))
    said = page._channels(result(runs=many, channels={each.name: [] for each in many}))
    assert said.count("<h3>") == page.MOST_RUNS_DRAWN
    assert f"The first {page.MOST_RUNS_DRAWN} runs are drawn." in said
    assert "r00" in said
    assert many[-1].name not in said
    assert "are drawn" not in page._channels(result(runs=many[:-1], channels={each.name: [] for each in many}))


def test_what_runs_can_teach_is_told_before_and_with_them_in_per_cent():
    head, row = rows(page._lessons(result()))
    assert head == ["parameter", "model's std [%]", "std with these runs [%]", "these runs teach"]
    assert row == ["C3", "50", "12.5", "a little"]
    assert page._lessons(result(identifiable=())) == ""
