"""What a model and a run say of themselves, what settings refuse and what is kept: small numbers, worked by hand."""

import math
import os
import sys
from dataclasses import dataclass, replace

import numpy as np
import pytest
from own_term_files import forgotten

from winch_friction.physics.effects import effect_text, effect_texts
from winch_friction.physics.errors import (
    InputError,
    Problems,
    check,
    counted,
    from_mapping,
    meant,
    option,
    unknown_key,
)
from winch_friction.physics.frames import html_table, library, model_frame
from winch_friction.physics.friction import FrictionModel, Scope, Term, register, sources, term_named
from winch_friction.physics.friction.model import SAME, contradictions
from winch_friction.physics.friction.scaled import scaled_system
from winch_friction.physics.friction.symbols import p
from winch_friction.physics.friction.term import Parameter
from winch_friction.physics.signals import Run, cut_off, ends_of_range


def model(*names, covariance=None, **more):
    terms = tuple(map(term_named, names or ("coulomb", "stribeck", "churning")))
    own = {each.name: each for term in terms for each in term.parameters}
    return FrictionModel("m", terms, tuple(each.typical for each in own.values()), covariance, **more)


# -- models
def test_a_part_of_a_model_keeps_its_own_values_and_covariance():
    whole = model(covariance=np.diag([1.0, 4e-12, 9.0, 16.0, 25.0, 0.01]))  # C2; C1, C3, C4; T_ch, n_ch
    mixed = whole.covariance.copy()
    mixed[4, 5] = mixed[5, 4] = 0.2
    part = replace(whole, covariance=mixed).subset(["churning", "coulomb"])
    assert part.term_names == ("coulomb", "churning")  # in the model's order
    assert part.as_dict() == {"C2": 5.0, "T_ch": 2.5, "n_ch": 1.9}
    np.testing.assert_allclose(part.covariance, [[1.0, 0.0, 0.0], [0.0, 25.0, 0.2], [0.0, 0.2, 0.01]])
    assert part.std == pytest.approx([1.0, 5.0, 0.1])
    assert whole.only("motor").term_names == ("churning",)


@pytest.mark.parametrize(
    ("covariance", "said"),
    [
        (np.eye(3), r"covariance is \(3, 3\), expected \(1, 1\)"),
        (np.array([[math.nan]]), "not finite and symmetric"),
    ],
)
def test_a_covariance_of_one_parameter_is_one_number(covariance, said):
    with pytest.raises(InputError, match=said):
        model("coulomb", covariance=covariance)


@pytest.mark.parametrize(
    ("correlation", "mirror", "said"),
    [(0.9, 0.9, None), (1.0, 1.0, None), (1.01, 1.01, "not positive semi-definite"), (0.5, 0.4, "and symmetric"),
     (-1.01, -1.01, "not positive semi-definite")],
)  # fmt: skip
def test_two_parameters_vary_together_at_most_wholly(correlation, mirror, said):
    """By their correlation: of variances that lie ten decades apart as well."""
    small, large = 1e-6, 30.0
    given = np.array([[small**2, correlation * small * large], [mirror * small * large, large**2]])
    if said is None:
        assert model("coulomb", "viscous", covariance=given).std == pytest.approx([small, large])
    else:
        with pytest.raises(InputError, match=said):
            model("coulomb", "viscous", covariance=given)


@pytest.mark.parametrize(("value", "taken"), [(0.0, True), (200.0, True), (-1e-9, False), (200.1, False)])
def test_a_value_may_be_at_its_bounds(value, taken):
    if taken:
        assert model("coulomb").with_values({"C2": value}).value("C2") == value
    else:
        with pytest.raises(InputError, match=r"parameter C2 = .* is outside 0 \.\.\. 200"):
            model("coulomb").with_values([value])


@pytest.mark.parametrize(("off", "same"), [(0.0, True), (5e-4, True), (-5e-4, True), (2e-3, False), (-2e-3, False)])
def test_a_gear_ratio_is_the_cranes_to_three_digits(off, same, crane_150t):
    own = model("coulomb", constants={"gear_ratio": crane_150t.gear_ratio * (1.0 + off)})
    assert (contradictions(own, crane_150t) == []) is same
    assert SAME == 1e-3


def test_a_winch_that_is_harder_to_turn_is_so_in_gear_and_drum_alone():
    own = model("coulomb", "stribeck", "churning", "viscosity_temperature", "torque_offset", bounds={"C2": (4.0, 6.0)})
    harder = scaled_system(own, 3.0)
    told = {"C2": 3.0, "C1": 3.0, "C3": 3.0, "C4": 1.0, "T_ch": 1.0, "n_ch": 1.0, "K_v": 1.0, "T_0": 1.0}
    assert harder.as_dict() == pytest.approx({name: own.value(name) * times for name, times in told.items()})
    assert (harder.name, harder.bounds) == ("m_x3", {})


def test_a_frame_has_each_parameters_own_term_bounds_and_sigma():
    frame = model_frame(model("coulomb", "churning", covariance=np.diag([4.0, 9.0, 0.25]), bounds={"C2": (1.0, 6.0)}))
    assert frame.loc["C2"].tolist() == [5.0, 2.0, "N*m", 1.0, 6.0, "coulomb", "Coulomb friction"]
    assert frame.loc["n_ch"].tolist() == [1.9, 0.5, "1", 1.2, 3.5, "churning", "exponent of churning"]
    assert frame.columns.tolist() == ["value", "std", "unit", "lower", "upper", "term", "meaning"]
    assert math.isnan(model_frame(model("coulomb")).loc["C2", "std"])


def test_a_table_of_a_notebook_is_escaped_and_of_four_digits():
    told = html_table("a < b", ("<x>", "y"), [("<b>", 1.23456), (7, float("nan"))])
    assert "<strong>a &lt; b</strong>" in told
    assert "<th>&lt;x&gt;</th><th>y</th>" in told
    assert "<tr><td>&lt;b&gt;</td><td>1.235</td></tr><tr><td>7</td><td>nan</td></tr>" in told


def test_a_library_that_is_not_there_is_named_with_what_installs_it():
    with pytest.raises(InputError, match=r"'no_such_library' is not installed: pip install 'winch_friction\[desk\]'"):
        library("no_such_library", "desk")


@pytest.mark.parametrize(
    ("name", "extra", "asked"),
    [("pandas", "desk", lambda: model_frame(model("coulomb"))), ("pandas", "desk", lambda: RUN.to_frame()),
     ("xarray", "xarray", lambda: RUN.to_xarray())],
)  # fmt: skip
def test_a_table_is_asked_of_the_extra_that_has_its_library(name, extra, asked, monkeypatch):
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(InputError, match=rf"'{name}' is not installed: pip install 'winch_friction\[{extra}\]'"):
        asked()


# -- runs
RUN = Run(
    "r",
    {
        "time": np.array([1.0, 2.0, 4.0]), "motor_speed": np.array([3.0, np.nan, -5.0]), "b.pressure_a": np.ones(3),
        "a.pressure_b": np.full(3, np.nan), "b.displacement": np.full(3, 2e-5), "c.noise": np.zeros(3),
    },
)  # fmt: skip


def test_a_run_has_its_groups_in_the_order_of_their_columns():
    assert RUN.groups == ("b", "a")  # of the channels that a group has
    assert np.isnan(RUN.column("hook_load")).tolist() == [True] * 3
    assert RUN.column("hook_load", 5.0).tolist() == [5.0] * 3
    assert RUN.units["b.displacement"] == "m^3/rad"
    assert RUN.units["c.noise"] == "1"
    assert repr(RUN).startswith("Run 'r': 3 samples, 1 ... 4 s, columns time, motor_speed, b.pressure_a")


def test_a_run_tells_the_least_the_largest_and_how_many_are_missing():
    told = RUN._repr_html_()
    assert "<td>motor_speed</td><td>rad/s</td><td>-5</td><td>3</td><td>1</td>" in told
    assert "a.pressure_b" not in told  # nothing of it is known


def test_a_runs_samples_have_its_columns_by_name():
    first, _, last = RUN.samples()
    assert (first.time, first.motor_speed, last.time, last.motor_speed) == (1.0, 3.0, 4.0, -5.0)
    assert (first.groups["b"].pressure_a, first.groups["b"].displacement) == (1.0, 2e-5)
    assert math.isnan(first.groups["a"].pressure_b)
    assert list(first.groups) == ["b", "a"]
    assert math.isnan(first.hook_load)


def test_a_run_of_unequal_columns_is_none():
    with pytest.raises(InputError, match="r: columns differ in length: {'time': 2, 'motor_speed': 3}"):
        Run("r", {"time": np.zeros(2), "motor_speed": np.zeros(3)})


def heave(limit, periods=8, per=40):
    """A sine that a sensor's range cuts off above `limit` of its height."""
    return np.minimum(np.sin(2.0 * np.pi * np.arange(periods * per + 17) / per + 0.1), limit)


@pytest.mark.parametrize(
    ("values", "ends"),
    [
        (heave(0.6), (0.6,)), (heave(2.0), ()), (heave(0.6, periods=2), ()),  # twice may be a crest
        (np.maximum(heave(0.75), -0.8), (-0.8, 0.75)),
        (heave(0.95), ()), (heave(0.93), (0.93,)),  # of four samples each, and of five
        (np.round(heave(2.0), 1), ()),  # a coarse digit rests on every crest
        (np.where(np.arange(337) % 5 == 0, np.nan, heave(2.0)), ()), (np.full(50, np.nan), ()),
        (np.maximum(heave(2.0), 0.0), ()),  # at zero a winch stands
        (heave(-0.2), ()),  # more than half of it at the end is a plateau
    ],
)  # fmt: skip
def test_an_end_of_a_range_is_where_a_channel_is_cut_off_again_and_again(values, ends):
    assert ends_of_range(values) == ends


def test_what_is_cut_off_is_what_stays_at_an_end():
    values = np.array([0.0, 7.0, 7.0, 7.0, 7.0, 0.0, 7.0, 7.0, 7.0, 7.0, 7.0, 1.0])
    assert np.flatnonzero(cut_off(values, (7.0,))).tolist() == [6, 7, 8, 9, 10]
    assert not cut_off(values, ()).any()


# -- words
def test_an_effect_of_a_users_own_has_its_declarations_words():
    k = Parameter("k_own", "m^3/rad", 1e-7)
    for doc, said in (("Grease.", "Grease."), ("", "The term 'own_term' as declared (a test).")):
        with forgotten("own_term"):
            register(Term("own_term", k.symbol * p, (k,), Scope.MOTOR, "a test", "motor", doc=doc))
            told = effect_text("own_term")
            assert (told.title, told.physics, told.size) == ("own term", said, "")
    assert effect_text("no_such_effect").physics == "'no_such_effect' has no description."
    assert effect_text("stribeck") is effect_texts()["stribeck"]


@pytest.mark.parametrize(
    ("name", "said"),
    [("Gear_Ratio", " did you mean gear_ratio?"), ("gear_ratoi", " did you mean gear_ratio?"), ("moon", ""),
     ("LEVEL", " did you mean LEVEL or level?")],
)  # fmt: skip
def test_capitals_make_no_other_name(name, said):
    assert meant(name, ["gear_ratio", "inertia", "level", "LEVEL"]) == said


def test_an_unknown_key_is_answered_by_what_is_meant_else_by_all():
    assert unknown_key("inertai", ["inertia", "mass"]) == "unknown key 'inertai'; did you mean inertia?"
    assert unknown_key("moon", ["inertia", "mass"]) == "unknown key 'moon'; known keys are inertia, mass"
    assert [counted(n, "cell is", "cells are") for n in (0, 1, 2)] == ["0 cells are", "1 cell is", "2 cells are"]


def test_problems_are_gathered_once_each_in_their_order():
    problems = Problems()
    for said in (("b", "a"), ("a",), ("c",)):
        with problems:
            raise InputError(*said)
    assert problems.found == ["b", "a", "c"]
    with pytest.raises(InputError, match=r"^b \| a \| c$"):
        problems.say()
    with pytest.raises(KeyError), problems:
        raise KeyError("not a problem of the input")
    assert InputError("two\n  lines").problems == ("two lines",)


# -- settings
@dataclass(frozen=True)
class Settings:
    lag: float = option(0.5, lower=0.0, upper=2.0, unit="s")
    load: float = option(math.nan, lower=0.0, unit="kg", may_be_nan=True)
    count: int = option(3, lower=1, upper=9)
    mode: str = option("off", choices=("off", "on"))
    loud: bool = option(False)
    ages: dict = option({"hook": 2.0}, lower=0.0, upper=60.0, unit="s")

    def __post_init__(self):
        check(self)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"lag": 2.1}, "s: lag must be 0 ... 2 s, found 2.1"),
        ({"lag": -0.1}, "s: lag must be 0 ... 2 s, found -0.1"),
        ({"lag": math.nan}, "s: lag must be 0 ... 2 s, found nan"),
        ({"lag": True}, "s: lag must be a number, found True"),
        ({"lag": "late"}, "s: lag must be a number, found 'late'"),
        ({"load": -1.0}, "s: load must be 0 ... inf kg, found -1"),
        ({"count": 10}, "s: count must be 1 ... 9, found 10"),
        ({"count": 0}, "s: count must be 1 ... 9, found 0"),
        ({"count": 2.0}, "s: count must be of type int, found 2.0"),
        ({"count": True}, "s: count must be of type int, found True"),
        ({"mode": "half"}, "s: mode must be one of off, on, found 'half'"),
        ({"loud": 1}, "s: loud must be of type bool, found 1"),
        ({"ages": {"hook": 61.0}}, "s: ages.hook must be 0 ... 60 s, found 61"),
        ({"ages": {"hook": "old"}}, "s: ages.hook must be a number, found 'old'"),
        ({"ages": {"hook": True}}, "s: ages.hook must be a number, found True"),
        ({"ages": 3.0}, "s: ages must be a mapping, found 3.0"),
        ({"lags": 1.0}, "s: unknown key 'lags'; did you mean lag"),
        ({"lag": 3.0, "mode": "half"}, "s: lag must be 0 ... 2 s, found 3 | s: mode must be one of off, on, found 'h"),
        ([1], "s: expected a mapping of keys, found [1]"),
    ],
)  # fmt: skip
def test_a_setting_that_cannot_be_is_refused_by_name(given, said):
    with pytest.raises(InputError) as refused:
        from_mapping(Settings, given, "s")
    assert str(refused.value).startswith(said)


def test_settings_take_what_can_be_and_keep_what_is_not_said():
    made = from_mapping(Settings, {"lag": "1e-3", "count": 9, "mode": "on", "ages": {"oil": 30}}, "s")
    assert (made.lag, made.count, made.mode, made.loud) == (1e-3, 9, "on", False)
    assert made.ages == {"hook": 2.0, "oil": 30.0}
    assert math.isnan(made.load)
    assert from_mapping(Settings, {"lag": 2}, "s").lag == 2.0
    assert Settings().ages is not Settings().ages


# -- what is kept
def test_of_a_full_folder_the_oldest_half_goes(tmp_path, monkeypatch):
    monkeypatch.setattr(sources, "MOST_FILES", 3)
    for age, name in enumerate(("d", "a", "c", "b")):
        (tmp_path / name).write_text("")
        os.utime(tmp_path / name, (1000.0 + age, 1000.0 + age))
    sources._make_room.cache_clear()
    sources._make_room(tmp_path)
    assert sorted(each.name for each in tmp_path.iterdir()) == ["b", "c"]
    sources._make_room.cache_clear()
    sources._make_room(tmp_path)
    assert len(list(tmp_path.iterdir())) == 2
    sources._make_room.cache_clear()
