"""What every candidate reads of a run, part by part: figures, samples that count, the wire's mode, and its channels."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.preparation import prepare as module
from winch_friction.discrepancy.preparation.prepare import (
    DRUM_TORQUE,
    READ_AS,
    PreparedRun,
    channels_of,
    prepare,
)
from winch_friction.discrepancy.preparation.suspended_load import Mode
from winch_friction.discrepancy.preparation.wire_mode import Swing
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.signals import Run

SIZE, DT = 400, 0.05
RIGID = Mode(0.0, 0.0)
TIME = DT * np.arange(SIZE)


# -- figures of a run
class Own(SimpleNamespace):
    drive_torque, kind = PreparedRun.drive_torque, PreparedRun.kind
    load_friction, top_speed, used_at = PreparedRun.load_friction.func, PreparedRun.top_speed.func, PreparedRun.used_at


def test_what_was_measured_is_the_gap_beyond_what_was_predicted():
    assert Own(gap=5.0, predicted=300.0).drive_torque == 305.0


def test_the_friction_of_a_load_is_its_growth_with_the_drums_torque_alone():
    """A hundredth of the drum's torque and a constant: per relative change of the first, the hundredth."""
    point = tuple(np.array([5.0, -2.0]) * (k + 1) for k in range(DRUM_TORQUE + 3))
    model = SimpleNamespace(torque=lambda x, states: 0.01 * x[DRUM_TORQUE] + 3.0 * x[0] + states)
    found = Own(point=point, states=7.0, model=model).load_friction()
    assert found == pytest.approx(0.01 * point[DRUM_TORQUE])


def test_the_top_speed_is_that_of_either_direction_but_for_outliers():
    speed = np.concatenate([np.linspace(-100.0, 50.0, 2000), [1e4]])
    assert Own(speed=speed).top_speed() == pytest.approx(np.percentile(np.abs(speed), 99))
    assert 95.0 < Own(speed=speed).top_speed() < 100.0


def test_an_instant_counts_between_two_samples_of_the_regime_by_the_runs_own_clock():
    run = Own(time=np.arange(6.0), start=100.0, used=np.array([1, 1, 0, 0, 1, 1], bool))
    at = np.array([0.0, 0.5, 1.0, 1.4, 1.6, 2.5, 3.9, 4.0, 4.7])
    assert run.used_at(100.0 + at).tolist() == [True, True, True, False, False, False, False, True, True]


@pytest.mark.parametrize(
    ("name", "si", "read"),
    [
        ("pressure", 150e5, "150 bar"), ("displacement", 107e-6 / (2 * np.pi), "107 cm^3/rev"),
        ("hook_load", 42e3, "42 t"), ("motor_speed", 200.0, "200 rad/s"), ("wire_out", 120.0, "120 m"),
        ("oil_temperature", 40.0, "40 degC"),
    ],
)  # fmt: skip
def test_people_read_a_signal_in_their_own_units(name, si, read):
    factor, unit = READ_AS[name]
    assert f"{si * factor:.3g} {unit}" == read


# -- a run prepared
@dataclass(frozen=True)
class Grid:
    """The run's columns on a uniform time; the last ten samples were not measured."""

    columns: dict
    dt: float = DT

    @property
    def time(self):
        return TIME

    @property
    def valid(self):
        return TIME[-10] > TIME


def prepared(monkeypatch, mode=None, spikes=None, tension=False, wire=0.0, **masks):
    """A run of which all parts are known; `masks` are the samples that each part lets through."""
    whole = {"moving": TIME > 1.0, "settled": TIME > 2.0, "rung": TIME[60] != TIME, "known": TIME[70] != TIME,
             "followed": TIME[80] != TIME, "layer": TIME[90] != TIME, "holes": TIME[85] != TIME,
             **masks}  # fmt: skip
    ones, asked = np.ones(SIZE), {}
    motion = SimpleNamespace(
        window=5, used=whole["moving"], speed=2.0 * ones, acceleration=3.0 * ones, direction=ones, angle=400.0 * TIME
    )
    hanging = SimpleNamespace(
        mass=np.where(TIME < 1.0, 9e4, 4e4), tension_measured=tension, acceleration=0.1 * ones, radius=ones,
        drum_torque=5e5 * ones, heave_torque=70.0 * ones, heave=ones,
        on_one_layer=lambda angle, gear_ratio: whole["layer"] & (angle == motion.angle) & (gear_ratio == 100.0),
    )  # fmt: skip
    balance = SimpleNamespace(
        gap=4.0 * ones, measured=9.0 * ones, predicted=600.0 * ones, simulated_torque=650.0 * ones, unit_torque=20.0,
        groups=(SimpleNamespace(name="main", pressure=ones, displacement=ones),), point=(), states=(),
    )  # fmt: skip
    seen = SimpleNamespace(grid=Grid({}), motion=motion, is_of=lambda *_: True)
    balancing = SimpleNamespace(known=whole["known"])

    def spiky(gap, used, dt):
        asked["spikes"] = (gap[0], used.copy(), dt)
        return TIME[100] == TIME

    def load_seen(seen, crane, load):
        asked["load"] = load
        return "load"

    def on_wire(balancing, load, mode, wire):
        asked["wire"] = (load, mode, wire)
        return Swing(Mode(8.0, 0.05), (0.1, 0.2), 800.0, True), hanging, balance

    def rung_out(grid, mode, gap, moving):
        asked["rung"] = (mode.frequency, gap[0], moving)
        return whole["rung"]

    for name, part in (
        ("see", lambda *_: seen), ("Balancing", lambda *_: balancing), ("load_seen", load_seen), ("_on_wire", on_wire),
        ("settled", lambda *_: whole["settled"]), ("rung_out", rung_out),
        ("beside_holes", lambda *_: whole["holes"]), ("_followed", lambda *_: whole["followed"]),
        ("spikes_of", spiky), ("channels_of", lambda *_: {}),
        ("completed", lambda *_: SimpleNamespace(constants={"k": 2.0})),
    ):  # fmt: skip
        monkeypatch.setattr(module, name, part)
    crane = SimpleNamespace(
        gear_ratio=100.0, inertia=7.0, rated_load=1.5e5, drum=SimpleNamespace(layer_radii=(1.0, 1.1, 1.2))
    )
    run = Run("r", {"time": 500.0 + TIME, "motor_speed": ones})
    return prepare(run, crane, None, 3e4, mode=mode, spikes=spikes, wire=wire), asked, whole


def test_a_run_is_prepared_with_each_of_its_figures_in_its_own_place(monkeypatch):
    found, asked, whole = prepared(monkeypatch, wire=9e3)
    assert (found.start, found.dt, found.gear_ratio, found.inertia, found.unit_torque) == (500.0, DT, 100.0, 7.0, 20.0)
    assert found.constants == (("k", 2.0),)
    assert (asked["load"], asked["wire"]) == (3e4, ("load", None, 9e3))
    assert (asked["rung"][:2], asked["rung"][2] is whole["moving"]) == ((8.0, 4.0), True)
    assert found.from_speed[0] == 580.0  # what the user's simulation says, but for the heave
    assert (found.gap[0], found.predicted[0], found.drive_torque[0]) == (4.0, 600.0, 604.0)
    assert found.rated_torque == pytest.approx(1.5e5 * GRAVITY * 1.2 / 100.0)  # on the outermost layer
    assert found.swinging == pytest.approx(4e4 - 6e3)  # a third of the wire's own mass swings along
    assert (found.swing_variance, found.swing_left, found.swing_noise) == (2.0, (0.1, 0.2), True)
    assert found.wire_mode == Mode(8.0, 0.05)
    assert found.corrections.shape == (SIZE, 0)


@pytest.mark.parametrize("tension", [False, True])
def test_a_measured_force_stands_for_a_load_cell(monkeypatch, tension):
    found, _, _ = prepared(monkeypatch, tension=tension)
    assert found.tension_measured is tension
    assert ("hook_load" in found.present) is tension
    assert {"motor_speed", "time"} <= found.present


def test_samples_count_that_every_part_lets_through_that_were_measured_and_are_no_spikes(monkeypatch):
    found, asked, _ = prepared(monkeypatch)
    there = (TIME > 2.0) & ~np.isin(np.arange(SIZE), (60, 70, 80, 85))
    gap, used, dt = asked["spikes"]
    assert (gap, dt) == (4.0, DT)
    assert (used == there).all()
    there[90] = False
    assert (found.used == (there & (TIME[-10] > TIME) & (np.arange(SIZE) != 100))).all()
    given, asked, _ = prepared(monkeypatch, spikes=np.arange(SIZE) == 200)
    assert "spikes" not in asked
    assert (given.used == (there & (TIME[-10] > TIME) & (np.arange(SIZE) != 200))).all()


# -- the wire's mode
@pytest.mark.parametrize(
    ("mode", "least"),
    [(Mode(8.0, 0.0), 0.0), (Mode(0.0, 0.05), 0.0), (Mode(8.0, 0.2), 2.5), (Mode(8.0, 0.05), 0.2 * TIME[-1])],
)
def test_a_swing_from_before_dies_out_in_four_decay_times_and_at_most_a_fifth_of_a_run(mode, least):
    settled = module.settled(SimpleNamespace(time=TIME), mode)
    assert (settled == (least < TIME)).all() if least else settled.all()


@pytest.mark.parametrize(
    ("louder", "until", "stands", "left_out"),
    [(1.6, 4.0, 0.0, False), (2.6, 4.0, 0.0, True), (0.1, 4.0, 0.0, False), (50.0, 1.5, 1.5, False)],
)
def test_a_beginning_that_swings_twice_as_much_as_the_rest_is_left_out(louder, until, stands, left_out):
    """Of what moves: what a standing shaft shows at first is no swing."""
    time = 0.02 * np.arange(1000)
    gap = np.random.default_rng(0).standard_normal(1000) * np.where(time < until, louder, 1.0)
    kept = module.rung_out(SimpleNamespace(time=time), Mode(3.0, 0.0), gap, time > stands)
    assert (kept == (time > 0.2 * time[-1])).all() if left_out else kept.all()


def swinging(monkeypatch, mass=4e4, found=RIGID, wire=0.0, stiffness=4e8, out=100.0, moving=None):
    asked = []
    monkeypatch.setattr(module, "_other_causes", lambda *_: "causes")
    monkeypatch.setattr(
        module, "swinging_load", lambda *own, **more: asked.append((own, more)) or Swing(found, (0.5,), 3.0)
    )
    motion = SimpleNamespace(used=np.ones(SIZE, bool) if moving is None else moving, acceleration=TIME)
    columns = {} if out is None else {"wire_out": np.full(SIZE, out)}
    balancing = SimpleNamespace(
        motion=motion, grid=SimpleNamespace(columns=columns, dt=DT, time=TIME),
        crane=SimpleNamespace(wire_stiffness=stiffness),
    )  # fmt: skip
    load = SimpleNamespace(mass=np.full(SIZE, mass), acceleration=2.0 * TIME, lever=0.01)
    return module._wire_mode(balancing, load, SimpleNamespace(gap=3.0 * TIME), wire), asked


def test_a_swing_is_looked_for_where_the_wires_stiffness_and_a_load_are_known(monkeypatch):
    assert swinging(monkeypatch, stiffness=np.nan) == (Swing(Mode(0.0, 0.0)), [])
    assert swinging(monkeypatch, mass=0.0) == (Swing(Mode(0.0, 0.0)), [])
    assert swinging(monkeypatch, moving=TIME < 4.9) == (Swing(Mode(0.0, 0.0)), [])  # 98 samples move
    found, ((own, more),) = swinging(monkeypatch)
    gap, counts, rigid, dt, mass, lever, stiffnesses = own
    assert ((gap == 3.0 * TIME).all(), (rigid == 2.0 * TIME).all(), dt, mass, lever) == (True, True, DT, 4e4, 0.01)
    assert stiffnesses == pytest.approx((4e6,))
    assert (more["friction"], more["length"][0]) == ("causes", 100.0)
    assert (more["hiding"][:, 0] == TIME).all()  # an inertia that is wrong
    # 10 rad/s, damped as a rope is: eight seconds, of which a fifth of the record is looked past at most
    assert (counts == (0.2 * TIME[-1] < TIME)).all()
    assert found == Swing(Mode(pytest.approx(10.0), 0.0), (0.5,), 3.0)


def test_a_mode_that_was_found_stands_and_without_a_length_none_is_stated(monkeypatch):
    assert swinging(monkeypatch, found=Mode(7.0, 0.05))[0].mode == Mode(7.0, 0.05)
    found, ((own, _),) = swinging(monkeypatch, out=None)
    assert found.mode == Mode(0.0, 0.0)
    assert len(own[6]) > 5
    # the slowest of all lengths says how long it rings: 2 rad/s here, and a fifth of the record is less
    assert (own[1] == (0.2 * TIME[-1] < TIME)).all()


def test_a_wire_whose_mass_swings_along_makes_a_lighter_load_of_what_hangs(monkeypatch):
    """Two thirds of 9 t do not swing: what hangs with 40 t swings as 34 do, by a stiffness that is 40/34 as large."""
    found, ((own, more),) = swinging(monkeypatch, wire=9e3)
    assert (own[4], own[6]) == (4e4, pytest.approx((4e6 * 40.0 / 34.0,)))
    assert found.mode.share == more["share"] == pytest.approx(35.5**2 / (40.0 * 34.0))  # the rest is rigid


def test_other_causes_are_losses_by_the_speed_and_delays_of_the_speed_or_of_the_pressures():
    direction = np.sign(np.cos(TIME))
    motion = SimpleNamespace(speed=5.0 * np.cos(TIME), direction=direction)
    load, rigid = SimpleNamespace(heave_torque=2.0 * TIME), SimpleNamespace(predicted=5.0 * TIME)
    found = module._other_causes(SimpleNamespace(motion=motion), load, rigid)
    wanted = [motion.speed, direction * motion.speed**2, np.full(SIZE, 3.0 * DT), np.full(SIZE, 5.0 * DT)]
    assert found == pytest.approx(np.column_stack(wanted))


# -- channels
def channels(hydraulic=True, tension=False, columns=(), aside=None):
    ones = np.ones(SIZE)
    motion = SimpleNamespace(speed=-3.0 * ones, acceleration=-4.0 * ones, angle=-50.0 * TIME)
    load = SimpleNamespace(mass=4e4 * ones, tension_measured=tension)
    group = SimpleNamespace(name="main", pressure=2e7 * ones, displacement=2e-5 * ones)
    crane = SimpleNamespace(gear_ratio=100.0, drive=SimpleNamespace(hydraulic=hydraulic))
    run = Run("r", {"time": 900.0 + TIME, "motor_speed": ones}, aside=aside or {})
    grid = SimpleNamespace(columns=dict.fromkeys(columns, 7.0 * ones), time=TIME)
    return channels_of(run, grid, motion, load, (group,) if hydraulic else (), crane)


def test_a_gap_may_depend_on_how_fast_the_shaft_turns_on_the_drums_angle_and_on_what_was_predicted():
    found = channels(columns=("oil_temperature", "wire_out", "rope_force"))
    assert (found["motor_speed"][0], found["acceleration"][0]) == (3.0, -4.0)
    assert found["shaft_angle"] == pytest.approx(np.mod(-0.5 * TIME, 2.0 * np.pi))
    assert (found["main.pressure"][0], found["main.displacement"][0]) == (2e7, 2e-5)
    assert (found["oil_temperature"][0], found["wire_out"][0]) == (7.0, 7.0)
    assert "rope_force" not in found
    assert found["time"] is TIME


@pytest.mark.parametrize(
    ("hydraulic", "tension", "columns", "known"),
    [(True, False, (), True), (False, False, (), False), (False, True, (), True), (False, False, ("hook_load",), True)],
)
def test_a_load_is_a_channel_where_pressures_or_somebody_weighed_it(hydraulic, tension, columns, known):
    found = channels(hydraulic, tension, columns)
    assert ("hook_load" in found) is known
    if known:  # what hangs, not what the cell shows while it swings: its inertia is no load that friction sees
        np.testing.assert_array_equal(found["hook_load"], 4e4)


def test_columns_that_nobody_knows_are_channels_by_the_runs_own_clock_where_they_are_numbers():
    steps = np.arange(SIZE)
    aside = {"valve": 0.5 * steps, "state": steps, "word": np.full(SIZE, "x"), "short": steps[:9]}
    found = channels(aside=aside)
    assert found["valve"] == pytest.approx(0.5 * steps)
    assert found["state"] == pytest.approx(steps)
    assert not {"word", "short"} & set(found)


# -- what a slow log can follow
def follows(bend, dt=0.1, mode=RIGID, hydraulic=True, moving=None, where=None):
    """Samples of a torque of 2 kg m^2 and of a load that bends by so much, N m, from one sample to the next; 20 N m are
    a bar."""
    curve = 0.5 * np.arange(SIZE) ** 2
    bends = np.where(np.ones(SIZE, bool) if where is None else where, 1.0, 0.0)
    motion = SimpleNamespace(acceleration=0.25 * bend * curve * bends, used=TIME >= 0 if moving is None else moving)
    crane = SimpleNamespace(inertia=2.0, drive=SimpleNamespace(hydraulic=hydraulic))
    load, balance = SimpleNamespace(inertial_torque=0.5 * bend * curve * bends), SimpleNamespace(unit_torque=20.0)
    return module._followed(SimpleNamespace(dt=dt, time=TIME), motion, load, balance, crane, mode)


@pytest.mark.parametrize(
    ("bend", "more", "followed"),
    [
        (35.0, {}, True),  # a twelfth of 36 N m is what shows: 3 N m, 0.15 bar
        (37.0, {}, False),
        (-37.0, {}, False),
        (37.0, {"hydraulic": False}, True),  # what a current tells is rougher
        (37.0, {"dt": 0.05}, True),  # of a usual log
        (37.0, {"dt": 0.05, "mode": Mode(12.0, 0.0)}, True),  # a wire that does not give rings nowhere
        (37.0, {"dt": 0.05, "mode": Mode(12.0, 0.05)}, False),
        (37.0, {"dt": 0.05, "mode": Mode(9.0, 0.05)}, True),
    ],
)
def test_a_sample_is_followed_where_the_torque_bends_by_less_than_shows(bend, more, followed):
    found = follows(bend, **more)
    assert found[:-9].all() if followed else not found[2:-2].any()  # the last one ends in a kink


@pytest.mark.parametrize(("share", "some"), [(0.04, False), (0.2, True)])
def test_of_a_motion_that_is_hardly_ever_followed_nothing_is(share, some):
    """A twentieth of what moves; how well a standing shaft is followed says nothing."""
    moving = np.arange(SIZE) >= SIZE // 2
    own = np.arange(SIZE) >= SIZE // 2 * (1.0 + share)
    assert follows(90.0, moving=moving, where=own)[moving].any() is np.bool_(some)


def test_what_is_one_number_for_a_whole_run_has_no_samples():
    series, one, plain = module.samples_of_each((np.arange(5.0), np.array(2.0), 3.0), np.array([1, 4]))
    assert series.tolist() == [1.0, 4.0]
    assert (float(one), plain) == (2.0, 3.0)
