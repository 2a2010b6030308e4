"""Effects that block means of the torque balance cannot show: ripple over the angle, lost speed, warm gas."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from campaign.rig import make_dataset
from winch_friction.discrepancy.adequacy import long_enough, of_records
from winch_friction.discrepancy.catalogue import all_candidates
from winch_friction.discrepancy.detectors import flow_balance
from winch_friction.discrepancy.detectors.flow_balance import free_air, holds_on, is_air, leak_untestable, lost_speed
from winch_friction.discrepancy.detectors.lost_flow import FEWEST_TO_FLIP, ORDINARY
from winch_friction.discrepancy.detectors.ripple import (
    COMB_LINES,
    COMB_SHARE,
    SAME_ORDER,
    TERM,
    Ripple,
    _known,
    angle_ripple,
    one_of_a_comb,
)
from winch_friction.discrepancy.preparation.prepare import prepare
from winch_friction.physics.fluid import LEAKAGE_LAWS, leakage_per_coefficient
from winch_friction.physics.friction import FrictionModel, term_named
from winch_friction.physics.signals import Run
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model


@cache
def _prepared(flavour, *effects):
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    runs = [Run(f"run_{k}", columns) for k, columns in enumerate(make_dataset(17, flavour, effects))]
    return runs, [prepare(run, crane, model) for run in runs], crane, model


@pytest.mark.parametrize("flavour", ["paper", "rough"])
def test_a_ripple_is_found_at_its_order_and_nothing_where_there_is_none(flavour):
    found = angle_ripple(*_prepared(flavour, ("torque_ripple", 1.0)))
    assert found.found
    assert min(abs(found.order - order) for order in (1.0, 0.2, 2.0, 1 / 6)) < 0.02
    assert not angle_ripple(*_prepared(flavour)).found


def test_lost_speed_gives_the_leakage():
    runs, prepared, *_ = _prepared("slow_log", ("slip_leakage", 1.0))
    found = lost_speed(runs, prepared)
    truth = 50 * 2 * np.pi / 60 * 215e-6 / (2 * np.pi) / 150e5  # 50 rpm at 150 bar and 40 degC
    assert found.found
    assert list(found.leakage) == ["slip_leakage"]
    assert found.leakage["slip_leakage"][0] == pytest.approx(truth, rel=0.02)
    assert found.gain > 0.9


@pytest.mark.parametrize(("law", "name"), [("orifice", "orifice_leakage"), ("gap_opens", "opening_gap_leakage")])
def test_a_leak_has_its_own_law_and_is_no_air(law, name):
    runs, prepared, *_ = _prepared("slow_log", (f"slip_leakage:{law}", 1.0))
    found = lost_speed(runs, prepared)
    truth = 50 * 2 * np.pi / 60 * 215e-6 / (2 * np.pi) / 150e5
    assert found.found
    assert list(found.leakage) == [name]
    assert found.leakage[name][0] == pytest.approx(truth, rel=0.02)
    assert found.gain > 0.9
    assert holds_on(found, runs[:4], prepared[:4])
    assert [each.name for each in found.corrections] == [name]
    air = free_air(runs, prepared)
    assert air is None or not is_air(air)


@pytest.mark.parametrize(("second", "laws"), [
    (1e-11, ["orifice_leakage", "slip_leakage"]), (0.0, ["slip_leakage"]), (-2e-12, ["slip_leakage"]),
])  # fmt: skip
def test_a_second_law_of_leakage_counts_where_other_runs_need_it_and_it_leaks_outwards(monkeypatch, second, laws):
    rng = np.random.default_rng(3)
    run, drop, thin = np.repeat(np.arange(6.0), 20), rng.uniform(10e5, 200e5, 120), rng.uniform(0.5, 2.0, 120)
    rates = [leakage_per_coefficient(law, drop, thin) / 3e-5 for law in LEAKAGE_LAWS]
    lost = 1e-11 * rates[0] + second * rates[1] + 0.02 * rng.standard_normal(120)
    table = np.column_stack([run, lost, rng.uniform(-80.0, 80.0, 120), np.zeros(120), *rates])
    monkeypatch.setattr(flow_balance, "stretches", lambda *_: table)
    found = lost_speed([], [SimpleNamespace(constants=(("max_displacement", 3e-5),))])
    assert sorted(found.leakage) == laws


def test_a_small_motor_loses_as_much_speed_by_a_smaller_leak():
    runs, prepared, *_ = _prepared("slow_log", ("slip_leakage", 1.0))
    small = [
        replace(
            run, constants=tuple((k, v / 8 if k == "max_displacement" else v) for k, v in run.constants),
            groups=tuple(replace(group, displacement=group.displacement / 8) for group in run.groups),
        )
        for run in prepared
    ]  # fmt: skip
    found, whole = lost_speed(runs, small), lost_speed(runs, prepared)
    assert found.found
    assert found.slip == pytest.approx(whole.slip, rel=1e-6)
    assert found.leakage["slip_leakage"][0] == pytest.approx(whole.leakage["slip_leakage"][0] / 8, rel=1e-6)


def test_no_speed_is_lost_where_the_controller_knows_its_leakage():
    runs, prepared, *_ = _prepared("rough")
    found = lost_speed(runs, prepared)
    assert abs(found.slip) < 0.05 * ORDINARY
    assert not found.found


@pytest.mark.parametrize(("effects", "leaks"), [((("slip_leakage", 1.0),), True), ((), False)])
def test_a_leak_shows_without_plateaus_where_the_speed_follows_its_command(effects, leaks, monkeypatch):
    runs, prepared, *_ = _prepared("slow_log", *effects)
    whole = lost_speed(runs, prepared)
    monkeypatch.setattr(flow_balance, "STEADY_COMMAND", 0.0)
    found = lost_speed(runs, prepared)
    assert found.change == flow_balance.SLOW_COMMAND
    assert len(found.beside) == 2  # the speed's scale and its lag
    assert found.found is leaks
    if leaks:
        assert holds_on(found, runs[:4], prepared[:4])
        assert found.slip == pytest.approx(whole.slip, rel=0.1)
    assert leak_untestable(runs, prepared) == []


def test_a_command_that_never_rests_is_said_to_hide_a_leak(monkeypatch):
    runs, prepared, *_ = _prepared("slow_log", ("slip_leakage", 1.0))
    for name in ("STEADY_COMMAND", "SLOW_COMMAND"):
        monkeypatch.setattr(flow_balance, name, 0.0)
    assert lost_speed(runs, prepared) is None
    (said,) = leak_untestable(runs, prepared)
    assert said.name == "slip_leakage"
    assert "there are 0" in said.because


def test_without_a_command_there_is_nothing_to_compare():
    runs, prepared, *_ = _prepared("no_reference")
    assert lost_speed(runs, prepared) is None


def test_warm_gas_leaves_the_trace_that_its_candidate_expects():
    _, null, *_ = _prepared("si_files")
    _, warm, *_ = _prepared("si_files", ("accumulator_thermal", 1.0))
    candidate = next(each for each in all_candidates() if each.name == "accumulator_thermal")
    k = 8
    both = null[k].used & warm[k].used
    trace = (warm[k].gap - null[k].gap)[both]
    left = []
    for shape in candidate.shapes(warm):
        columns = candidate.columns(warm[k], shape.values)[both]
        beta, *_ = np.linalg.lstsq(columns, trace, rcond=None)
        left.append(np.var(trace - columns @ beta) / np.mean(trace**2))
    assert min(left) < 0.05


def test_a_line_among_many_is_the_sampling_s_comb_and_no_ripple():
    """Encoder steps at 166 Hz beat with the sampling at many orders alike; a ripple has an order, and harmonics."""
    orders = np.linspace(0.1, 20.0, 4000)

    def power(*lines):
        found = np.full(len(orders), 9.0)
        for order, height in lines:
            found[np.argmin(abs(orders - order))] = height
        return found

    comb = power((17.26, 57.6), (12.41, 54.9), (18.63, 54.9), (5.35, 54.2), (19.98, 51.5))
    assert one_of_a_comb(orders, comb, int(np.argmax(comb)), 9)
    alone = power((2.0, 57.6), (4.0, 57.0), (6.0, 56.0), (8.0, 55.0), (6.78, 24.0), (11.98, 23.7), (8.64, 20.4))
    assert not one_of_a_comb(orders, alone, int(np.argmax(alone)), 9)
    two = power((2.0, 57.6), (7.3, 57.0), (11.9, 24.0))  # a shaft may have two
    assert not one_of_a_comb(orders, two, int(np.argmax(two)), 9)
    strong = power(*((order, 108.0) for order in (0.17, 0.39, 1.31, 7.4, 11.9)))
    assert not one_of_a_comb(orders, strong, int(np.argmax(strong)), 9)


@pytest.mark.parametrize("seed", range(6))
def test_a_comb_is_counted_one_line_after_the_other(seed):
    """Against the definition: from the strongest on, each line that is no harmonic of those counted before."""
    random = np.random.default_rng(seed)
    orders = np.linspace(0.1, 20.0, 3000)
    power = random.exponential(size=orders.size) + 40.0 * np.isin(
        np.arange(orders.size), random.integers(0, 3000, seed)
    )
    best = int(np.argmax(power))
    strong = np.flatnonzero(power >= COMB_SHARE * power[best])
    seen = [orders[best]]
    for order in orders[strong[np.argsort(-power[strong])]]:
        ratios = [max(order, each) / min(order, each) for each in seen]
        if all(abs(ratio - round(ratio)) > SAME_ORDER for ratio in ratios):
            seen.append(order)
    assert one_of_a_comb(orders, power, best, 9) == (len(seen) > COMB_LINES)


@pytest.mark.parametrize(("order", "p_value", "found"), [
    (9.01, 1e-11, True), (0.165, 1e-18, True), (0.764, 7e-14, False), (13.2, 1e-11, False), (13.2, 1e-20, True),
    (1.0, 1e-4, False), (0.02, 1e-11, True),
])  # fmt: skip
def test_a_line_between_whole_orders_must_be_surer(order, p_value, found):
    """Nothing on the shaft has 13.2 periods a turn nor 0.764; an encoder that beats with the sampling may."""
    assert Ripple(order, 0.01, 1e-4, p_value, 100.0).found is found


@pytest.mark.parametrize(
    ("order", "amplitude", "known"), [(2.0, 0.6, True), (2.0, 0.9, False), (1.03, 0.6, False), (2.05, 0.6, True)]
)
def test_what_one_amplitude_leaves_of_a_known_ripple_is_no_second_one(order, amplitude, known):
    """Pressure lines and the sampling take more of it the faster the shaft turns: slow runs keep more than the model's
    amplitude, fast ones less. One that grew, or of another order, is seen."""
    crane_model = load_model("a6vm215_crane2")
    size = {"a_r": 0.004, "b_r": 0.003, "k_r": 2.0}
    rippled = FrictionModel(
        "rippled", (*crane_model.terms, term_named(TERM)), (*crane_model.values, *size.values()),
    )  # fmt: skip
    found = Ripple(order, amplitude * 0.005, 1e-5, 1e-20, 8.0)
    assert found.found
    assert _known(found, rippled) is known
    assert not _known(found, crane_model)


@pytest.mark.parametrize(("leak", "holds"), [(5.0, True), (0.3, False)])
def test_on_few_locked_stretches_a_leak_makes_each_plainly_better(leak, holds, monkeypatch):
    """Five signs that agree are one chance in 32: no significance, but a lost speed of 5 rad/s needs none."""
    runs, prepared, *_ = _prepared("slow_log", ("slip_leakage", 1.0))
    found = lost_speed(runs, prepared)
    tables = flow_balance.stretches
    some = tables(runs, prepared, found.change)[:4]
    some[:, 1] *= leak / np.abs(some[:, 1]).max()
    assert len(some) < FEWEST_TO_FLIP
    monkeypatch.setattr(flow_balance, "stretches", lambda *_: some)
    assert holds_on(found, runs, prepared) is holds
    monkeypatch.setattr(flow_balance, "stretches", lambda *_: some[:1])
    assert not holds_on(found, runs, prepared)  # one stretch is nothing


@pytest.mark.parametrize(("period", "kept"), [(0.201, True), (0.21, False)])
def test_a_log_of_five_hertz_by_a_clock_that_drifts_is_one(period, kept):
    time = np.arange(0.0, 60.0, period)
    run = Run("slow", {"time": time, "motor_speed": 50.0 * np.sin(time)})
    assert ([own.name for own in long_enough([run])[0]] == ["slow"]) is kept
    assert all(check.met for check in of_records([run], [run])) is kept
