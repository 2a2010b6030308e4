"""What verbs say on the terminal: each number under its own heading, each state with its own share."""

import json
import re
from pathlib import Path
from types import SimpleNamespace
from urllib.error import HTTPError
from urllib.parse import urljoin
from urllib.request import urlopen

import numpy as np
import pytest

from winch_friction.cli import bench, gap, gap_blind, gap_output, identify, identify_output, provenance, replay
from winch_friction.cli.chart import chart
from winch_friction.cli.compare import _loads, _refuse_two_cranes, _said
from winch_friction.cli.console import show_json, show_table
from winch_friction.cli.convert import _without_topic
from winch_friction.cli.dashboard import Broadcast, serving
from winch_friction.cli.fleet import _flags, _status, _storage_options
from winch_friction.cli.inputs import refuse_copies, refuse_existing, refuse_foreign, refuse_input_as_output
from winch_friction.cli.simulate import _effect, _truth_of
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run
from winch_friction.records.strict_yaml import shipped
from winch_friction.simulation import fmu


@pytest.fixture
def tabled(monkeypatch):
    """Tables as they are asked for: title -> (columns, rows)."""
    found = {}
    for module in (identify_output, gap_output, replay):
        keep = lambda title, columns, rows: found.update({title: (list(columns), [list(row) for row in rows])})
        monkeypatch.setattr(module, "show_table", keep)
    return found


# -- a chart in plain characters
def test_a_chart_has_its_highest_value_above_and_its_last_speed_on_the_right():
    """As many rows as columns: the line that rises to 10 is the diagonal, the one at 2 lies four rows up."""
    drawn = {"up": [0.0, 5.0, 10.0], "flat": [2.0, 2.0, 2.0]}
    lines = chart([0.0, 50.0, 100.0], drawn, "rpm", "torque", 21, 21).splitlines()
    assert lines[0] == "torque"
    assert (lines[1].split()[0], lines[21].split()[0]) == ("10", "0")
    body = [line.partition("|")[2].ljust(21) for line in lines[1:22]]
    assert [row.find("*") for row in body] == [-1 if k == 16 else 20 - k for k in range(21)]
    assert body[16] == "o" * 21
    assert lines[23].split() == ["0", "100", "rpm"]
    assert lines[24].split() == ["*", "up", "o", "flat"]


def test_a_chart_of_negative_torque_begins_below_and_one_of_nothing_has_a_height():
    lines = chart([0.0, 1.0], {"a": [-4.0, float("nan")]}, "x", "y", 5, 4).splitlines()
    assert (lines[1].split()[0], lines[4].split()[0]) == ("0", "-4")
    assert chart([0.0, 1.0], {"a": [0.0, 0.0]}, "x", "y", 5, 4).splitlines()[1].split()[0] == "1"
    assert chart([0.0, 1.0], {"a": [3.0, 4.0]}, "x", "y", 5, 4).splitlines()[4].split()[0] == "0"


# -- compare
def row(largest, load=55.0, of=200.0, sigma=float("nan"), rpm=1000.0):
    return {"largest [N*m]": largest, "load [t]": load, "of [N*m]": of, "in sigmas": sigma, "at [rpm]": rpm}


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ([row(0.0), row(0.0)], "b and a are the same on this grid."),
        (
            [row(20.0), row(-30.0, 100.0, 300.0, rpm=250.0), row(10.0)],
            "b differs from a by -30 N·m at most, at 250 rpm and 100 t (10 %).",
        ),
        (
            [row(50.0, sigma=2.0)],
            "b differs from a by +50 N·m at most, at 1000 rpm and 55 t (25 %), within what they do "
            "not know of themselves.",
        ),
        (
            [row(50.0, of=-200.0, sigma=2.01)],
            "b differs from a by +50 N·m at most, at 1000 rpm and 55 t (25 %), more than "
            "what they do not know of themselves.",
        ),
    ],
)
def test_two_models_are_judged_by_their_largest_difference_whatever_its_sign(rows, said):
    assert _said("a", "b", rows) == said


def test_masses_are_numbers_from_nought_on():
    assert _loads("0,15,55.5") == [0.0, 15.0, 55.5]
    for wrong in ("1,-1", "nan", "inf", "1;2"):
        with pytest.raises(InputError, match="--loads"):
            _loads(wrong)


def model(name, crane, *scopes):
    return SimpleNamespace(
        name=name, crane=crane, terms=[SimpleNamespace(scope=SimpleNamespace(value=s)) for s in scopes]
    )


@pytest.mark.parametrize(
    ("one", "two", "warned"),
    [
        (("motor",), ("motor", "shaft"), "one"),
        (("motor", "shaft"), ("motor",), "two"),
        (("motor",), ("motor",), ""),
        (("motor", "shaft"), ("shaft",), ""),
    ],
)
def test_a_motors_model_against_a_winchs_is_told(one, two, warned, capsys):
    _refuse_two_cranes(model("one", "", *one), model("two", "c", *two))
    said = capsys.readouterr().err
    assert re.findall(r"model '(\w+)' has no losses of gear and drum", said) == ([warned] if warned else [])
    with pytest.raises(InputError, match="'one' is of crane 'c', 'two' of crane 'd'"):
        _refuse_two_cranes(model("one", "c", *one), model("two", "d", *two))


# -- identify
def test_motor_models_have_their_own_numbers_and_the_recommended_is_offered(tabled, capsys):
    fit = lambda *values: SimpleNamespace(
        **dict(zip(("parameter_count", "rms", "cost", "evaluations"), values, strict=True))
    )
    scores = [
        SimpleNamespace(name="mj4", fitted=fit(5, 0.5, 4.0, 10), held_out=0.75, bic=-30.0),
        SimpleNamespace(name="mj6", fitted=fit(6, 0.25, 3.0, 20), held_out=0.625, bic=-40.0),
    ]
    chosen = SimpleNamespace(name="mj4", fitted=SimpleNamespace(condition=12.0))
    table = SimpleNamespace(name="maker", __len__=None)
    found = SimpleNamespace(
        scores=scores,
        by_complex={"mj4": fit(5, 0.5, 4.5, 300)},
        recommended="mj6",
        chosen=chosen,
        recommended_by="BIC",
        table=type("T", (), {"name": table.name, "__len__": lambda _: 7})(),
    )
    empty = SimpleNamespace(parameters=(), values=(), std=np.zeros(0))
    identify_output.show_motor(found, empty, Path("seed.yaml"), False)
    columns, rows = tabled["maker: 7 rows"]
    assert dict(zip(columns, rows[0], strict=True)) == {
        "model": "mj4",
        "parameters": 5,
        "RMS N·m": 0.5,
        "held-out RMS": 0.75,
        "BIC": -30.0,
        "cost LS": 4.0,
        "cost complex": 4.5,
        "evaluations LS": 10,
        "evaluations complex": 300,
    }
    assert np.isnan(rows[1][columns.index("cost complex")])
    said = capsys.readouterr().out
    assert "recommended by BIC: mj6 (--use mj6 writes it)" in said
    assert "wrote mj4 to seed.yaml" in said
    identify_output.show_motor(found, empty, Path("seed.yaml"), True)
    content = json.loads(capsys.readouterr().out)
    assert (content["recommended"], content["condition"]) == ("mj6", 12.0)
    assert content["scores"][0]["cost_complex"] == 4.5
    assert content["scores"][1] == {
        "model": "mj6",
        "parameters": 6,
        "rms": 0.25,
        "held_out": 0.625,
        "bic": -40.0,
        "cost": 3.0,
        "cost_complex": None,
        "evaluations": 20,
        "evaluations_complex": 0,
    }


def system(**more):
    loops = [SimpleNamespace(number=1, cost=8.0), SimpleNamespace(number=2, cost=2.0)]
    tie = SimpleNamespace(first="K1", second="C5")
    base = {
        "unseen": ["K3"],
        "ties": [tie],
        "fits": {},
        "held_out_costs": [10.0, 6.0],
        "loops": loops,
        "bootstrap": SimpleNamespace(names=("b", "a"), std=np.array([0.5, 0.25])),
    }
    return SimpleNamespace(**(base | more))


def test_a_system_is_shown_with_the_costs_of_each_loop_and_both_deviations_by_name(tabled, capsys):
    error = SimpleNamespace(test="t", worst=lambda above: 1.5 if above else 7.5)
    identify_output.show_system(system(), _Shown(), [error], Path("s.yaml"), False)
    assert tabled["loops"][1] == [[1, 8.0, 10.0], [2, 2.0, 6.0]]
    assert tabled["uncertainty"][1] == [["a", 1.0, 0.25], ["b", 2.0, 0.5]]
    said = capsys.readouterr().out
    assert "act alike: K1 = C5" in said
    assert "not determined by these tests: K3; wrote s.yaml" in said
    identify_output.show_system(system(bootstrap=None, ties=[], unseen=[]), _Shown(), [error], Path("s.yaml"), True)
    content = json.loads(capsys.readouterr().out)
    assert content["errors_percent_of_nominal"] == {"t": {"above_250_rpm": 1.5, "below_250_rpm": 7.5}}
    assert content["loops"] == [{"number": 1, "cost": 8.0}, {"number": 2, "cost": 2.0}]
    assert (content["bootstrap_std"], content["tied"], content["not_determined"]) == ({}, [], [])


class _Shown:
    """A model of two parameters."""

    parameter_names = ("a", "b")
    parameters = tuple(SimpleNamespace(name=name, unit="N*m", doc=name) for name in "ab")
    values, std = (3.0, 4.0), np.array([1.0, 2.0])


# -- gap
def gap_content(**more):
    effect = {
        "name": "coulomb",
        "indistinguishable_from": ["notch"],
        "variant": "all groups, tau = 3",
        "law_kind": "literature",
        "parameters": {"T_zz": {"value": 12.0, "std": 0.5, "unit": "N*m"}},
        "evidence": {"cv_gain": 0.42, "p_value": 0.01, "selection_frequency": 0.9},
    }
    base = {
        "verdict": "missing_effect",
        "effects": [effect],
        "notes": ["said", "new"],
        "next_experiment": None,
        "adequacy": [],
        "gap": {"unit": "bar", "holdout": {"before": 2.5, "after": 0.5, "noise_floor": 0.25}},
    }
    return base | more


def test_the_terminal_says_the_effect_its_size_and_the_gap_before_and_after(tabled, capsys, tmp_path):
    (tmp_path / "gap.json").write_text("")
    gap_output.show_result(gap_content(), tmp_path, said=["said"])
    assert tabled["missing effects"][1] == [["coulomb (all groups)", "notch", "T_zz = 12 ± 0.5 N·m", "42 %"]]
    said = capsys.readouterr().out
    assert "verdict: missing_effect" in said
    assert "locked runs: 2.5 bar before, 0.5 bar after, noise floor 0.25 bar" in said
    assert "note: new" in said
    assert "note: said" not in said
    assert f"written: {tmp_path / 'gap.json'}\n" in said
    assert "next experiment" not in said


@pytest.mark.parametrize(
    ("more", "expected", "absent"),
    [
        ({"verdict": "ambiguous"}, "no scenario at hand tells these apart", "lacking"),
        (
            {"verdict": "ambiguous", "next_experiment": {"scenario": "s.yaml", "note": "dear"}},
            "next experiment: s.yaml (dear)",
            "no scenario",
        ),
        (
            {"verdict": "unexplained", "unexplained": {"depends_on": ["wire_out"], "reason": "why"}},
            "it depends on: wire_out (why)",
            "no effect is named",
        ),
        (
            {"verdict": "unexplained", "unexplained": {"depends_on": [], "reason": "why"}},
            "no effect is named: why",
            "depends",
        ),
        (
            {"gap": {"unit": "bar", "holdout": {"before": None, "after": None, "noise_floor": None}}},
            "verdict",
            "locked runs",
        ),
    ],
)
def test_the_terminal_says_what_is_open(more, expected, absent, tabled, capsys, tmp_path):
    gap_output.show_result(gap_content(effects=[], **more), tmp_path)
    said = capsys.readouterr().out
    assert expected in said
    assert absent not in said


def test_the_terminal_says_what_could_not_be_looked_for_once_for_each_reason(tabled, capsys, tmp_path):
    blind = [("entrained_air", "speed_reference", "lost flow"), ("wear_drift", "time", "clocks begin anew"),
             ("slip_leakage", "speed_reference", "lost flow")]  # fmt: skip
    untestable = [{"name": name, "needs": needs, "because": because} for name, needs, because in blind]
    gap_output.show_result(gap_content(effects=[], untestable=untestable), tmp_path)
    assert [line for line in capsys.readouterr().out.splitlines() if line.startswith("not looked for")] == [
        "not looked for: entrained_air, slip_leakage (needs speed_reference: lost flow)",
        "not looked for: wear_drift (needs time: clocks begin anew)",
    ]


@pytest.mark.parametrize(
    ("hidden", "verdict", "found", "right"),
    [
        ("nothing", "nothing_missing", [], True),
        ("nothing", "missing_effect", ["coulomb"], False),
        ("coulomb", "ambiguous", ["notch", "coulomb"], True),
        ("coulomb", "nothing_missing", [], False),
        ("coulomb", "missing_effect", ["notch"], False),
    ],
)
def test_a_blind_trial_is_right_where_it_names_what_was_hidden(hidden, verdict, found, right):
    assert gap_blind._right(hidden, verdict, found) is right


def test_what_is_drawn_for_a_blind_trial_is_half_to_twice_its_usual_size_and_sometimes_nothing():
    rng = np.random.default_rng(0)
    drawn = [gap_blind._draw(rng) for _ in range(600)]
    nothing = [each for each in drawn if each["effect"] == "nothing"]
    sizes = [each["size"] for each in drawn if each["effect"] != "nothing"]
    assert nothing
    assert {each["size"] for each in nothing} == {0.0}
    assert 0.5 <= min(sizes) < 0.55
    assert 1.9 < max(sizes) <= 2.0
    assert float(np.median(sizes)) == pytest.approx(1.0, abs=0.1)


# -- replay
def test_states_of_a_silent_compensator_stand_by_their_share():
    states = ["waiting"] * 6 + ["active"] * 3 + ["fault"]
    run = {"time": 0}
    said = replay._why_silent(states, run, None)
    assert "active in less than 50 % of the samples; its states: waiting 60 %, active 30 %, fault 10 %" in said
    assert "no speed_reference" in said
    assert "no speed_reference" not in replay._why_silent(states, {"speed_reference": 0}, None)
    measured = SimpleNamespace(phases=[SimpleNamespace(config=SimpleNamespace(velocity_source="measured"))])
    assert "no speed_reference" not in replay._why_silent(states, run, measured)
    assert "no speed_reference" not in replay._why_silent(states, None, None)


@pytest.mark.parametrize(
    ("given", "options"),
    [
        (([], "", "", ""), {}),
        (([], "winch_drum", "", ""), {"speed_joint": "winch_drum"}),
        (([], "winch_motor", "", "crane"), {"speed_joint": "winch_motor", "namespace": "crane"}),
        (
            ([], "hoist", "absolute", ""),
            {"speed_joint": "hoist", "motor_joint": "hoist", "pressure_reference": "absolute"},
        ),
        ((["a=/b", "c=/d=e"], "", "", ""), {"remap": {"a": "/b", "c": "/d=e"}}),
    ],
)
def test_options_of_a_bag_are_what_was_given(given, options):
    assert replay.bag_options(*given) == options


def test_a_topic_that_is_renamed_to_nothing_is_refused():
    with pytest.raises(InputError, match="--remap"):
        replay.bag_options(["a"], "", "", "")


def test_what_is_of_a_bag_alone_is_refused_for_a_run_file(tmp_path):
    file = tmp_path / "a.csv"
    file.write_text("time\n")
    with pytest.raises(InputError, match="--joint, --namespace: of a bag's topics alone"):
        replay._refuse_bag_options(file, {"remap": None, "joint": "j", "namespace": "n"})
    replay._refuse_bag_options(file, {"remap": None, "joint": ""})
    replay._refuse_bag_options(tmp_path, {"joint": "j"})


# -- other verbs
def test_a_benchs_row_says_against_what_it_was_measured():
    of = lambda **more: SimpleNamespace(
        **{
            "name": "n",
            "value": 12.3456,
            "unit": "ms",
            "against": "scipy",
            "other": 99.99,
            "ratio": 8.1,
            "spread": (7.0, 9.25),
            "goal": ">= 5",
            "met": True,
        }
        | more
    )
    assert bench._cells(of()) == ["n", "12.35", "ms", "scipy, 100 ms", "8.1", "7 ... 9.25", ">= 5", "yes"]
    assert bench._cells(of(other=None, ratio=None, spread=None, met=None))[3:] == ["scipy", "", "", ">= 5", ""]
    assert bench._cells(of(met=False))[-1] == "no"


def test_a_column_that_no_message_carries_is_told():
    run = Run(
        "r",
        {"time": np.arange(2.0), "motor_speed": np.zeros(2), "main.pressure_a": np.zeros(2), "drum_speed": np.zeros(2)},
        aside={"remark": np.zeros(2)},
    )
    assert "remark" in _without_topic(run)
    assert not {"time", "motor_speed", "main.pressure_a"} & set(_without_topic(run))


@pytest.mark.parametrize(
    ("statuses", "status"), [((0, 0), 0), ((), 0), ((0, 2), 2), ((2, 1, 0), 1), ((1,), 1), ((3, 2), 1)]
)
def test_a_fleets_status_is_that_of_the_gravest_outcome(statuses, status):
    assert _status([SimpleNamespace(status=each) for each in statuses]) == status


def test_options_of_a_fleet_are_passed_on_as_words():
    assert _flags(["holdout=0.3", "no-learn", "set=a=b"]) == ["--holdout", "0.3", "--no-learn", "--set", "a=b"]
    assert _storage_options(["key=a=b", "x=1"]) == {"key": "a=b", "x": "1"}
    with pytest.raises(InputError, match="--storage 'anon'"):
        _storage_options(["x=1", "anon"])


def test_an_effect_to_hide_has_its_usual_size_unless_one_is_given():
    assert _effect("brake_drag") == ("brake_drag", 1.0)
    assert _effect("brake_drag=0.5") == ("brake_drag", 0.5)
    assert _effect("brake_drag=10") == ("brake_drag", 10.0)
    for wrong in ("brake_drag=10.1", "brake_drag=nan", "brake_drag=much", "brake_drug"):
        with pytest.raises(InputError, match="--hide brake_dr"):
            _effect(wrong)


@pytest.mark.parametrize(
    ("run", "truth"), [("o/a.csv", "a_truth.csv"), ("o/a.parquet", "a_truth.parquet"), ("o/a.mcap", "a_truth.csv")]
)
def test_the_truth_of_a_run_lies_below_it_as_a_table(run, truth):
    assert _truth_of(Path(run)) == Path("o/truth") / truth


def test_a_table_for_a_pipe_has_a_line_per_row_and_json_no_infinity(monkeypatch, capsys):
    from winch_friction.cli import Modes

    monkeypatch.setattr(Modes, "plain", True)
    show_table("t", ("a", "b"), [(1.23456789, "two\nlines"), (7, None)])
    assert capsys.readouterr().out == "t\na\tb\n1.235\ttwo lines\n7\tNone\n"
    show_json({"a": float("nan"), "b": np.float64(2.0), "c": np.array([1.0, np.nan])})
    assert json.loads(capsys.readouterr().out) == {"a": None, "b": 2.0, "c": [1.0, None]}


def test_a_cell_is_shown_as_it_stands(capsys):
    """Colons were read as names of emoji: of a ratio 10:100:20 the hundred became a picture."""
    show_table("of:x:", ("t [s]",), [("10:100:20",), ("root:x:0",)])
    shown = capsys.readouterr().out
    assert all(each in shown for each in ("10:100:20", "root:x:0", "of:x:", "t [s]"))


# -- a page that listens
def test_a_reader_that_comes_late_begins_with_what_was_kept_and_hears_the_end():
    sent = Broadcast()
    for k in range(700):
        sent.send({"k": k, "v": float("nan")})
    sent.end("")
    first, last = sent.lines()
    frames = [json.loads(each.removeprefix("data: ")) for each in first.split("\n\n") if each]
    assert [frame["k"] for frame in frames] == list(range(100, 700))
    assert frames[0]["v"] is None
    assert last == "event: end\ndata: ended\n\n"
    said = Broadcast()
    said.end("the bag is at its end")
    assert list(said.lines())[-1] == "event: end\ndata: the bag is at its end\n\n"
    said.close()
    assert list(said.lines()) == []


def test_a_page_that_listens_for_days_keeps_ten_minutes():
    sent = Broadcast()
    for k in range(6001):
        sent.send({"k": k})
    assert len(sent._sent) == 3000
    assert json.loads(sent._sent[-1]) == {"k": 6000}


def test_a_page_finds_its_stream_beside_it_and_nothing_else_is_there():
    frames = ({"k": k, "status": {}} for k in (1, 2))
    with serving(frames, 0) as address, urlopen(address, timeout=10) as page:
        (stream,) = re.findall(r'EventSource\("(.*?)"\)', page.read().decode())
        with urlopen(urljoin(address, stream), timeout=10) as events:
            assert events.headers["Content-Type"] == "text/event-stream"
            said = re.findall(r"^data: ({.*})$", events.read().decode(), re.MULTILINE)
        with pytest.raises(HTTPError, match="404"):
            urlopen(urljoin(address, "other"), timeout=10)
    assert [json.loads(each)["k"] for each in said] == [1, 2]


# -- what is never replaced
@pytest.mark.parametrize(
    ("name", "folder", "overwrite", "said"),
    [
        ("a.html", False, False, "exists already; give another name, or --overwrite"),
        ("a.html", False, True, None),
        ("a.mcap", False, True, "a folder or bag is never replaced"),
        ("a.db3", False, True, "a folder or bag is never replaced"),
        ("bag", True, True, "a folder or bag is never replaced"),
    ],
)
def test_what_is_there_is_replaced_only_when_told_and_a_bag_never(name, folder, overwrite, said, tmp_path):
    place = tmp_path / name
    place.mkdir() if folder else place.write_text("")
    refuse_existing(overwrite, None, tmp_path / "new.html")
    if said is None:
        refuse_existing(overwrite, place)
        return
    with pytest.raises(InputError, match=said):
        refuse_existing(overwrite, tmp_path / "new.html", place)


def test_an_input_under_another_name_of_it_is_not_overwritten(tmp_path):
    (tmp_path / "a.csv").write_text("")
    (tmp_path / "b.csv").symlink_to(tmp_path / "a.csv")
    with pytest.raises(InputError, match="is an input and would be overwritten"):
        refuse_input_as_output(tmp_path / "b.csv", [None, "", tmp_path / "none.csv", tmp_path / "a.csv"])
    refuse_input_as_output(tmp_path / "c.csv", [tmp_path / "a.csv"])
    refuse_input_as_output(None, [tmp_path / "a.csv"])


@pytest.mark.parametrize(
    ("said", "overwrite", "refused"),
    [
        ("schema/1", True, None),
        ("schema/1", False, "holds an earlier result \\(mark.json\\)"),
        ("of somebody else", True, "holds mark.json, no result of this verb"),
    ],
)
def test_an_earlier_result_is_known_by_its_mark(said, overwrite, refused, tmp_path):
    (tmp_path / "mark.json").write_text(said)
    call = lambda: refuse_foreign(tmp_path, ("mark.json", "x_*.py"), "mark.json", "schema/", overwrite)
    if refused is None:
        call()
        return
    with pytest.raises(InputError, match=refused):
        call()


def test_a_copy_is_known_by_time_and_speed_and_exchanged_ports_are_named():
    time, speed = np.arange(3.0), np.array([1.0, 2.0, 3.0])
    a, b = np.array([5.0, 6.0, 7.0]), np.array([1.0, 1.0, 2.0])
    run = lambda name, speed, a, b: Run(
        name, {"time": time, "motor_speed": speed, "main.pressure_a": a, "main.pressure_b": b}
    )
    with pytest.raises(InputError, match="x and y hold the same samples: a copy proves nothing"):
        refuse_copies([run("x", speed, a, b), run("z", 2 * speed, a, b), run("y", speed, a, b)])
    with pytest.raises(InputError, match="same samples, ports A and B of main exchanged in one of them"):
        refuse_copies([run("x", speed, a, b), run("y", speed, b, a)])
    refuse_copies([run("x", speed, a, b), run("y", -speed, a, b)])


# -- ranges, settings, where a result comes from
def test_a_range_is_in_the_unit_that_it_is_given_in():
    assert identify._range("400-2500", 2.0, "speed") == (800.0, 5000.0)
    assert identify._range("0-1", 1e5, "pressure") == (0.0, 1e5)
    for wrong in ("2500-400", "5-5", "5", "1-2-3", "a-b"):
        with pytest.raises(InputError, match=f"--speed '{wrong}'"):
            identify._range(wrong, 1.0, "speed")


def test_options_of_identify_motor_reach_the_fit(monkeypatch, tmp_path):
    """Speeds in rad/s, pressures in Pa, displacements in m³/rad; what is not asked for is the motor's usual."""
    from winch_friction.cli.main import run
    from winch_friction.identification import motor_identification
    from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM

    asked = {}

    def work(data, names, **options):
        asked.update(options, names=names, data=data)
        raise InputError("enough")

    monkeypatch.setattr(motor_identification, "identify_motor", work)
    words = ["identify", "motor", "a6vm215_generated", "--out", str(tmp_path / "m.yaml"), "--no-complex", "--seed", "7"]
    more = [
        "--speed",
        "500-2000",
        "--displacement",
        "60-200",
        "--restarts",
        "2",
        "--evaluations",
        "400",
        "--use",
        "mj6",
    ]
    assert run([*words, *more, "--max-displacement", "230", "--weighting", "equal"]) == 2
    inside = asked["fit_range"]
    assert inside.speed == pytest.approx((500 * RPM, 2000 * RPM))
    assert inside.pressure == pytest.approx((50 * BAR, 350 * BAR))
    assert inside.displacement == pytest.approx((60 * CM3_PER_REV, 200 * CM3_PER_REV))
    assert asked["data"].max_displacement == pytest.approx(230 * CM3_PER_REV)
    assert (asked["names"], asked["chosen"], asked["seed"], asked["with_complex"]) == (["mj6"], "mj6", 7, False)
    assert (asked["weighting"], asked["complex_options"]) == ("equal", {"restarts": 2, "max_evaluations": 400})


def logged(step, **metadata):
    return Run("r.csv", {"time": step * np.arange(20.0), "motor_speed": np.zeros(20)}, metadata=metadata)


@pytest.mark.parametrize(("rate", "changed"), [(100.0, False), (10.0, True)])
def test_a_slow_log_gets_age_limits_that_it_can_meet_and_is_told(rate, changed, capsys):
    found = replay._settings_for(Path("r.csv"), logged(1.0 / rate), None)
    said = capsys.readouterr().err
    assert (found is not None) is changed
    assert ("logged at 10 Hz" in said) is changed
    if changed:
        assert [phase.config.max_age for phase in found.phases] == pytest.approx([2.5 / rate] * len(found.phases))


def test_a_users_own_age_limits_are_only_questioned(capsys):
    from winch_friction.replay.settings import ReplaySettings

    own = ReplaySettings()
    assert replay._settings_for(Path("r.csv"), logged(0.1), own) is own
    assert "as --params-file says: raise max_age there" in capsys.readouterr().err
    assert replay._settings_for(Path("r.csv"), None, own) is own
    with pytest.raises(InputError, match="column 'time': a sample every 100 s is too slow"):
        replay._settings_for(Path("r.csv"), logged(100.0), None)


def test_where_a_result_comes_from_holds_a_hash_of_every_file_and_of_a_bags_files_in_order(tmp_path, monkeypatch):
    import hashlib
    import sys

    bag = tmp_path / "bag"
    bag.mkdir()
    (bag / "b.mcap").write_bytes(b"22")
    (bag / "a.yaml").write_bytes(b"1")
    (tmp_path / "r.csv").write_bytes(b"abc")
    monkeypatch.setattr(sys, "argv", ["anything", "gap", "my runs", "--seed", "0"])
    known = provenance.provenance_of([tmp_path / "r.csv", bag], "crane", "model", 0)
    assert known["command"] == "winch-friction gap 'my runs' --seed 0"
    assert (known["crane"], known["model"], known["seed"]) == ("crane", "model", 0)
    assert known["files"] == [
        {"name": "r.csv", "sha256": hashlib.sha256(b"abc").hexdigest()},
        {"name": "bag", "sha256": hashlib.sha256(b"122").hexdigest()},
    ]


# -- a fleet over the months
def test_a_fleet_says_who_changed_in_which_month_and_unit(tmp_path, monkeypatch, capsys):
    from winch_friction.cli import fleet
    from winch_friction.fleet import drift
    from winch_friction.fleet.ledger import Outcome

    seen = []
    monkeypatch.setattr(
        drift, "find_steps", lambda series: seen.extend(series) or [drift.Step("north", "friction", 24290, 8.0, 0.001)]
    )
    monkeypatch.setattr(drift, "find_unlike", lambda series: [drift.Unlike("south", "constant_torque", 40.0, 2.0, 9.0)])
    row = {"recording": "a", "time": 1.7e9, "name": "friction", "value": 3.0, "std": 0.5, "unit": "%"}
    of = lambda traits, *learned: Outcome(
        "k", "north", "a", 0, 1.0, {"traits": traits, "verb": {"parameters": learned}}, ""
    )
    learned = {"parameter": "C3", "learned": 2.0, "sigma": 0.5, "unit": "N*m"}
    found = fleet._over_time([of([row], learned), of([{**row, "value": 5.0}])], tmp_path)
    assert [(each.crane, each.trait, each.values.tolist()) for each in seen] == [("north", "friction", [4.0])]
    assert found["steps"] == [
        {"crane": "north", "trait": "friction", "month": "2024-03", "size": 8.0, "p_value": 0.001, "unit": "%"}
    ]
    assert (found["unlike"][0]["unit"], found["notes"]) == ("N*m", [])
    undated = fleet._over_time([of([{**row, "time": 5.0}])], tmp_path / "none")
    assert undated["notes"] == ["no recording has a Unix time: nothing can be followed over the months"]
    assert fleet._over_time([of([])], tmp_path / "none")["notes"] == []
    rows = {}
    monkeypatch.setattr(
        fleet,
        "show_table",
        lambda title, columns, given: rows.update({title: dict(zip(columns, given[0], strict=True))}),
    )
    fleet._show_changes(found | {"notes": ["a note"]})
    assert rows["changed"] == {
        "crane": "north",
        "what": "friction",
        "month": "2024-03",
        "size": 8.0,
        "unit": "%",
        "p": 0.001,
    }
    assert rows["unlike the others"]["level"] == 40.0
    assert rows["unlike the others"]["fleet"] == 2.0
    assert capsys.readouterr().out == "a note\n"


# -- a simulation of one's own
def test_an_own_simulation_is_asked_for_every_run_and_told_what_is_which_column(monkeypatch):
    monkeypatch.setattr(fmu, "load_fmu_map", lambda path: f"links of {path}")
    monkeypatch.setattr(fmu, "simulate_fmu", lambda path, links, run: (str(path), links, run))
    runs = ["first", "second", "third"]
    found = gap._simulated(runs, Path("own.fmu"), Path("own.yaml"))
    assert found == [("own.fmu", "links of own.yaml", run) for run in runs]
    assert gap._simulated(runs, None, None) == runs
    for half in ((Path("own.fmu"), None), (None, Path("own.yaml"))):
        with pytest.raises(InputError, match="belong together"):
            gap._simulated(runs, *half)


def test_whoever_names_no_model_of_another_crane_is_told_which_are_shipped_for_it(tmp_path):
    with pytest.raises(InputError, match=r"which model of crane 'emps'.*shipped for it: emps_symmetric, emps_viscous"):
        gap._usual_model("emps", [])
    own = tmp_path / "own.yaml"
    own.write_text(shipped("cranes", "crane_150t").read_text().replace("name: crane_150t", "name: nord", 1))
    with pytest.raises(InputError, match=r"which model of crane 'nord'.*`winch-friction init model` writes one"):
        gap._usual_model(str(own), [])
