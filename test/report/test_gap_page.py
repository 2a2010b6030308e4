"""The page of `gap`: every number of its tables and plots is the result's own, before is before and after is after."""

import re
from html import unescape
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.answer import Combination, Effect, ParameterEstimate
from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM
from winch_friction.physics.friction.correction import Correction
from winch_friction.report import gap as page
from winch_friction.report.gap_plots import _heat, _measured, _with_breaks, heat_plot, run_plots, speed_plot
from winch_friction.report.gap_words import facts, gap_torque, how_sure, left_of_heave, top_speed_change

EMPTY = SimpleNamespace(runs=(), blocks=SimpleNamespace(y=np.zeros(0)))


def rows(html):
    """The cells of every row of every table, without marks."""
    found = re.findall(r"<tr>(.*?)</tr>", html)
    return [
        [unescape(re.sub("<[^>]*>", "", each)) for each in re.findall(r"<t[dh][^>]*>(.*?)</t[dh]>", row)]
        for row in found
    ]


def run(name="a.csv", unit_torque=10.0, groups=(), drive=0.0, samples=400, dt=0.05):
    time = dt * np.arange(samples)
    return SimpleNamespace(
        name=name, dt=dt, time=time, speed=time * RPM, drive_torque=drive + time, groups=groups, unit_torque=unit_torque
    )


def side(
    *runs, of=(0, 0, 1, 1), before=(3.0, -4.0, 1.0, 1.0), after=(1.0, 2.0, 0.0, 1.0), position=(0, 1, 0, 9), **more
):
    """Four blocks of two runs at 10 to 40 rpm."""
    features = {"motor_speed": np.array([10.0, 20.0, 30.0, 40.0]) * RPM}
    blocks = SimpleNamespace(
        run=np.array(of),
        position=np.array(position),
        features=features | more,
        y=np.zeros(4),
        direction=np.array([1, 1, -1, -1]),
    )
    size = lambda value: SimpleNamespace(value=value, interval=(0.5 * value, 2.0 * value))
    return SimpleNamespace(
        runs=list(runs) or [run(), run("b.csv", 20.0)],
        blocks=blocks,
        before=np.array(before),
        after=np.array(after),
        size_before=size(2.5),
        size_after=size(0.5),
        noise_floor=0.25,
    )


def result(unit="bar", **more):
    base = {
        "unit": unit,
        "train": side(),
        "holdout": side(),
        "effects": [],
        "adequacy": (),
        "considered": (),
        "untestable": (),
        "regions": (),
        "next_experiment": None,
        "seed_refuted": (),
        "notes": (),
    }
    return SimpleNamespace(**(base | more))


def effect(**more):
    return Effect(
        **(
            {
                "name": "coulomb",
                "rivals": (),
                "variant": "",
                "law": "x",
                "parameters": {},
                "p_value": 2e-4,
                "gain": 0.42,
                "selection_frequency": 0.9,
            }
            | more
        )
    )


# -- the decision
def test_the_decision_says_the_gap_before_and_after_beside_its_floor_and_how_sure():
    known = dict(facts(result(effects=[effect()])))
    assert list(known)[0] == "What the repair changes at top speed"
    assert known["Gap on locked runs"] == "2.5 → 0.5 bar RMS"
    assert known["Noise floor"] == "0.25 bar"
    assert known["How sure"] == "chance finding below 1 in 1000; named first in 90 % of redrawn data"
    assert list(dict(facts(result("N*m")))) == ["Gap on locked runs", "Noise floor"]
    assert dict(facts(result("N*m")))["Noise floor"] == "0.25 N·m"


@pytest.mark.parametrize(("p", "said"), [(9e-4, "below 1 in 1000"), (1e-3, "p = 0.001"), (0.04, "p = 0.04")])
def test_a_chance_is_said_down_to_one_in_a_thousand(p, said):
    assert how_sure(result(effects=[effect(p_value=p)])).startswith(f"chance finding {said};")


def test_what_the_repair_changes_is_a_torque_by_each_runs_own_pressure_and_leaves_heave():
    """Before minus after: 2 and -6 bar at 10 N m/bar, 1 and 0 bar at 20 N m/bar."""
    torque = np.sqrt((20.0**2 + 60.0**2 + 20.0**2) / 4)
    found = result(train=side(before=(99.0, 9.0, 9.0, 9.0)))
    assert gap_torque(found) == pytest.approx(torque)
    low, high = re.match(r"(\S+) to (\S+) mm", left_of_heave(found)).groups()
    assert (float(low), float(high)) == pytest.approx((8.9 / 457 * torque, 24.3 / 648 * torque), rel=0.05)
    assert left_of_heave(result("N*m")) == ""


def test_the_change_at_top_speed_of_an_electric_drive_is_no_pressure():
    """One block in ten is fast: the last of each side, with changes of 0 and 0."""
    found = result("N*m", train=side(after=(1.0, 2.0, 0.0, 4.0)), holdout=side(after=(1.0, 2.0, 0.0, 2.0)))
    assert top_speed_change(found) == "40 N·m above 40 rpm"


def test_the_subtitle_counts_the_runs_that_were_learned_from_and_the_locked_ones():
    found = result(train=side(run(), run(), run()), holdout=side(run()), seed_model=SimpleNamespace(name="seed"))
    assert page._subtitle(found) == "Model seed; 3 runs learned from, 1 locked for the proof."


# -- what is missing
def test_an_effects_evidence_is_its_own():
    known = {"T_c": ParameterEstimate(12.0, 0.5, "N*m"), "w_c": ParameterEstimate(10.0 * RPM, RPM, "rad/s")}
    combined = Combination("a + b", 3.0, 0.25, "kg*m^2", "tied")
    own = effect(parameters=known, where="at reversals", rivals=("brake_drag", "notch"), combination=combined)
    html = page._effect(own, SimpleNamespace(model=SimpleNamespace(terms=())))
    assert (
        "Evidence (at reversals): p = 0.0002; the error on data not fitted is lower by 42 %; named first in 90 %"
        in html
    )
    assert "These runs cannot tell it from brake_drag or notch." in html
    assert "a + b = 3 ± 0.25 kg·m² (tied)." in html
    assert rows(html)[:3] == [
        ["parameter", "value", "σ", "unit"],
        ["T_c", "12", "0.5", "N·m"],
        ["w_c", "10", "1", "rpm"],
    ]


@pytest.mark.parametrize(("name", "drawn"), [("signal_delay", 1), ("coulomb", 0)])
def test_a_delays_course_is_drawn_beside_its_name(name, drawn):
    course = Correction("signal_course", 0.15, 0.01, course=((0.0, 0.5), (40.0, 1.0)))
    model = SimpleNamespace(terms=(), corrections=(course, Correction("signal_delay", 0.01)))
    html = page._effect(effect(name=name), SimpleNamespace(model=model))
    assert html.count("How late the speed is logged.") == drawn


def test_a_combination_is_told_in_the_unit_that_stands_behind_it():
    """-1.364 bar stood there as -1.364e+05 bar: it was in Pa."""
    combined = Combination("p_l - 0.957 * p_h", -136361.9, 12668.0, "Pa", "tied")
    html = page._effect(effect(combination=combined), SimpleNamespace(model=SimpleNamespace(terms=())))
    assert "p_l - 0.957 * p_h = -1.364 ± 0.13 bar (tied)." in html


@pytest.mark.parametrize(
    ("variant", "parameters", "said"),
    [
        ("all groups", {}, True),
        ("tau = 240", {"tau": ParameterEstimate(240.0, 1.0, "s")}, False),
        ("", {}, False),
    ],
)
def test_the_shape_of_an_effect_is_said_where_no_parameter_says_it(variant, parameters, said):
    html = page._effect(
        effect(variant=variant, parameters=parameters), SimpleNamespace(model=SimpleNamespace(terms=()))
    )
    assert ("Found as: all groups." in html) is said
    assert ("Found as" in html) is said


def test_a_proposed_law_stands_with_what_it_leaves_on_locked_runs():
    proposal = {
        "sentence": "friction in proportion to wire out",
        "latex": "x",
        "equation": "k*L",
        "parameters": {
            "k": {"value": 0.5, "std": 0.1, "unit": "N*m/m"},
            "c": {"value": 80e5, "std": 3e5, "unit": "Pa"},
        },
        "holdout": {"before": 3.0, "after": 0.5, "closed": 1.01},
        "terms_file": "p.py",
        "model_file": "p.yaml",
    }
    html = page._proposals(SimpleNamespace(content=lambda: {"proposals": [proposal]}, unit="bar"))
    parameters, laws = rows(html)[1:3], rows(html)[-2:]
    assert parameters == [["k", "0.5", "0.1", "N·m/m"], ["c", "80", "3", "bar"]]
    assert laws == [
        ["equation, SI", "gap before [bar]", "gap after [bar]", "closed [%]", "terms", "model"],
        ["k*L", "3", "0.5", "100", "p.py", "p.yaml"],
    ]
    assert "<p>Friction in proportion to wire out.</p>" in html


# -- what else
def test_adequacy_says_what_these_runs_have_and_what_is_needed():
    checks = (
        SimpleNamespace(what="moving time", value=3.0, needed=15.0, unit="s", met=False),
        SimpleNamespace(what="top speed", value=9.0, needed=4.0, unit="rad/s", met=True),
    )
    assert rows(page._adequacy(result(adequacy=checks))) == [
        ["what a search needs", "these runs", "needed", "unit", "met"],
        ["moving time", "3", "15", "s", "no"],
        ["top speed", "85.9", "38.2", "rpm", "yes"],
    ]


def test_what_the_data_say_of_the_seed_names_what_it_looks_like():
    one = SimpleNamespace(shifts={"C3": 1.0, "K1": 2.0}, sigma=4.56, mimics=("coulomb",))
    other = SimpleNamespace(shifts={"C6": 1.0}, sigma=3.0, mimics=())
    assert re.findall("<li>(.*?)</li>", page._seed(result(seed_refuted=(one, other)))) == [
        "C3, K1 leave what the seed says of them, by 4.6 σ together; it looks like coulomb.",
        "C6 leave what the seed says of them, by 3.0 σ together.",
    ]


def test_regions_are_shares_of_the_gap_in_per_cent_with_speeds_in_rpm():
    region = SimpleNamespace(where=f"motor_speed > {100 * RPM:.6g} rad/s", share_of_gap=0.25, mean_residual=-1.5)
    assert rows(page._regions(result(regions=(region,)))) == [
        ["where", "share of the gap [%]", "mean gap [bar]"],
        ["motor_speed > 100\u00a0rpm", "25", "-1.5"],
    ]
    assert page._in_rpm("acceleration > 3 rad/s^2") == "acceleration > 3 rad/s^2"


def test_candidates_alone_and_the_rejected_stand_apart():
    alone = [
        SimpleNamespace(stage=0, name=f"e{k}", variant="", gain=0.5 - 0.01 * k, p_value=0.125, verdict="no")
        for k in range(10)
    ]
    later = SimpleNamespace(stage=1, name="later", variant="T_vh = 50", gain=0.1, p_value=0.5, verdict="too small")
    blind = SimpleNamespace(name="oil", needs="oil_temperature", because="not recorded")
    found = result(considered=[*alone, later], untestable=[blind], effects=[effect(name="e0")])
    html = page._considered(found)
    table = rows(html)
    assert table[1] == ["e0", "", "50", "0.125"]
    assert [row[0] for row in table[1:9]] == [f"e{k}" for k in range(8)]
    assert table[10] == ["1", "e1", "", "no"]
    assert ["2", "later", "T_vh = 50\u00a0°C", "too small"] in table
    assert "<summary>10 rejected</summary>" in html
    assert table[-1] == ["oil", "oil_temperature", "not recorded"]


def test_the_experiments_that_were_weighed_stand_with_their_separation():
    plan = {"considered": {"ahc": 4.5, "normal": 1.25}, "note": "dear"}
    html = page._plan(result(next_experiment=plan))
    assert rows(html)[1:] == [["ahc", "4.5"], ["normal", "1.25"]]
    assert html.endswith("<p>dear</p>")
    assert page._plan(result(next_experiment={"considered": {}, "note": "none"})) == "<p>none</p>"


# -- plots
def group(name, count, displacement, pressure, balances):
    return SimpleNamespace(
        name=name,
        count=count,
        displacement=np.full(400, displacement * CM3_PER_REV),
        pressure=np.full(400, pressure * BAR),
        balances=balances,
    )


def test_what_was_measured_is_the_balancing_groups_pressure_or_the_torque():
    passive, active = group("passive", 8, 200.0, 100.0, False), group("active", 3, 100.0, 50.0, True)
    total = sum(g.count * g.displacement[0] * g.pressure[0] for g in (passive, active))
    both = run(groups=(passive, active), drive=total)
    both.drive_torque = np.full(400, total)
    assert _measured(both) == pytest.approx(50.0)  # bar
    assert _measured(run(groups=(), drive=7.0, unit_torque=1.0))[:2] == pytest.approx([7.0, 7.05])


def test_a_run_is_drawn_by_the_middle_of_its_blocks_before_and_after():
    """Blocks of 0.2 s are four samples of this run, whose torque and speed rise with time."""
    one = run(unit_torque=1.0)
    own = side(one, of=(0, 0, 0, 0), position=(0, 1, 2, 20))
    (plot,) = run_plots(result("N*m"), own)
    columns = plot.frames[0].columns
    assert columns["time [s]"][:3].tolist() == pytest.approx([0.0, 0.2, 0.4])
    middle = np.array([0.1, 0.3, 0.5])
    assert columns["motor speed [rpm]"][:3] == pytest.approx(middle)
    assert columns["measured [N·m]"][:3] == pytest.approx(middle)
    assert columns["model before [N·m]"][:3] == pytest.approx(middle - [3.0, -4.0, 1.0])
    assert columns["model after [N·m]"][:3] == pytest.approx(middle - [1.0, 2.0, 0.0])
    looks = [(line.y, line.row, line.role) for line in plot.lines]
    assert looks == [
        ("motor speed [rpm]", 0, "measured"),
        ("measured [N·m]", 1, "measured"),
        ("model before [N·m]", 1, "before"),
        ("model after [N·m]", 1, "after"),
        ("gap before [N·m]", 2, "before"),
        ("gap after [N·m]", 2, "after"),
    ]
    assert list(plot.rows) == ["motor speed [rpm]", "drive torque [N·m]", "gap [N·m]"]
    assert "means over 0.2 s" in plot.caption


def test_each_run_has_its_own_blocks_and_one_without_any_no_figure():
    plots = run_plots(result(), side(run("a"), run("b"), run("c"), of=(0, 2, 2, 0), before=(1.0, 2.0, 3.0, 4.0)))
    assert [plot.title for plot in plots] == ["Run a", "Run c"]
    gaps = [plot.frames[0].columns["gap before [bar]"] for plot in plots]
    assert [each[np.isfinite(each)].tolist() for each in gaps] == [[1.0, 4.0], [2.0, 3.0]]


def test_a_pause_breaks_the_line():
    broken = _with_breaks({"x": np.array([0.0, 0.2, 0.4, 2.0]), "y": np.arange(4.0)}, "x", 0.05)
    assert broken["x"].tolist() == [0.0, 0.2, 0.4, 0.4, 2.0]
    assert np.isnan(broken["y"]).tolist() == [False, False, False, True, False]
    whole = _with_breaks({"x": np.array([0.0, 0.2, 0.75]), "y": np.arange(3.0)}, "x", 0.05)
    assert len(whole["x"]) == 3


def test_the_gap_by_speed_is_the_rms_of_the_locked_runs_before_and_after():
    """At 10 to 40 rpm in eight equal steps: every block has a bin of its own."""
    found = result(train=side(before=(99.0,) * 4))
    plot = speed_plot(found)
    columns = plot.frames[0].columns
    assert columns["before [bar]"].tolist() == [3.0, 4.0, 1.0, 1.0]
    assert columns["after [bar]"].tolist() == [1.0, 2.0, 0.0, 1.0]
    assert columns["noise floor [bar]"].tolist() == [0.25] * 4
    assert columns["motor speed [rpm]"] == pytest.approx([7.5, 17.5, 27.5, 37.5], abs=0.05)
    assert [(line.role, line.kind) for line in plot.lines] == [
        ("before", "bars"),
        ("after", "bars"),
        ("noise", "lines"),
    ]


def test_a_heat_map_is_empty_where_fewer_than_three_blocks_lie():
    x, y = np.array([1.0, 1.0, 1.0, 9.0, 9.0]), np.array([1.0, 1.0, 1.0, 5.0, 5.0])
    heat = _heat(x, y, np.array([1.0, 2.0, 6.0, 50.0, 50.0]), "t", "load", "bar")
    assert np.isfinite(heat.values).sum() == 1
    assert np.nanmax(heat.values) == pytest.approx(3.0)
    j, i = np.argwhere(np.isfinite(heat.values))[0]
    assert abs(heat.x[i] - 1.0) < 0.6
    assert abs(heat.y[j] - 1.0) < 0.6


@pytest.mark.parametrize(
    ("more", "label"),
    [
        ({"hook_load": np.array([1e4, 2e4, 3e4, 4e4])}, "hook load [t]"),
        ({"hook_load": np.full(4, 1e4), "oil_temperature": np.array([20.0, 30.0, 40.0, 50.0])}, "oil temperature [°C]"),
        ({"hook_load": np.full(4, np.nan), "acceleration": np.arange(4.0)}, "acceleration [rad/s²]"),
        ({}, "time [s]"),
    ],
)
def test_the_gap_is_mapped_over_what_varies_hoisting_and_lowering_apart(more, label):
    plot = heat_plot(result(train=side(**more)))
    assert [heat.title for heat in plot.heats] == ["hoisting", "lowering"]
    assert {heat.y_label for heat in plot.heats} == {label}
    assert plot.heats[0].x.max() < 20.1
    assert plot.heats[1].x.max() > 30.0
    if label == "hook load [t]":
        assert 9.9 < plot.heats[0].y.min() < plot.heats[0].y.max() < 20.1
