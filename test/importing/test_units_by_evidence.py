"""Units that a log does not say, settled by sizes and balances that answer as they are told."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.importing import unit_guess
from winch_friction.importing.draft import Draft
from winch_friction.importing.log import Log, LogColumn
from winch_friction.importing.mapping import Entry, LogMap
from winch_friction.importing.unit_guess import (
    _by_balance,
    _closing,
    _of_crane,
    _options,
    _set_unit,
    _undecided,
    _usual_in,
    settle_units,
)
from winch_friction.physics.channels import CM3_PER_REV

MEMBERS = {"pressures": ["main.pressure_a", "main.pressure_b"], "hook_load": ["hook_load"]}


def log_of(name="log.csv", **columns):
    return Log(Path(name), tuple(LogColumn(each, np.full(20, value)) for each, value in columns.items()), {}, str)


def draft(crane=None, logs=(), **columns):
    return Draft(list(logs), crane, LogMap({name.replace("__", "."): entry for name, entry in columns.items()}))


def evidence(monkeypatch, worth):
    """What the balance says of each choice: the product of its units' worths; and what it was asked."""
    asked = []

    def closing(draft, units):
        asked.append(dict(units))
        return float(np.prod([worth.get(unit, 1.0) for unit in dict.fromkeys(units.values())]))

    monkeypatch.setattr(unit_guess, "_closing", closing)
    return asked


# -- the balance
@pytest.mark.parametrize(
    ("worth", "chosen"),
    [({}, ("bar", "t")), ({"bar": 0.5}, ("psi", "t")), ({"bar": 0.65}, ("bar", "t")), ({"bar": 0.6}, ("bar", "t")),
     ({"t": 0.1}, ("bar", "kg")),
     ({"bar": 0.1, "psi": 0.1, "t": 0.3}, ("kPa", "kg"))],
)  # fmt: skip
def test_each_rarer_unit_must_fit_better_by_its_rank(worth, chosen, monkeypatch):
    asked = evidence(monkeypatch, worth)
    axes = {"pressures": ["bar", "psi", "kPa"], "hook_load": ["t", "kg"]}
    assert tuple(_by_balance(draft(), axes, MEMBERS).values()) == chosen
    assert len(asked) == 6
    assert asked[0] == {"main.pressure_a": "bar", "main.pressure_b": "bar", "hook_load": "t"}


def test_not_more_than_a_few_hundred_choices_are_tried(monkeypatch):
    asked = evidence(monkeypatch, {})
    units = [f"u{k}" for k in range(40)]
    _by_balance(draft(), {"pressures": units, "hook_load": units}, MEMBERS)
    assert 100 <= len(asked) <= 1000


@pytest.mark.parametrize(("psi", "undecided"), [(0.2, False), (0.5, True), (0.8, True)])
def test_a_unit_is_open_where_another_fits_nearly_as_well_beside_the_rest_as_chosen(psi, undecided, monkeypatch):
    asked = evidence(monkeypatch, {"psi": psi})
    chosen = {"pressures": "bar", "hook_load": "kg"}
    assert _undecided(draft(), chosen, "pressures", ["bar", "psi"], MEMBERS) == undecided
    assert [each["hook_load"] for each in asked] == ["kg", "kg"]
    assert asked[1]["main.pressure_b"] == "psi"


def closed_by(monkeypatch, mismatch=None, ratio=None, gain=None):
    given = []

    def convert(log, trial, crane, strict):
        given.append((log, {name: each.unit for name, each in trial.columns.items()}, strict))
        return SimpleNamespace(columns=log)

    pick = lambda value, log: value[log] if isinstance(value, dict) else value
    as_field = lambda name, number: None if number is None else SimpleNamespace(**{name: number})
    monkeypatch.setattr(unit_guess, "convert", convert)
    monkeypatch.setattr(unit_guess, "closure", lambda log, crane: as_field("mismatch", pick(mismatch, log)))
    monkeypatch.setattr(unit_guess, "rope_over_motor", lambda log, crane: as_field("value", pick(ratio, log)))
    monkeypatch.setattr(unit_guess, "power_ratio", lambda log, crane: pick(gain, log))
    return given


@pytest.mark.parametrize(
    ("said", "off"),
    [
        ({}, 0.0), ({"mismatch": 1.5}, 1.5**2), ({"mismatch": 99.0}, 30.0**2),
        ({"ratio": 1.2}, (np.log(1.2) / 0.3) ** 2),
        ({"ratio": -1.2}, (np.log(1.2) / 0.3) ** 2), ({"ratio": 1.0, "mismatch": 2.0}, 4.0), ({"ratio": 1e9}, 400.0),
        ({"ratio": 1.2, "mismatch": 2.0}, 4.0 + (np.log(1.2) / 0.3) ** 2),
        ({"gain": 1.1, "mismatch": 9.0, "ratio": 3.0}, (np.log(1.1) / 0.3) ** 2),
    ],
)  # fmt: skip
def test_evidence_falls_with_what_does_not_close_and_what_a_power_says_goes_before(said, off, monkeypatch):
    closed_by(monkeypatch, **said)
    assert _closing(draft(crane="crane", logs=["one"]), {}) == pytest.approx(np.exp(-0.5 * off) + 1e-12)


def test_evidence_is_the_mean_of_the_first_logs_with_the_units_that_are_tried(monkeypatch):
    given = closed_by(monkeypatch, mismatch={"a": 0.0, "b": 2.0, "c": 0.0, "d": 2.0, "e": 0.0})
    own = draft("crane", ["a", "b", "c", "d", "e"], hook_load=Entry("m", "kg"), wire_out=Entry("L", "m"))
    assert _closing(own, {"hook_load": "t"}) == pytest.approx(0.5 + 0.5 * np.exp(-2.0))
    assert given == [(log, {"hook_load": "t", "wire_out": "m"}, False) for log in "abcd"]
    assert _closing(draft(None, ["a"]), {}) == 1.0


# -- the sizes
def match(channel, unit="", column="x"):
    return SimpleNamespace(slot=SimpleNamespace(channel=channel), unit=unit, column=SimpleNamespace(name=column))


def test_a_unit_that_gives_no_usual_size_is_asked_about_with_what_would(monkeypatch):
    usual = ("MPa", "psi", "degF")
    monkeypatch.setattr(unit_guess, "plausible_units", lambda column, unit, *_: [unit] if unit in usual else [])
    evidence(monkeypatch, {"MPa": 0.2})
    own = draft()
    assert _options(own, "main.pressure_a", match("pressure_a", "bar"), log_of(x=-7.0)) == ["bar"]
    (said,) = own.questions
    assert said.startswith("main.pressure_a: 'x' says 'bar', but 7 bar is no usual size (")
    assert said.endswith("; 'psi' would give a usual size: set main.pressure_a.unit=psi")
    own = draft()
    assert _options(own, "oil_temperature", match("oil_temperature", "degC"), log_of(x=120.0)) == ["degC"]
    assert own.questions[0].endswith("; 'degF' would give a usual size: set oil_temperature.unit=degF")
    own = draft()
    _options(own, "hook_load", match("hook_load", "t"), log_of(x=9e9))
    assert "would give" not in own.questions[0]


def test_a_channel_by_its_own_name_is_in_si_and_another_in_what_is_usual(monkeypatch):
    monkeypatch.setattr(unit_guess, "plausible_units", lambda *_: ["rpm", "rad/s"])
    both = log_of(motor_speed=9.0, n=9.0)
    assert _options(draft(), "motor_speed", match("motor_speed", column="motor_speed"), both) == ["rad/s"]
    assert _options(draft(), "motor_speed", match("motor_speed", column="n"), both) == ["rpm", "rad/s"]
    monkeypatch.setattr(unit_guess, "plausible_units", lambda *_: [])
    assert _options(draft(), "motor_speed", match("motor_speed", column="n"), both) == []


def test_a_usual_size_in_another_unit_counts_from_its_zero(crane_150t):
    low, high = (float(each) for each in _usual_in("oil_temperature", "degC", None).split(" deg")[0].split(" to "))
    fahrenheit = _usual_in("oil_temperature", "degF", None)
    assert fahrenheit == f"{low * 1.8 + 32.0:.3g} to {high * 1.8 + 32.0:.3g} degF"
    share = _usual_in("displacement", "%", crane_150t)
    own = _usual_in("displacement", "cm^3/rev", crane_150t)
    shares, sizes = ([float(each) for each in text.split(" ")[::2][:2]] for text in (share, own))
    assert shares == pytest.approx([each / 2.15 for each in sizes], rel=0.02)


def test_what_a_crane_has_is_said_of_what_it_sets(crane_150t):
    assert "'crane_150t' has motors of 215 cm^3/rev" in _of_crane(draft(crane_150t), "displacement")
    assert f"has {len(crane_150t.drum.layer_radii)} layers" in _of_crane(draft(crane_150t), "wire_layer")
    assert _of_crane(draft(crane_150t), "hook_load") == _of_crane(draft(), "displacement") == ""
    assert crane_150t.max_displacement == pytest.approx(215.0 * CM3_PER_REV)


@pytest.mark.parametrize(("name", "unit"), [("wire_layer", ""), ("main.displacement", "-")])
def test_a_bare_number_is_written_so_where_a_unit_could_stand(name, unit):
    own = draft(**{name.replace(".", "__"): Entry("x", confidence=0.8)})
    _set_unit(own, name, ["-"], None)
    assert own.log_map.columns[name].unit == unit


# -- all together
def settled(monkeypatch, options, worth=(), **columns):
    monkeypatch.setattr(unit_guess, "_options", lambda draft, name, match, pooled: list(options[name]))
    evidence(monkeypatch, dict(worth))
    own = draft("crane", [log_of(p=1.0)], **columns)
    settle_units(own, {name: match(name.rpartition(".")[2]) for name in options}, None)
    return own


PRESSURES = {"main__pressure_a": Entry("a", confidence=1.0), "main__pressure_b": Entry("b", confidence=1.0)}


def test_pressures_of_all_ports_have_one_unit_that_fits_them_all(monkeypatch):
    units = lambda own: [own.log_map.columns[name].unit for name in ("main.pressure_a", "main.pressure_b")]
    own = settled(monkeypatch, {"main.pressure_a": ["bar", "psi"], "main.pressure_b": ["psi"]}, **PRESSURES)
    assert (units(own), own.questions) == (["psi", "psi"], [])
    own = settled(monkeypatch, {"main.pressure_a": ["bar"], "main.pressure_b": ["psi"]}, **PRESSURES)
    assert units(own) == ["bar", "bar"]
    assert own.log_map.columns["main.pressure_a"].confidence == pytest.approx(0.95)


def test_what_the_balance_does_not_tell_is_asked_once_for_all_ports(monkeypatch):
    both = {"main.pressure_a": ["bar", "psi"], "main.pressure_b": ["bar", "psi"]}
    told = settled(monkeypatch, both, {"psi": 0.2}, **PRESSURES)
    assert (told.questions, told.log_map.columns["main.pressure_b"].unit) == ([], "bar")
    open_ = settled(monkeypatch, both, {"psi": 0.5}, **PRESSURES)
    assert open_.questions == [
        "main.pressure_a: 'a' says no unit, and the log does not tell bar from psi; set main.pressure_a.unit"
    ]
    assert open_.log_map.columns["main.pressure_b"].unit == ""
    warm = settled(monkeypatch, {"oil_temperature": ["degC", "kelvin"]}, oil_temperature=Entry("T", confidence=1.0))
    assert (warm.questions, warm.log_map.columns["oil_temperature"].unit) == ([], "degC")  # moves no torque


@pytest.mark.parametrize(
    "name", ["motor_speed", "drum_speed", "main.displacement", "hook_load", "rope_force", "mechanical_power"]
)
def test_a_unit_that_moves_torque_or_speed_is_asked_where_the_log_does_not_tell_it(name, monkeypatch):
    own = settled(monkeypatch, {name: ["x", "y"]}, {"y": 0.5}, **{name.replace(".", "__"): Entry("c", confidence=1.0)})
    assert own.questions == [f"{name}: 'c' says no unit, and the log does not tell x from y; set {name}.unit"]


def test_a_unit_that_may_mean_several_is_left_to_who_asks_for_it(monkeypatch):
    own = draft("crane", [], hook_load=Entry("m", "ton"))
    monkeypatch.setattr(unit_guess, "_options", lambda *_: pytest.fail("asked"))
    settle_units(own, {"hook_load": match("hook_load", "ton")}, None)
    assert own.log_map.columns["hook_load"].unit == "ton"
