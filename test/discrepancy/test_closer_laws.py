"""Constants of a proposed law between those of the grid: thresholds between levels, humps, sectors and waves."""

from types import SimpleNamespace

import numpy as np
import pytest
from test_grammar import AT, DEPTH, DIRECTION, RUN, RUNS, TORQUE, grammar

from winch_friction.discrepancy import closer_laws, waves
from winch_friction.discrepancy.closer_laws import between_levels, closer, fitted, side_by_side
from winch_friction.discrepancy.engine.grammar import Factor, Law, Scored
from winch_friction.discrepancy.vocabulary import BY_NAME, shape

RNG = np.random.default_rng(4)


def thresholds(name, *levels, spread=0.0, samples=50):
    parts = [level + spread * RNG.uniform(-1.0, 1.0, samples) for level in levels]
    return sorted({dict(each.constants)["c"] for each in between_levels(BY_NAME[name], parts)})


def test_thresholds_lie_in_the_middle_between_the_levels_of_the_runs():
    """0.8 of the greatest displacement lay between 31.8 and 36.4 cm3 of two runs, and all tenths of the samples in
    one."""
    assert thresholds("displacement", 2e-5, 3e-5, 3e-5, 4e-5) == pytest.approx([2.5e-5, 3.5e-5])
    kinds = {each.kind for each in between_levels(BY_NAME["displacement"], [np.ones(9), 2.0 * np.ones(9)])}
    assert kinds == {"step", "above", "below"}
    assert {each.kind for each in between_levels(BY_NAME["pressure"], [np.ones(9), 2.0 * np.ones(9)])} == {
        "step",
        "above",
    }


def test_a_run_that_went_over_others_levels_has_none_between_these():
    parts = [np.full(50, 10.0), np.linspace(5.0, 60.0, 50), np.full(50, 40.0), np.full(50, 90.0)]
    found = {dict(each.constants)["c"] for each in between_levels(BY_NAME["wire_out"], parts)}
    assert list(found) == pytest.approx([0.5 * (90.0 + np.quantile(parts[1], 0.95))], rel=1e-3)


def test_runs_that_were_set_alike_are_one_level():
    assert thresholds("displacement", 2e-5, 2.0001e-5, 3e-5) == pytest.approx([2.5e-5], rel=1e-3)


@pytest.mark.parametrize(("spread", "there"), [(0.5, True), (2.4, False)])
def test_of_a_signal_that_moves_within_the_runs_there_are_no_levels(spread, there):
    assert bool(thresholds("wire_out", 100.0, 104.0, spread=spread)) is there


def test_layers_are_counted_and_one_run_has_no_threshold():
    assert not thresholds("wire_layer", 1.0, 2.0)
    assert not thresholds("displacement", 2e-5)


def test_humps_stand_as_far_apart_as_they_are_wide():
    found = [dict(each.constants) for each in side_by_side(BY_NAME["motor_speed"], np.linspace(0.0, 200.0, 50))]
    for width in (10.0, 24.0, 60.0):
        places = [each["c"] for each in found if each["h"] == width]
        assert np.diff([0.0, *places]) == pytest.approx(width)
        assert 200.0 - width <= places[-1] < 200.0
    assert {each.signal for each in side_by_side(BY_NAME["wire_out"], np.linspace(0.0, 200.0, 50))} == {"wire_out"}
    assert not list(side_by_side(BY_NAME["pressure"], np.linspace(0.0, 2e7, 50)))
    assert not list(side_by_side(BY_NAME["motor_speed"], np.empty(0)))


def test_of_what_stayed_the_same_there_is_no_hump():
    """An oil temperature that a map gives as a constant: humps of no width, and a division by it."""
    assert not list(side_by_side(BY_NAME["oil_temperature"], np.full(50, 40.0)))
    assert not list(side_by_side(BY_NAME["oil_temperature"], 40.0 + 1e-9 * np.arange(50)))


# -- waves
def wave_of(x, factor):
    return shape("wave", x, dict(factor.constants), 0.1)


@pytest.mark.parametrize("period", [2.3, 9.0, 13.7])
def test_a_wave_is_found_to_a_thousandth_by_runs_at_many_depths(period):
    late = 0.3 * period
    groove = 4.0 * (1.0 + np.sin(2.0 * np.pi * (DEPTH - late) / period)) / 2.0
    noise = 0.5 * RNG.standard_normal(len(AT))
    found = waves.waves(grammar(TORQUE * DIRECTION * (groove + noise + RUN)), "wire_out", DEPTH)
    assert len(found) == waves.PEAKS
    best = min(found, key=lambda each: abs(dict(each.constants)["c"] - period))
    assert dict(best.constants)["c"] == pytest.approx(period, rel=2e-3)
    assert np.corrcoef(wave_of(DEPTH, best), groove)[0, 1] > 0.99


def test_what_comes_once_over_all_wire_that_came_and_went_is_no_wave():
    """All runs over the same 16 m: a period of more than a half of that is any curve over it."""
    x = 8.0 * np.sin(AT / 9.0)
    found = waves.waves(grammar(TORQUE * DIRECTION * x), "wire_out", x)
    assert found
    assert max(dict(each.constants)["c"] for each in found) <= 8.5


def test_of_a_wire_that_hardly_moves_no_wave_is_asked():
    assert waves.waves(grammar(TORQUE * DIRECTION), "wire_out", 100.0 + 0.5 * np.sin(AT / 9.0)) == []


def test_of_a_kilometre_that_is_paid_out_at_once_no_more_periods_are_asked_than_a_memory_holds(monkeypatch):
    asked = []
    search = grammar(TORQUE * DIRECTION)
    periodic = search.periodic
    search.periodic = lambda x, f, apart: asked.append(len(f)) or periodic(x, f, apart)
    waves.waves(search, "wire_out", np.linspace(0.0, 6000.0, len(AT)))
    assert asked[0] <= waves.MOST


@pytest.mark.parametrize("times", [1.0, 2.0])
def test_a_drum_that_is_not_round_is_a_wave_over_its_turning(times):
    angle = 5.0 * np.sin(AT / 9.0)
    found = waves.turns(grammar(TORQUE * DIRECTION * (1.0 + np.sin(times * angle - 1.0))), angle)
    assert [dict(each.constants)["c"] for each in found] == pytest.approx([2.0 * np.pi, np.pi], rel=1e-5)
    fits = [np.corrcoef(wave_of(angle, each), np.sin(times * angle - 1.0))[0, 1] for each in found]
    assert np.argmax(fits) == times - 1
    assert max(fits) > 0.999
    assert waves.turns(grammar(TORQUE * DIRECTION), 0.2 * angle) == []


@pytest.mark.parametrize(("sine", "cosine", "late"), [(1.0, -0.0, 10.0), (1.0, -1e-3, 10.002), (-1.0, 1e-3, 5.0)])
def test_a_phase_has_room_to_be_fitted_in(sine, cosine, late):
    """A parameter may become twenty times its size: of 3 mm of 9 m none but 6 cm."""
    told = SimpleNamespace(periodic=lambda *_, **__: (np.ones(1), np.array([sine]), np.array([cosine])))
    wave = dict(waves._best_wave(told, "wire_out", None, np.array([0.1])).constants)
    assert wave["c"] == 10.0
    assert wave["h"] == pytest.approx(late, abs=2e-3)


# -- the fit
def fit(monkeypatch, x, law, gap):
    """The law fitted to a gap where each factor reads the same signal."""
    asked = []

    def evaluated(factors, runs, most):
        asked.append(factors)
        return {each: shape(each.kind, x, dict(each.constants), 0.1)[None] for each in factors}

    monkeypatch.setattr(closer_laws, "evaluated", evaluated)
    search = grammar(TORQUE * DIRECTION * gap)
    first = search.screened(law, evaluated(law.factors, (), 1))
    moved, values = fitted(search, first, (), 1)
    assert list(values) == list(moved.law.factors)
    assert moved.loss >= moved.inside
    return moved, asked


@pytest.mark.parametrize(("begun", "true"), [(0.9583, 1.0), (0.0417, 0.085)])
def test_the_two_ends_of_a_sector_are_moved_together(monkeypatch, begun, true):
    """One after the other they stayed where the grid had the first: three quarters of the effect was left where a drum
    only turned to and fro about that end."""
    angle = 2.0 * np.pi * (AT / 97.0 + 0.1 * np.sin(AT / 5.0))
    sector = shape("sector", angle, {"c": true, "h": 0.3}, 0.1)
    law = Law((Factor("sector", "drum_angle", (("c", begun), ("h", 0.3))),), opposing=True)
    moved, _ = fit(monkeypatch, angle, law, 18.0 * sector)
    at = dict(moved.law.factors[0].constants)
    assert at["c"] == pytest.approx(true, abs=0.012)
    assert at["c"] + at["h"] == pytest.approx(true + 0.3, abs=0.012)


def test_a_fit_that_finds_no_end_is_ended(monkeypatch):
    monkeypatch.setattr(closer_laws, "evaluated", lambda *_: {})
    tried = []

    def better(law, _):
        tried.append(law)
        return Scored(law, 1.0, 1e6 * 0.9 ** len(tried), np.inf, np.zeros(0))

    law = Law((Factor("hump", "motor_speed", (("c", 80.0), ("h", 20.0))),), opposing=True)
    found, _ = fitted(SimpleNamespace(screened=better, judged=lambda best, _: best), better(law, {}), (), 1)
    assert 60 < len(tried) <= 2 * closer_laws.STEPS + 3
    assert found.law == tried[-1]


@pytest.mark.parametrize(("kind", "signal", "begun", "true"), [
    ("hump", "motor_speed", {"c": 80.0, "h": 20.0}, {"c": 90.0, "h": 12.0}),
    ("wave", "wire_out", {"c": 9.03, "h": 3.0}, {"c": 9.0, "h": 2.2}),
    ("above", "wire_out", {"c": 60.0}, {"c": 71.3}),
    ("fade", "motor_speed", {"c": 20.0}, {"c": 31.0}),
])  # fmt: skip
def test_constants_are_moved_to_the_fit_whatever_their_size(monkeypatch, kind, signal, begun, true):
    x = 100.0 * (1.0 + np.sin(AT / 9.0)) / 2.0
    law = Law((Factor(kind, signal, tuple(begun.items())),), opposing=True)
    moved, _ = fit(monkeypatch, x, law, shape(kind, x, true, 0.1))
    at = dict(moved.law.factors[0].constants)
    assert {name: at[name] for name in true} == {name: pytest.approx(value, rel=0.02) for name, value in true.items()}


def test_no_constant_of_a_fit_becomes_nothing(monkeypatch):
    """What grows from 5 m above the drum on fits best with a threshold below zero, which no law has."""
    x = 10.0 + 90.0 * (1.0 + np.sin(AT / 9.0)) / 2.0
    law = Law((Factor("above", "wire_out", (("c", 2.0),)),), opposing=True)
    moved, _ = fit(monkeypatch, x, law, x + 5.0)
    assert 0.0 < dict(moved.law.factors[0].constants)["c"] < 0.5


@pytest.mark.parametrize("beyond", [-5.0, 90.0])
@pytest.mark.parametrize("name", ["oil_temperature", "motor_speed"])
def test_no_hump_stands_where_nobody_has_been(monkeypatch, name, beyond):
    """Friction that falls with the oil's temperature over 24 to 60 degC was "around 0.146 degC"."""
    x = 42.0 + 18.0 * np.sin(AT / 9.0)
    monkeypatch.setattr(closer_laws, "covered", lambda word, runs: x if word.name == name else None)
    law = Law((Factor("hump", name, (("c", 30.0), ("h", 10.0))),), opposing=True)
    moved, _ = fit(monkeypatch, x, law, np.exp(-(((x - beyond) / 25.0) ** 2) / 2.0))
    assert x.min() <= dict(moved.law.factors[0].constants)["c"] <= x.max()


def test_of_what_is_counted_and_of_what_has_no_constant_nothing_is_moved(monkeypatch):
    x = 1.0 + AT % 4
    count = Law((Factor("about", "wire_layer", (("c", 1.0),)),), opposing=True)
    assert fit(monkeypatch, x, count, x - 1.4)[0].law == count
    plain = Law((Factor("linear", "wire_out"),), opposing=True)
    assert fit(monkeypatch, x, plain, x)[0].law == plain


# -- all of them
def run(depth, displacement, speed):
    at = np.arange(400)
    speed = speed * np.sin(at / 20.0)
    return SimpleNamespace(
        name="a", speed=speed, used=np.abs(speed) > 1.0, time=0.05 * at, dt=0.05, angle=np.cumsum(speed) * 0.05,
        gear_ratio=5.0, groups=[SimpleNamespace(displacement=np.full(400, displacement), pressure=1e7 + at, count=2)],
        channels={"wire_out": depth + 8.0 * np.sin(at / 20.0)}, drum_torque=at, acceleration=at,
    )  # fmt: skip


def test_closer_factors_are_of_what_all_runs_have(monkeypatch):
    runs = [run(70.0 * k, (2.0 + k) * 1e-5, 100.0 + k) for k in range(RUNS)]
    monkeypatch.setattr(
        closer_laws, "evaluated",
        lambda wanted, *_: {each: (DEPTH if each.signal == "wire_out" else DEPTH / 2.0)[None] for each in wanted},
    )  # fmt: skip
    found = list(closer(grammar(TORQUE * DIRECTION * np.sin(DEPTH)), runs, 1))
    kinds = {(each.signal, each.kind) for each in found}
    assert {
        ("wire_out", "hump"),
        ("run_time", "grow"),
        ("displacement", "step"),
        ("motor_speed", "hump"),
        ("wire_out", "wave"),
        ("drum_angle", "wave"),
    } <= kinds
    assert ("oil_temperature", "step") not in kinds
    places = {dict(each.constants)["c"] for each in found if (each.signal, each.kind) == ("displacement", "step")}
    assert sorted(places) == pytest.approx([(2.5 + k) * 1e-5 for k in range(RUNS - 1)])
    del runs[0].channels["wire_out"]
    assert "wire_out" not in {each.signal for each in closer(grammar(TORQUE * DIRECTION), runs, 1)}
