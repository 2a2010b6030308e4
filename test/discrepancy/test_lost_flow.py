"""What leaks and what air takes, from rows of lost speed that are drawn: laws, sizes and entries by figures."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.detectors import flow_balance, lost_flow, ripple, ripple_waves
from winch_friction.discrepancy.detectors.lost_flow import FreeAir, Leakage, leakage_of
from winch_friction.discrepancy.detectors.ripple import Ripple
from winch_friction.physics.fluid import LEAKAGE_LAWS, REFERENCE_PRESSURE

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
