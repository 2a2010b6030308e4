"""A ripple over the shaft's angle, by figures: which line stands out, how surely, and in what of the torque."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import gammaincc

from winch_friction.discrepancy.detectors import ripple as module
from winch_friction.discrepancy.detectors import ripple_waves
from winch_friction.discrepancy.detectors.ripple import AsLogged, Line, Ripple
from winch_friction.physics.signals import Run

SIZE, DT = 600, 0.02
TIME = DT * np.arange(SIZE)


# -- what counts
@pytest.mark.parametrize(
    ("p_value", "amplitude", "order", "measured", "found"),
    [
        (0.9e-10, 5e-4, 7.0, True, True),
        (1.1e-10, 5e-4, 7.0, True, False),
        (0.9e-10, 3.9e-4, 7.0, True, False),  # that closes to no better
        (0.9e-12, 5e-4, 7.0, False, True),  # an angle that is added up carries the encoder's steps
        (1.1e-12, 5e-4, 7.0, False, False),
        (0.9e-10, 5e-4, 7.02, True, True),
        (0.9e-10, 5e-4, 7.04, True, False),  # between whole orders
        (0.9e-16, 5e-4, 7.04, False, True),
    ],
)
def test_a_ripple_is_sure_large_enough_and_surer_between_whole_orders(p_value, amplitude, order, measured, found):
    assert Ripple(order, amplitude, 1e-5, p_value, 50.0, measured).found is found


def test_a_ripple_is_written_with_what_it_takes_off_the_error_and_its_size():
    effect = Ripple(7.0, 5e-4, 1e-5, 1e-12, 16.0).effect
    assert effect.gain == pytest.approx(0.75)
    assert {name: (each.value, each.std) for name, each in effect.parameters.items()} == {
        "a_r": (5e-4, 1e-5), "k_r": (7.0, 0.0),
    }  # fmt: skip
    assert (effect.p_value, effect.variant, effect.name) == (1e-12, "7 periods per revolution", "torque_ripple")
    assert Ripple(7.0, 5e-4, 1e-5, 1e-12, 0.5).effect.gain == 0.0


@pytest.mark.parametrize(("sure", "known", "told"), [(True, False, True), (True, True, False), (False, False, False)])
def test_a_ripple_is_told_that_is_sure_and_none_that_the_model_has(monkeypatch, sure, known, told):
    own = SimpleNamespace(found=sure)
    monkeypatch.setattr(module, "angle_ripple", lambda *_: own)
    monkeypatch.setattr(module, "_known", lambda *_: known)
    assert (module.detect([], [], None, None) is own) is told


def test_of_two_ways_to_look_the_surer_line_is_taken_and_of_equals_the_one_that_stands_out(monkeypatch):
    lines = {}
    monkeypatch.setattr(module, "_tables", lambda runs, prepared, crane, model, inertia: [inertia])
    monkeypatch.setattr(module, "strongest_line", lambda own: lines[own[0]])
    model = SimpleNamespace(term_names=())
    logged, bare = {"shaft_angle": 1}, {}
    for (p, q), (first, second), inertia in (
        ((1e-5, 1e-9), (90.0, 3.0), True), ((1e-9, 1e-5), (3.0, 90.0), False), ((0.0, 0.0), (3.0, 9.0), True),
        ((0.0, 0.0), (9.0, 3.0), False),
    ):  # fmt: skip
        lines[False], lines[True] = Line(3.0, 1e-3, 1e-5, p, first), Line(4.0, 2e-3, 2e-5, q, second)
        found = module.angle_ripple([logged, logged], [], None, model)
        assert (found.with_inertia, found.order) == (inertia, 4.0 if inertia else 3.0)
        assert found.angle_is_measured
        assert not module.angle_ripple([logged, bare], [], None, model).angle_is_measured  # of every run


# -- a run as it was logged
def logged(drum=False):
    """A shaft of 100 rad/s that swings by 10, under 40 t on a metre; its torque has a wave and a slow part."""
    speed = 100.0 + 10.0 * np.sin(3.0 * TIME)
    turns = {"drum_speed": speed / 100.0} if drum else {"motor_speed": speed}
    run = Run("r", {"time": 50.0 + TIME, "motor_torque": TIME, **turns})
    ones = np.ones(SIZE)
    prepared = SimpleNamespace(
        time=TIME, start=50.0, dt=DT, load=4e4 * ones, radius=1.0 * ones, gear_ratio=100.0, drum_torque=4e5 * ones,
        angle=100.0 * TIME, speed=speed, point="point", used_at=lambda at: at > 51.0,
    )  # fmt: skip
    crane = SimpleNamespace(inertia=3.0, gear_ratio=100.0)
    return run, prepared, crane


@pytest.mark.parametrize("drum", [False, True])
def test_a_runs_inertia_acceleration_and_static_torque_are_those_at_the_motor(monkeypatch, drum):
    run, prepared, crane = logged(drum)
    monkeypatch.setattr(module, "run_drive_torque", lambda run, crane: np.full(SIZE, 7.0))
    own = AsLogged(run, prepared, crane)
    assert own.inertia == pytest.approx(3.0 + 4e4 * (1.0 / 100.0) ** 2)
    assert own.static == pytest.approx(4e3)
    assert own.acceleration[5:-5] == pytest.approx(30.0 * np.cos(3.0 * TIME)[5:-5], abs=0.1)
    assert own.of(prepared.angle) == pytest.approx(100.0 * TIME)
    assert (own.moving == (TIME > 1.0)).all()


def test_a_row_without_a_time_is_no_instant_of_a_run(monkeypatch):
    run, prepared, crane = logged()
    at = np.where(np.arange(SIZE) == 70, np.nan, run.time)
    monkeypatch.setattr(module, "run_drive_torque", lambda run, crane: TIME)
    own = AsLogged(Run("r", run.columns | {"time": at}), prepared, crane)
    assert own.torque.tolist() == own.of(TIME).tolist() == np.delete(TIME, 70).tolist()
    assert np.isfinite(own.acceleration).all()


@pytest.mark.parametrize(("terms", "inertia"), [((), False), ((), True), (("torque_ripple",), True)])
def test_what_is_looked_at_is_the_fast_torque_without_what_is_known_of_it(monkeypatch, terms, inertia):
    """A fast wave beside what inertia takes and what the model's own ripple is; what is slower than a window goes."""
    run, prepared, crane = logged()
    wave = np.sin(2.0 * np.pi * 12.0 * TIME)
    takes = 7.0 * 30.0 * np.cos(3.0 * TIME) if inertia else 0.0
    known = 5.0 * np.cos(2.0 * np.pi * 15.0 * TIME) if terms else 0.0
    monkeypatch.setattr(module, "run_drive_torque", lambda run, crane: wave + takes + known + 900.0 + 2.0 * TIME)
    own_model = SimpleNamespace(term_names=terms, subset=lambda names: SimpleNamespace(torque=lambda point: known))
    angle, fast, static, speed = module._moving(run, prepared, crane, own_model, inertia)
    inside = slice(30, -30)
    moving = TIME > 1.0
    # a parabola over the window leaves the wave but for a few hundredths
    assert fast[inside] == pytest.approx(wave[moving][inside], abs=0.15)
    assert (angle[0], static[0]) == (pytest.approx(100.0 * TIME[moving][0]), pytest.approx(4e3))
    assert len(speed) == moving.sum()


# -- lines
def test_where_there_is_nothing_a_lines_power_over_its_neighbours_is_one_on_average():
    rng = np.random.default_rng(0)
    angle = np.linspace(0.0, 2.0 * np.pi * 600.0, 60_000)
    size, _, use = module._lines([(angle,)])
    found = module._prominence(angle, rng.standard_normal(len(angle)), size, use)
    assert found.mean() == pytest.approx(1.0, abs=0.05)
    assert np.mean(found > np.log(2.0)) == pytest.approx(0.5, abs=0.03)


def test_a_lines_chance_is_that_of_the_largest_of_all_either_side_and_its_power_that_of_a_part(monkeypatch):
    monkeypatch.setattr(module, "_amplitude", lambda order, tables: (order * 1e-3, 1e-5))
    monkeypatch.setattr(module, "one_of_a_comb", lambda *_: False)
    orders, power = np.array([1.0, 2.0, 3.0, 4.0]), np.array([6.0, 40.0, 7.0, 5.0])
    found = module._strongest(orders, power, 6, [])
    assert (found.order, found.amplitude, found.std) == (2.0, 2e-3, 1e-5)
    assert found.p_value == pytest.approx(8.0 * gammaincc(6, 40.0))
    assert found.prominence == pytest.approx(40.0 / 6.0)
    assert module._strongest(orders, power / 8.0, 6, []).p_value == 1.0
    monkeypatch.setattr(module, "one_of_a_comb", lambda *_: True)
    assert module._strongest(orders, power, 6, []).p_value == 1.0


@pytest.mark.parametrize(
    ("in_parts", "sure", "taken"),
    [(30.0, 1e-11, "runs"), (30.0, 1e-9, "parts"), (9.0, 1e-11, "parts")],
)
def test_whole_runs_tell_a_line_surely_that_is_in_their_parts_as_well(monkeypatch, in_parts, sure, taken):
    """Of three parts a power of 9 is one of 200 by chance, and must be one of a thousand."""
    asked = []
    parts = iter([0.0, in_parts / 3.0, in_parts / 3.0, in_parts / 3.0])
    monkeypatch.setattr(module, "MOST_OF_ONE_PART", 99.0)
    monkeypatch.setattr(module, "_lines", lambda tables: (8, np.arange(3.0), np.array([False, True, True])))

    def prominence(angle, torque, size, use):
        part = next(parts)
        return np.array([1.0, 9.0]) if part == 0.0 else np.array([0.1, part])

    def strongest(orders, power, count, tables):
        asked.append((power.tolist(), count))
        return SimpleNamespace(
            p_value=sure if count == 1 and power[1] > 0.0 else 1.0, of="runs" if count == 1 else "parts"
        )

    monkeypatch.setattr(module, "_prominence", prominence)
    monkeypatch.setattr(module, "_strongest", strongest)
    ones = np.ones(9)
    found = module.strongest_line([(ones, ones, ones, ones)])
    assert found.of == taken
    assert asked[0] == ([0.0, 9.0 if in_parts == 30.0 else 0.0], 1)
    assert asked[1:] == ([] if taken == "runs" else [([pytest.approx(0.3), pytest.approx(in_parts)], 3)])


def test_a_line_holds_in_other_runs_by_its_chance_among_the_lines_near_it(monkeypatch):
    """Of two runs a power of 11.8 is one in 10 000 by chance, of eleven lines near one in 900."""
    orders = np.linspace(5.0, 8.0, 61)
    monkeypatch.setattr(module, "_lines", lambda tables: (8, orders, np.ones(61, bool)))
    one = np.ones(3)
    near = np.abs(orders - 6.0) < 0.05 * 6.0
    for power in (11.8, 12.4, 14.0):
        monkeypatch.setattr(module, "_prominence", lambda *_, p=power: np.where(np.arange(61) == 20, 0.5 * p, 0.1))
        chance = gammaincc(2, power) * near.sum()
        assert module.line_holds(6.0, [(one,) * 4] * 2) is bool(chance <= 1e-3)
        assert not module.line_holds(7.5, [(one,) * 4] * 2)
    assert gammaincc(2, 11.8) * near.sum() > 1e-3 > gammaincc(2, 14.0) * near.sum()
    assert gammaincc(2, 11.8) < 1e-3


@pytest.mark.parametrize(
    ("order", "looked_at"), [(0.07, False), (0.14, True), (7.0, True), (18.4, True), (21.3, False)]
)
def test_a_ripple_is_looked_for_from_ten_turns_of_the_shaft_to_a_twentieth_of_one(order, looked_at):
    angle = np.linspace(0.0, 300.0 * np.pi, 30_000)
    noise = np.random.default_rng(4).normal(size=(4, len(angle)))
    ones = np.ones(len(angle))
    tables = [(angle, 0.3 * np.sin(order * angle) + each, ones, np.linspace(1.0, 2.0, len(angle))) for each in noise]
    found = module.strongest_line(tables)
    assert (found.p_value < 1e-10 and found.order == pytest.approx(order, abs=0.01)) is looked_at


# -- one ripple for all runs
@dataclass(frozen=True)
class Own:
    """What a wave is taken out of."""

    gap: np.ndarray
    used: np.ndarray
    angle: np.ndarray
    drum_torque: np.ndarray
    gear_ratio: float = 100.0
    name: str = "r"


def test_a_wave_that_is_taken_out_of_a_run_leaves_what_else_its_gap_has():
    angle = np.linspace(0.0, 60.0, SIZE)
    wave = 4e3 * (2e-3 * np.sin(7.0 * angle) - 1e-3 * np.cos(7.0 * angle))
    run = Own(5.0 * np.cos(angle) + wave, np.arange(SIZE) > 9, angle, np.full(SIZE, 4e5))
    line = Ripple(7.0, 1e-3, 1e-5, 1e-12, 9.0)
    (shares,) = ripple_waves.waves_of([run], line).values()
    assert shares == pytest.approx([2e-3, -1e-3], abs=1e-4)
    found = ripple_waves.without_ripple(run, line, np.array([2e-3, -1e-3]))
    assert found.gap == pytest.approx(5.0 * np.cos(angle))


def shared(monkeypatch, *phases, order=7.0, present=("shaft_angle",), beside=()):
    """Runs with a wave of 2e-3 of 4 kN m each, of these phases; their line was seen a little beside it."""
    angle = np.linspace(0.0, 300.0, 3000)
    other, static = 0.1 * np.cos(31.0 * angle), np.full(3000, 4e3)
    tables = iter([(angle, 8.0 * np.sin(order * angle + phase) + other, static) for phase in phases])
    monkeypatch.setattr(ripple_waves, "_unsmoothed", lambda *_: next(tables))
    runs = [SimpleNamespace(used=np.ones(3, bool), drum_torque=np.ones(3), present=frozenset(present)) for _ in phases]
    runs[0].present = frozenset({"shaft_angle"})
    line = Ripple(order + 0.01, 1e-3, 1e-5, 1e-12, 9.0)
    return ripple_waves.in_phase([*runs, *beside], [*runs, *beside], None, line)


@pytest.mark.parametrize("phase", [0.0, 1.1, -2.0])
def test_one_ripple_of_all_runs_has_their_phase_their_size_and_an_order_of_its_own(monkeypatch, phase):
    found = shared(monkeypatch, phase, phase, phase)
    assert found["a_r"].value == pytest.approx(2e-3 * np.cos(phase), abs=2e-5)
    assert found["b_r"].value == pytest.approx(2e-3 * np.sin(phase), abs=2e-5)
    assert found["k_r"].value == pytest.approx(7.0, abs=1e-4)
    assert found["k_r"].std == pytest.approx(0.1 * np.pi / 300.0)  # a tenth of a quarter of a line's width
    assert found["a_r"].std == found["b_r"].std < 2e-6


@pytest.mark.parametrize(("apart", "one"), [(np.pi / 3.0, True), (np.pi * 5.0 / 9.0, False), (np.pi, False)])
def test_runs_share_a_ripple_where_one_phase_explains_seven_tenths_of_what_their_own_do(monkeypatch, apart, one):
    """Of two runs that is the square of the cosine of half of what lies between them: 0.75, and 0.41."""
    assert (shared(monkeypatch, 0.0, apart) is not None) is one


def test_a_phase_is_one_only_where_every_run_logged_its_angle(monkeypatch):
    assert shared(monkeypatch, 0.0, 0.0, present=()) is None


@pytest.mark.parametrize(("used", "drum_torque"), [(False, 1.0), (True, 0.0)])
def test_a_run_that_rests_or_hangs_nothing_has_no_phase_to_share(monkeypatch, used, drum_torque):
    idle = SimpleNamespace(used=np.full(3, used), drum_torque=np.full(3, drum_torque), present=frozenset())
    assert shared(monkeypatch, 0.0, 0.0, beside=[idle])["k_r"].value == pytest.approx(7.0, abs=1e-4)


@pytest.mark.parametrize("inertia", [False, True])
def test_a_shared_wave_is_looked_for_in_the_unsmoothed_gap_about_its_mean(monkeypatch, inertia):
    """Of moving samples; what the inertia takes beyond the prediction's smoothed acceleration is no ripple."""
    moving = np.arange(6) > 1
    own = SimpleNamespace(
        torque=np.array([9.0, 9.0, 5.0, 7.0, 6.0, 10.0]), inertia=2.0, acceleration=np.array([9.0, 9, 1, 2, 3, 4]),
        moving=moving, static=np.arange(6.0), of=lambda values: values,
    )  # fmt: skip
    monkeypatch.setattr(ripple_waves, "AsLogged", lambda *_: own)
    smoothed = np.array([0.0, 0.0, 1.5, 1.5, 3.5, 3.5])
    prepared = SimpleNamespace(
        predicted=np.array([0.0, 0, 1, 1, 2, 2]), acceleration=smoothed, angle=10.0 * np.arange(6)
    )
    angle, gap, static = ripple_waves._unsmoothed(None, prepared, None, inertia)
    wanted = np.array([4.0, 6.0, 4.0, 8.0]) - (2.0 * np.array([-0.5, 0.5, -0.5, 0.5]) if inertia else 0.0)
    assert gap == pytest.approx(wanted - wanted.mean())
    assert (angle.tolist(), static.tolist()) == ([20.0, 30.0, 40.0, 50.0], [2.0, 3.0, 4.0, 5.0])
