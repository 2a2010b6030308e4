"""What leaks and what air takes, from rows of lost speed that are drawn: laws, sizes and entries by figures."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.detectors import flow_balance, lost_flow, ripple, ripple_waves
from winch_friction.discrepancy.detectors.lost_flow import FreeAir, Leakage, leakage_of
from winch_friction.discrepancy.detectors.ripple import Ripple
from winch_friction.physics.fluid import LEAKAGE_LAWS, REFERENCE_PRESSURE, air_compressed
from winch_friction.physics.signals import Run

RUNS, ROWS = 5, 12
FULL = 3e-5  # m^3/rad


def table(leaks, scale=0.0, lag=0.0, noise=0.01, seed=1, rows=ROWS):
    """Rows of stretches that lose speed by these leakages, by an error of the speed's scale and a lag."""
    rng = np.random.default_rng(seed)
    size = RUNS * rows
    drop, speed, moved = rng.uniform(2e6, 2.5e7, size), rng.uniform(-80.0, 80.0, size), rng.uniform(-9.0, 9.0, size)
    warmth = rng.uniform(0.5, 2.0, size)
    rates = np.column_stack([law(drop, warmth) for law in LEAKAGE_LAWS.values()]) / FULL
    lost = scale * speed + lag * moved + noise * rng.standard_normal(size)
    for law, size_of in leaks.items():
        lost = lost + size_of * rates[:, list(LEAKAGE_LAWS).index(law)]
    return np.column_stack([np.repeat(np.arange(RUNS), rows), lost, speed, moved, rates])


@pytest.mark.parametrize("law", LEAKAGE_LAWS)
@pytest.mark.parametrize(("change", "lag"), [(lost_flow.STEADY_COMMAND, 0.0), (30.0, 0.05)])
def test_a_leak_is_found_by_its_own_law_and_size_beside_scale_and_lag(law, change, lag):
    """12 cm^3/s at 150 bar through a motor of 30 cm^3/rad cost 6 rad/s."""
    found = leakage_of(table({law: 1.2e-11}, 0.02, lag), change, FULL)
    ((name, (size, std)),) = found.leakage.items()
    assert name == law
    assert abs(size - 1.2e-11) < 4.0 * std < 1e-12
    assert found.slip == pytest.approx(1.2e-11 * REFERENCE_PRESSURE / FULL, rel=0.02)
    assert found.slip_std == pytest.approx(std * REFERENCE_PRESSURE / FULL)
    assert found.beside == pytest.approx([0.02, lag][: 1 + (lag > 0.0)], abs=3e-3)
    assert found.change == change
    assert found.found
    assert found.after == pytest.approx(0.01, rel=0.3)
    assert found.gain == pytest.approx(1.0 - found.after / found.before)
    assert found.explains(table({law: 1.2e-11}, 0.02, lag, seed=2))
    assert not found.explains(table({}, 0.02, lag, seed=2))
    assert not found.explains(table({})[:0])


def test_two_laws_are_named_where_other_runs_need_both():
    found = leakage_of(table({"slip_leakage": 1e-11, "orifice_leakage": 1e-11}), lost_flow.STEADY_COMMAND, FULL)
    assert {name: size for name, (size, _) in found.leakage.items()} == {
        "slip_leakage": pytest.approx(1e-11, rel=0.05), "orifice_leakage": pytest.approx(1e-11, rel=0.05),
    }  # fmt: skip
    assert found.slip == pytest.approx(2e-11 * REFERENCE_PRESSURE / FULL, rel=0.02)
    assert found.effect.law_name in ("slip_leakage + orifice_leakage", "orifice_leakage + slip_leakage")
    assert set(found.parameters) == {"C_leak", "C_orifice"}


LEAK = Leakage({"slip_leakage": (9e-12, 2e-13)}, 4.0, 0.2, 1e-3, 5.0, 1.0)


@pytest.mark.parametrize(
    ("more", "found"),
    [
        ({}, True),
        ({"slip": 3.1}, False),  # three deviations off what is ordinary
        ({"slip": 3.3}, True),
        ({"slip_std": 0.5}, False),
        ({"p_value": 0.02}, False),
        ({"after": 3.6}, False),  # 28 % of what is lost
        ({"after": 3.4}, True),
    ],
)
def test_a_leak_is_one_where_it_is_surely_more_than_ordinary_and_most_of_what_is_lost(more, found):
    assert replace(LEAK, **more).found is found


def test_what_leaks_and_what_air_takes_are_written_with_their_deviations():
    air = FreeAir(2e-3, 1e-4, 0.01, 4.0, 3.0)
    assert (air.gain, LEAK.gain) == pytest.approx((0.25, 0.8))
    assert replace(air, before=0.0).gain == replace(LEAK, before=0.0).gain == 0.0
    for own, name, unit, size, std in (
        (LEAK, "slip_leakage", "m^3/s/Pa", 9e-12, 2e-13), (air, "entrained_air", "m^3", 2e-3, 1e-4),
    ):  # fmt: skip
        (estimate,), (correction,) = own.effect.parameters.values(), own.corrections
        assert (own.effect.name, own.effect.rivals, estimate.unit) == (name, (), unit)
        assert (estimate.value, estimate.std) == (correction.value, correction.std) == (size, std)
        assert correction.name == name
        assert (own.effect.p_value, own.effect.gain) == (own.p_value, own.gain)


def test_a_fit_has_the_deviations_of_least_squares_whatever_its_columns_units():
    rng = np.random.default_rng(3)
    x = rng.standard_normal((40, 2)) * [1.0, 1e9]
    y = x @ [2.0, 3e-9] + rng.standard_normal(40)
    beta, covariance = lost_flow._fit(x, y)
    own, square, *_ = np.linalg.lstsq(x, y, rcond=None)
    np.testing.assert_allclose(beta, own, rtol=1e-6)
    np.testing.assert_allclose(covariance, square[0] / 38.0 * np.linalg.inv(x.T @ x), rtol=1e-6)


def test_what_a_run_keeps_is_foretold_by_the_others():
    x, run = np.ones((6, 1)), np.repeat([3.0, 5.0, 7.0], 2)
    left = lost_flow._held_out(x, np.array([1.0, 1.0, 2.0, 2.0, 6.0, 6.0]), run)
    assert left == pytest.approx([1.0 - 4.0] * 2 + [2.0 - 3.5] * 2 + [6.0 - 1.5] * 2)


# -- air
def test_a_runs_volume_is_that_of_least_squares_over_its_segments_and_the_runs_mean_is_weighted():
    sums = np.array([[0, 6.0, 2.0, 0, 0], [0, 5.0, 2.0, 0, 0]])
    volume, variance = flow_balance._estimate(sums)
    assert volume == pytest.approx(11.0 / 4.0)
    assert variance == pytest.approx((0.5**2 + 0.5**2) / 16.0)
    mean, std = flow_balance._common(np.array([[1.0, 4.0], [3.0, 1.0]]))
    assert mean == pytest.approx((0.25 * 1.0 + 3.0) / 1.25)
    spread = 0.25 * (1.0 - 2.6) ** 2 + (3.0 - 2.6) ** 2
    assert std == pytest.approx(np.sqrt(max(spread, 1.0) / 1.25))
    apart = flow_balance._common(np.array([[0.0, 1.0], [6.0, 1.0]]))
    assert apart == pytest.approx((3.0, np.sqrt(18.0 / 2.0)))  # they differ by more than each says of itself


def test_what_a_volume_takes_off_is_most_at_the_volume_of_least_squares():
    """|lost - V air|^2 is that much less than |lost|^2."""
    rng = np.random.default_rng(2)
    air, lost = rng.standard_normal(30), rng.standard_normal(30)
    sums = np.array([[0.0, air @ lost, air @ air, lost @ lost, 30.0]])
    for volume in (0.4, -0.3):
        taken = lost @ lost - ((lost - volume * air) ** 2).sum()
        assert flow_balance._gains(sums, volume) == pytest.approx([taken])
    best = flow_balance._estimate(sums)[0]
    gains = [flow_balance._gains(sums, v)[0] for v in (0.9 * best, best, 1.1 * best)]
    assert gains[1] == max(gains)


@pytest.mark.parametrize(
    ("steps", "pieces"),
    [
        ([(0.0, 30.0)], [(0.0, 30.0)]),
        ([(0.0, 30.0), (30.4, 60.0)], [(0.0, 60.0)]),  # two lost rows are no hole
        ([(0.0, 30.0), (31.0, 40.0), (41.0, 70.0)], [(0.0, 30.0), (41.0, 70.0)]),  # the middle is too short
        ([(0.0, 19.0)], []),
    ],
)
def test_a_record_is_looked_at_in_the_long_pieces_between_its_holes(steps, pieces):
    time = np.concatenate([np.arange(10.0 * begin, 10.0 * end + 0.5) / 10.0 for begin, end in steps])
    found = [time[own] for own in flow_balance._pieces(SimpleNamespace(time=time))]
    assert [pytest.approx((own[0], own[-1])) for own in found] == pieces


AIR = FreeAir(7e-3, 1e-3, 1e-3, 1.0, 0.9)


@pytest.mark.parametrize(
    ("more", "is_one"),
    [
        ({}, True), ({"volume": 5.9e-3}, False), ({"volume": -7e-3}, False), ({"after": 0.98}, False),
        ({"after": 0.96}, True), ({"p_value": 0.03}, False), ({"before": 0.0}, False),
    ],
)  # fmt: skip
def test_air_is_one_where_it_is_surely_there_and_explains_something(more, is_one):
    assert flow_balance.is_air(replace(AIR, **more)) is is_one


@pytest.mark.parametrize(("times", "told"), [(0.9, []), (1.1, ["entrained_air"])])
def test_runs_could_not_have_shown_air_where_a_typical_volume_is_within_six_deviations(times, told):
    typical = flow_balance.DECLARED["entrained_air"].parameter.typical
    found = flow_balance.air_untestable(replace(AIR, std=times * typical / 6.0))
    assert [each.name for each in found] == told
    assert [f"less than {times * typical:.2g} m^3" in each.because for each in found] == [True] * len(told)
    assert [each.needs for each in flow_balance.air_untestable(None)] == ["runs at a steady displacement"]


# -- a ripple's wave


def turning(gap, used=None, torque=2000.0):
    angle = np.linspace(0.0, 50.0, 4000)
    return SimpleNamespace(
        name="a", angle=angle, used=np.ones(4000, bool) if used is None else used, gear_ratio=100.0,
        drum_torque=np.full(4000, torque), gap=gap(angle),
    )  # fmt: skip


def test_a_ripples_shares_are_those_of_the_loads_torque_at_the_motor():
    """0.6 N m of 20 N m are 3 %; what is not used has no say."""
    used = np.arange(4000) < 3000
    own = turning(lambda x: np.where(used, 0.6 * np.sin(2.0 * x) - 0.2 * np.cos(2.0 * x), 9.0), used)
    waves = ripple_waves.waves_of([own], Ripple(2.0, 0.03, 1e-4, 1e-20, 9.0))
    assert waves["a"] == pytest.approx([0.03, -0.01])
    assert list(ripple_waves._wave_of(turning(np.sin, 0 * used > 0), Ripple(2.0, 1, 1, 1, 1))) == [0.0, 0.0]
    assert list(ripple_waves._wave_of(turning(np.sin, None, 0.0), Ripple(2.0, 1, 1, 1, 1))) == [0.0, 0.0]


def test_one_wave_for_all_runs_explains_what_they_share_and_nothing_of_what_cancels():
    angle = np.linspace(0.0, 40.0 * np.pi, 4000)
    static, wave = np.full(4000, 20.0), 0.6 * np.sin(2.0 * angle) - 0.2 * np.cos(2.0 * angle)
    noise = np.random.default_rng(0).standard_normal(4000)
    one = (angle, wave + noise, static)
    explained, shares, std = ripple_waves._shared([one, one], 2.0)
    assert shares == pytest.approx([0.03, -0.01], abs=4.0 * std)
    assert explained == pytest.approx(2.0 * float(wave @ wave), rel=0.15)
    # a share's deviation: of 8000 samples of a wave of 20 N m by half of their number
    assert std == pytest.approx(1.0 / 20.0 / np.sqrt(4000.0), rel=0.05)
    assert ripple_waves._shared([(angle, wave, static), (angle, -wave, static)], 2.0)[0] == pytest.approx(0.0, abs=1e-9)


def test_an_amplitude_is_weighted_by_how_sure_each_run_is_and_rid_of_its_noises_square():
    angle, rng = np.linspace(0.0, 40.0 * np.pi, 4000), np.random.default_rng(1)
    static = np.full(4000, 20.0)
    sure = (angle, 0.6 * np.sin(2.0 * angle) + 0.01 * rng.standard_normal(4000), static)
    unsure = (angle, 3.0 * np.cos(2.0 * angle) + 5.0 * rng.standard_normal(4000), static)
    assert ripple._amplitude(2.0, [sure, unsure])[0] == pytest.approx(0.03, rel=0.01)
    nothing = [(angle, rng.standard_normal(4000), static) for _ in range(40)]
    amplitude, std = ripple._amplitude(2.0, nothing)
    assert std == pytest.approx(1.0 / 20.0 / np.sqrt(40.0 * 2000.0), rel=0.05)
    assert amplitude < 5.0 * std


def test_a_runs_speeds_are_parted_in_thirds_whichever_way_it_turns():
    slow, middle, fast = ripple._speed_classes(np.array([5.0, -1.0, 3.0, -6.0, 2.0, -4.0]))
    assert [sorted(own.tolist()) for own in (slow, middle, fast)] == [[1, 4], [2, 5], [0, 3]]


# -- what is told of both
@pytest.mark.parametrize(
    ("leaks", "air", "told"),
    [
        (True, True, ["leak", "air"]),
        (True, False, ["leak"]),
        (False, True, ["air"]),
        (False, False, []),
        (None, None, []),
    ],
)
def test_only_a_leak_and_air_that_are_found_are_told(monkeypatch, leaks, air, told):
    leak = None if leaks is None else SimpleNamespace(found=leaks, name="leak")
    gas = None if air is None else SimpleNamespace(name="air")
    monkeypatch.setattr(flow_balance, "lost_speed", lambda *_: leak)
    monkeypatch.setattr(flow_balance, "free_air", lambda *_: gas)
    monkeypatch.setattr(flow_balance, "is_air", lambda _: air)
    found, unseen = flow_balance.shown_by([], [], ())
    assert ([each.name for each in found], unseen) == (told, [])


@pytest.mark.parametrize(
    ("gains", "holds"),
    [(np.ones(20), True), (-np.ones(20), False), (np.tile([3.0, -2.9], 10), False), (np.zeros(0), False)],
)
def test_air_holds_on_other_runs_where_it_surely_takes_something_off_their_lost_speed(monkeypatch, gains, holds):
    monkeypatch.setattr(flow_balance, "_all_sums", lambda *_: np.zeros((len(gains), 5)))
    monkeypatch.setattr(flow_balance, "_gains", lambda sums, volume: gains)
    assert flow_balance.holds_on(FreeAir(0.01, 0.001, 0.0, 1.0, 0.5), [], []) is holds


def test_air_that_seems_sure_by_its_signs_and_takes_nothing_off_does_not_hold(monkeypatch):
    monkeypatch.setattr(flow_balance, "_all_sums", lambda *_: np.zeros((4, 5)))
    monkeypatch.setattr(flow_balance, "_gains", lambda *_: -np.ones(4))
    monkeypatch.setattr(flow_balance, "sign_flip_p_value", lambda _: 0.0)
    assert not flow_balance.holds_on(FreeAir(0.01, 0.001, 0.0, 1.0, 0.5), [], [])


@pytest.mark.parametrize(("steady", "slow", "change"), [(20, 40, 1.0), (19, 40, 30.0), (19, 19, None)])
def test_plateaus_speak_for_a_leak_and_only_where_they_are_few_whatever_follows_its_command(
    monkeypatch, steady, slow, change
):
    """Twenty stretches of three runs are enough."""
    counts = {1.0: steady, 30.0: slow}
    rows = lambda runs, prepared, change: np.arange(counts[change])[:, None] % 3
    monkeypatch.setattr(flow_balance, "stretches", rows)
    monkeypatch.setattr(flow_balance, "_full_displacement", lambda _: 3e-5)
    monkeypatch.setattr(flow_balance, "leakage_of", lambda table, change, full: (len(table), change, full))
    found = flow_balance.lost_speed([], [])
    assert found == (None if change is None else (counts[change], change, 3e-5))
    monkeypatch.setattr(flow_balance, "stretches", lambda *_: np.arange(40)[:, None] % 2)
    assert flow_balance.lost_speed([], []) is None


@pytest.mark.parametrize(
    ("start", "share", "rows"), [(0.0, 1.0, 3), (7.0, 1.0, 3), (0.0, 0.0, 0), (0.0, 0.4, 0), (0.0, 0.6, 3)]
)
def test_a_stretch_is_told_by_its_command_at_the_same_instants_where_most_of_it_is_used(start, share, rows):
    """Fifteen seconds at about 50 rad/s are three stretches of five; the run's clock begins anywhere."""
    time = 0.05 * np.arange(300)
    group = SimpleNamespace(balances=True, pressure=np.full(300, 150e5), displacement=np.full(300, 3e-5))
    prepared = SimpleNamespace(
        time=time, start=start, dt=0.05, used=np.mod(time, 5.0) >= 5.0 * (1.0 - share) - 1e-9,
        speed=48.0 + 0.1 * time, acceleration=np.full(300, 0.1), groups=[group], channels={},
    )  # fmt: skip
    long = 0.05 * np.arange(-200, 700) + start
    run = Run("r", {"time": long, "speed_reference": 50.0 + 0.1 * (long - start)})
    found = flow_balance._segments(run, prepared, 4, 1.0)
    assert len(found) == rows
    if rows:
        assert found[:, 0].tolist() == [4.0] * 3
        assert found[:, 1] == pytest.approx(2.0)  # commanded beyond what was reached
        assert found[:, 3] == pytest.approx(0.1)


def test_air_is_judged_on_each_run_by_the_volume_of_the_others(monkeypatch):
    """Three runs of eight segments, of 1, 2 and 3 litres: the others' means are 2.5, 2 and 1.5."""
    sums = np.array([(k, 4e-3 * (k + 1), 4.0, 9e-6 * (k + 1) ** 2, 10.0) for k in range(3) for _ in range(8)])
    monkeypatch.setattr(flow_balance, "_all_sums", lambda *_: sums)
    found = flow_balance.free_air([], [])
    assert found.volume == pytest.approx(2e-3)
    own, others = np.array([1e-3, 2e-3, 3e-3]), np.array([2.5e-3, 2e-3, 1.5e-3])
    left = 9e-6 * np.array([1.0, 4.0, 9.0]) - 2.0 * others * 4.0 * own + 4.0 * others**2
    assert found.before == pytest.approx(np.sqrt(8 * 9e-6 * 14.0 / 240.0))
    assert found.after == pytest.approx(np.sqrt(8 * left.sum() / 240.0))
    monkeypatch.setattr(flow_balance, "_all_sums", lambda *_: sums[:19])
    assert flow_balance.free_air([], []) is None  # of too few stretches
    monkeypatch.setattr(flow_balance, "_all_sums", lambda *_: np.repeat(sums[:16], 2, axis=0))
    assert flow_balance.free_air([], []) is None  # of two runs


@pytest.mark.parametrize(("swings", "looked_at"), [(0.04, True), (0.06, False)])
def test_air_is_looked_for_where_the_driving_motors_hardly_swivel_in_segments_without_their_ends(
    monkeypatch, swings, looked_at
):
    """34 seconds less three at either end are five segments of five; what air takes is swept by all of the motors."""
    time = 0.01 * np.arange(3401)
    asked = {}

    def regressors(wanted, reached, drop, air, oil, side, dt):
        asked.update(air=air, oil=oil, side=side, drop=drop)
        return np.ones((len(wanted), 1)), np.sin(np.arange(len(wanted))), np.cos(np.arange(len(wanted)) + 0.5)

    monkeypatch.setattr(flow_balance, "_regressors", regressors)
    lower = np.where(np.arange(3401) < 1500, 5e6, 2e7)
    columns = {"speed_reference": 50.0 + 0.0 * time, "motor_speed": 49.0 + 0.0 * time}
    columns |= {"main.pressure_a": 1e7 + 0.0 * time, "main.pressure_b": lower}
    columns |= {"main.displacement": 3e-5 * (1.0 + swings * np.sqrt(2.0) * np.sin(7.0 * time))}
    run = Run("r", {"time": time, **columns})
    prepared = SimpleNamespace(groups=[SimpleNamespace(name="main", count=4, balances=True)])
    rows = flow_balance._sums(run, prepared, 6, slice(0, 3401))
    assert len(rows) == 5 * looked_at
    if not looked_at:
        return
    swept = 4 * np.median(columns["main.displacement"])
    taken = air_compressed(columns["main.pressure_a"], lower) / swept
    assert asked["air"][[0, -1]] == pytest.approx(taken[[0, -1]])
    assert (asked["side"][0], asked["side"][-1], asked["drop"][0]) == (1.0, -1.0, 5e6)
    assert rows[:, 0].tolist() == [6.0] * 5
    assert rows[:, 4].tolist() == [500.0] * 5
    assert rows[:, 2] == pytest.approx(250.0, rel=0.02)
    assert rows[:, 3] == pytest.approx(250.0, rel=0.02)
    assert rows[:, 1] == pytest.approx(-250.0 * np.sin(0.5), rel=0.05)


def test_the_lost_speed_is_what_was_wanted_and_not_reached(monkeypatch):
    wanted, reached = np.linspace(0.0, 50.0, 400), np.linspace(0.0, 40.0, 400)
    drop, air, oil = np.full(400, 1e7), np.linspace(0.0, 3.0, 400), np.linspace(0.0, 1.0, 400)
    _, lost, taken = flow_balance._regressors(wanted, reached, drop, air, oil, np.ones(400), 0.02)
    inside = slice(50, -50)
    assert lost[inside] == pytest.approx((wanted - reached)[inside], rel=1e-6)
    assert taken[inside] == pytest.approx(3.0 / 399 / 0.02, rel=1e-3)


@pytest.mark.parametrize(
    ("beside", "alone", "leak", "holds"),
    [
        (0.0, 0.0, 1.0, True),
        (0.0, 0.0, 0.0, False),  # which takes nothing off
        (0.0, 1.0, 1.0, False),  # an error of the scale alone does as much: nothing is left to a leak
        (1.5, 0.0, 1.0, False),  # with an error of the scale beside it that takes more than there is
    ],
)
def test_a_leak_is_held_against_the_error_of_the_scale_alone(beside, alone, leak, holds):
    """Rows of which each loses 2 rad/s at 2 rad/s, and as much per unit of a leak."""
    rows = np.zeros((30, 4 + len(LEAKAGE_LAWS)))
    rows[:, 0], rows[:, 1], rows[:, 2], rows[:, 4] = np.arange(30) % 3, 2.0, 2.0, 2.0
    law = next(iter(LEAKAGE_LAWS))
    own = Leakage({law: (leak, 0.1)}, 9.0, 0.1, 0.0, 1.0, 0.1, beside=(beside,), alone=(alone,))
    assert bool(own.explains(rows)) is holds


def test_what_two_laws_cost_together_is_as_sure_as_they_are_together():
    """Laws that stand in for each other are each known badly and their sum well; before is foretold by other runs."""
    drawn = table({"slip_leakage": 2e-11, "isoviscous_leakage": 2e-11}, 0.02, noise=0.02)
    found = leakage_of(drawn, lost_flow.STEADY_COMMAND, FULL)
    assert len(found.leakage) == 2
    apart = np.hypot(*(std for _, std in found.leakage.values())) * REFERENCE_PRESSURE / FULL
    assert 0.0 < found.slip_std < 0.8 * apart
    lost, speed, run = drawn[:, 1], drawn[:, 2], drawn[:, 0]
    held = np.concatenate([lost[run == k] - speed[run == k] * (speed[run != k] @ lost[run != k]) /
                           (speed[run != k] @ speed[run != k]) for k in range(RUNS)])  # fmt: skip
    assert found.before == pytest.approx(np.sqrt(np.mean(held**2)))


@pytest.mark.parametrize(("swing", "segments"), [(0.0, False), (5e5, True)])
def test_a_run_whose_pressure_never_moves_says_nothing_of_air(swing, segments):
    """A record at rest, to the last digit, among eleven of a winch at work ended `gap` in a division by zero."""
    time = 0.02 * np.arange(2000)
    columns = {
        "time": time, "motor_speed": 0.0 * time, "speed_reference": 0.0 * time, "main.displacement": 3e-5 + 0.0 * time,
        "main.pressure_a": 100e5 + swing * np.sin(time), "main.pressure_b": 25e5 + 0.0 * time,
    }  # fmt: skip
    prepared = SimpleNamespace(groups=(SimpleNamespace(name="main", count=11.0, balances=True),))
    found = flow_balance._sums(Run("rest", columns), prepared, 0, slice(0, 2000))
    assert bool(len(found)) is segments
    assert np.isfinite(found).all()


@pytest.mark.parametrize(("stated", "full"), [(0.0, 3e-5), (3.4e-5, 3.4e-5)])
def test_lost_speed_is_of_the_displacement_that_motors_have_at_most_in_any_run(monkeypatch, stated, full):
    """As the crane file has it, or where it has none as far as they were swung out in all of the runs."""

    def own(displacement):
        group = SimpleNamespace(balances=True, displacement=np.array([1e-5, displacement]))
        return SimpleNamespace(constants=(("max_displacement", stated),), groups=[group])

    monkeypatch.setattr(flow_balance, "stretches", lambda *_: "table")
    monkeypatch.setattr(flow_balance, "_enough", lambda table: True)
    monkeypatch.setattr(flow_balance, "leakage_of", lambda table, change, full: (table, change, full))
    assert flow_balance.lost_speed([], [own(2e-5), own(3e-5)]) == ("table", lost_flow.STEADY_COMMAND, full)
