"""The torque balance of one run by figures: what is measured, what is predicted, and what a simulation stands for."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.preparation import balance as module
from winch_friction.discrepancy.preparation import own_simulation, suspended_load
from winch_friction.discrepancy.preparation.balance import Accounted, Balancing
from winch_friction.discrepancy.preparation.motors import GroupSignals
from winch_friction.discrepancy.preparation.own_simulation import REFERENCE, displacement_error, simulated_error
from winch_friction.discrepancy.preparation.suspended_load import Hung, Mode, SuspendedLoad, heavy_by_tune, load_of
from winch_friction.physics.channels import BAR, GRAVITY
from winch_friction.physics.signals import Run

ONE = np.ones(3)
# 1000 kg on 0.981 m and a gear of 100 make 96.2 N m at rest; with the inertia of shaft and load 30 and 20 more
LOAD = SuspendedLoad(1000.0 * ONE, 0.981 * ONE, 0.00981 * ONE, 20.0 / 9.81 * ONE, 0.1 * ONE)
REST = 1000.0 * GRAVITY * 0.981 / 100.0
FRICTIONLESS = REST + 30.0 + 20.0


def group(name, balances, count, swash, drop=1e7):
    return GroupSignals(
        name, count, drop * ONE, drop * ONE + 2e6, 1e6 * ONE, swash * ONE, balances, drop * ONE
    )  # fmt: skip


class Model(SimpleNamespace):
    """A friction that is so much per pascal of the driving group, and a constant."""

    def torque(self, point, states):
        return self.constant + self.slope * point.get("driving", 0.0)


def balancing(monkeypatch, hydraulic=True, groups=(), slope=0.0, constant=0.0, accounted=None, logged=ONE, dt=0.02,
              metadata=None, model=None, window=5, **columns):  # fmt: skip
    size = len(logged)
    asked = []

    def operating_point(**signals):
        asked.append(signals)
        drives = [own for own in signals["groups"] if own]
        return {"driving": drives[0][1], "states": 0} if drives else {}

    monkeypatch.setattr(module, "operating_point", operating_point)
    monkeypatch.setattr(module, "group_point", lambda *own: own)
    monkeypatch.setattr(module, "model_states", lambda *_: ())
    grid = SimpleNamespace(columns=columns, dt=dt, time=np.arange(float(size)))
    motion = SimpleNamespace(
        acceleration=10.0 * ONE, direction=-ONE, state_speed=-7.0 * ONE, speed=-7.5 * ONE, angle=5.0 * ONE,
        window=window,
    )  # fmt: skip
    seen = SimpleNamespace(
        grid=grid,
        motion=motion,
        measured=(tuple(groups), 900.0 * ONE),
        smoothed=lambda torque: 2.0 * np.asarray(torque),
    )
    drive = SimpleNamespace(hydraulic=hydraulic, of_run=lambda run, crane: logged)
    crane = SimpleNamespace(
        gear_ratio=100.0, inertia=3.0, drive=drive, max_displacement=3.5e-5,
        motor_total=lambda names: {(): 4.0, ("main",): 11.0}[tuple(names)],
    )  # fmt: skip
    run = SimpleNamespace(name="r", time=700.0 + grid.time, groups=("main",) if groups else (), metadata=metadata or {})
    own = model or Model(slope=slope, constant=constant)
    return Balancing(run, crane, own, seen, accounted or Accounted()), asked


def test_a_driving_groups_pressure_is_that_which_the_load_and_its_own_friction_take(monkeypatch):
    """Each bar of pressure costs a fifth of what it makes: three steps from the frictionless torque on."""
    driving, constant = [group("main", True, 2, 3e-5)], 1000.0 - FRICTIONLESS
    own, asked = balancing(monkeypatch, True, driving, 1.2e-5, constant, Accounted(missing_torque=50.0))
    found = own.of(LOAD)
    first = 1000.0 + 0.2 * (FRICTIONLESS + 50.0)
    second = 1000.0 + 0.2 * (first + 50.0)
    assert found.predicted == pytest.approx((1000.0 + 0.2 * (second + 50.0)) * ONE)
    assert found.groups[0].pressure == pytest.approx((second + 50.0) / 6e-5 * ONE)
    assert (found.measured[0], found.gap[0]) == (900.0, pytest.approx(900.0 - found.predicted[0]))
    assert found.unit_torque == pytest.approx(BAR * 6e-5)
    assert len(asked) == 3
    assert found.simulated is None


def test_a_bar_is_worth_the_median_stroke_of_all_driving_motors(monkeypatch):
    own = replace(group("main", True, 2, 3e-5), displacement=np.array([2e-5, 3e-5, 5e-5]))
    passive = group("p", False, 4, 9e-5)
    assert balancing(monkeypatch, groups=[passive, own])[0].of(LOAD).unit_torque == pytest.approx(BAR * 6e-5)


def test_what_friction_is_reckoned_with_is_each_signal_in_its_own_place(monkeypatch):
    own, asked = balancing(monkeypatch, groups=[group("main", True, 2, 3e-5)], oil_temperature=40.0 * ONE, other=ONE)
    own.of(LOAD)
    point = asked[-1]
    ((count, pressure, displacement, total, role),) = point["groups"]
    assert role == 0.0
    assert (count[0], displacement[0]) == (2.0, 3e-5)
    assert pressure == pytest.approx(FRICTIONLESS / 6e-5 * ONE)
    assert total == pytest.approx(pressure + 2e6)
    figures = {name: point[name][0] for name in ("direction", "speed", "acceleration", "motor_total", "shaft_angle")}
    assert figures == {"direction": -1.0, "speed": -7.0, "acceleration": 10.0, "motor_total": 11.0, "shaft_angle": 5.0}
    assert point["drum_torque"] == pytest.approx(100.0 * REST * ONE)
    assert point["time"].tolist() == [700.0, 701.0, 702.0]
    assert point["oil_temperature"][0] == 40.0
    assert "other" not in point


def test_errors_of_the_passive_side_are_taken_out_of_it_each_in_its_own_place(monkeypatch):
    asked = []
    monkeypatch.setattr(module, "without_error", lambda groups, *errors: asked.append(errors) or groups)
    own, _ = balancing(monkeypatch, groups=[group("main", True, 2, 3e-5), group("p", False, 4, 2e-5)],
                       accounted=Accounted(0.0, 5.0, 6.0))  # fmt: skip
    found = own.of(LOAD)
    assert asked == [(5.0, 6.0)]
    assert found.groups[0].pressure == pytest.approx((FRICTIONLESS - 4 * 2e-5 * 1e7) / 6e-5 * ONE)


@pytest.mark.parametrize(("swash", "logged"), [(3.4e-6, True), (3.6e-6, False)])
def test_motors_below_a_tenth_of_their_stroke_have_the_pressure_that_was_logged(monkeypatch, swash, logged):
    own, _ = balancing(monkeypatch, groups=[group("main", True, 2, swash, 3e7)])
    pressure = own.of(LOAD).groups[0].pressure
    assert pressure == pytest.approx(3e7 * ONE if logged else FRICTIONLESS / (2 * swash) * ONE)


def test_a_drive_without_pressures_gives_what_it_says_and_its_unit_is_that_of_one_motor(monkeypatch):
    own, asked = balancing(monkeypatch, hydraulic=False, constant=6.0, logged=np.array([200.0, np.nan, 400.0]))
    found = own.of(LOAD)
    assert found.measured == pytest.approx([400.0, 600.0, 800.0])  # drawn straight and smoothed
    assert found.predicted == pytest.approx((FRICTIONLESS + 6.0) * ONE)
    assert (found.unit_torque, found.groups) == (4.0, ())
    assert asked[0]["groups"] == []


@pytest.mark.parametrize(("dt", "reach"), [(0.02, 2), (0.03, 3), (0.1, 3)])
def test_what_a_drive_does_not_tell_reaches_as_far_as_smoothing_takes_it(monkeypatch, dt, reach):
    """Half a window, and a sample more where a sparse log's torque is a mean over two periods."""
    logged = np.where(np.arange(21) == 10, np.nan, 5.0)
    own, _ = balancing(monkeypatch, hydraulic=False, logged=logged, dt=dt)
    assert np.flatnonzero(~own.known).tolist() == list(range(10 - reach, 11 + reach))
    whole, _ = balancing(monkeypatch, logged=logged, dt=dt)
    assert whole.known.all()


# -- a user's simulation
@pytest.mark.parametrize("same", [True, False])
def test_what_a_simulation_is_off_by_is_the_gap_beside_the_model_that_it_stands_for(monkeypatch, same):
    """30 and 5 N m are smoothed to twice as much; the model that it stands for predicts 40 N m more, or is the same."""
    monkeypatch.setattr(module, "simulated_error", lambda *_: 30.0 * ONE)
    monkeypatch.setattr(module, "displacement_error", lambda *_: 5.0 * ONE)
    model, before = Model(slope=0.0, constant=0.0), Model(slope=0.0, constant=40.0)
    stood = SimpleNamespace(
        model=model if same else before, run=SimpleNamespace(name="r", time=ONE, groups=("main",)),
        grid=SimpleNamespace(time=np.arange(4.0), columns={}), crane=None,
    )  # fmt: skip
    own, _ = balancing(monkeypatch, groups=[group("main", True, 2, 3e-5)], model=model, metadata={REFERENCE: stood})
    found = own.of(LOAD)
    there = FRICTIONLESS + (0.0 if same else 40.0)
    assert found.predicted == pytest.approx(FRICTIONLESS * ONE)
    assert found.measured == pytest.approx((there + 70.0) * ONE)
    assert found.gap == pytest.approx((there - FRICTIONLESS + 70.0) * ONE)
    assert found.simulated == pytest.approx((900.0 - 70.0) * ONE)


@pytest.mark.parametrize("tension", [False, True])
def test_a_simulation_knew_its_own_radius_and_load_and_the_wire_as_it_swings_now(monkeypatch, tension):
    """On a lever that is a tenth of a metre longer over a gear of 100 it moved the load by so much more."""
    told = SuspendedLoad(2000.0 * ONE, 1.081 * ONE, 0.01081 * ONE, 9.0 * ONE, 0.0 * ONE, tension)
    asked = []
    monkeypatch.setattr(module, "load_of", lambda grid, motion, crane, mass: asked.append((crane, mass)) or told)
    monkeypatch.setattr(Balancing, "_modelled", lambda self, load: (self, load))
    stood = SimpleNamespace(
        model="its model", run="its run", crane="its crane", grid=SimpleNamespace(time=np.arange(3.0), columns={})
    )
    own, _ = balancing(monkeypatch, groups=[group("main", True, 2, 3e-5)])
    own.seen.turning = False
    monkeypatch.setattr(module, "Seen", lambda *own: own)
    there, hung = own._as_simulated(stood, LOAD)
    assert asked == [("its crane", 1000.0)]
    assert (there.run, there.crane, there.model) == ("its run", "its crane", "its model")
    if tension:
        assert hung is told
        return
    assert hung.mass is told.mass
    assert hung.acceleration == pytest.approx((20.0 / 9.81 + 0.001 * 10.0) * ONE)
    assert hung.heave is LOAD.heave


CRANE = SimpleNamespace(gear_ratio=100.0, motor_total=lambda _: 4.0)


@pytest.mark.parametrize(
    ("columns", "error"),
    [
        ({"motor_torque": 50.0 * ONE, "motor_torque_simulated": 45.0 * ONE}, 20.0),  # of each of four motors
        # a rope's force that is simulated too large is a drive's torque that was too small
        ({"rope_force": 7e3 * ONE, "rope_force_simulated": 8e3 * ONE}, 1e3 * 0.9 / 100.0),
        (
            {"main.pressure_a": 2e7 * ONE, "main.pressure_b": 1e6 * ONE, "main.pressure_drop_simulated": 1.7e7 * ONE},
            2 * 3e-5 * 2e6,
        ),
    ],
)
def test_a_simulations_error_is_what_was_measured_beyond_it_at_the_shaft(columns, error):
    run = Run("r", {"time": np.arange(3.0), **columns})
    found = simulated_error(columns, run, [group("main", True, 2, 3e-5)], CRANE, 0.9 * ONE)
    assert found == pytest.approx(error * ONE)


def test_a_drop_that_was_simulated_by_other_displacements_means_as_much_more_torque():
    drop = {"main.pressure_drop_simulated": 1e7 * ONE}
    now, known = [group("main", True, 2, 3e-5), group("p", False, 4, 2e-5)], [group("main", True, 2, 2.5e-5)] * 2
    assert displacement_error(drop, now, known) == pytest.approx(2 * 0.5e-5 * 1e7 * ONE)
    assert displacement_error({}, now, known) == 0.0


def test_a_simulation_stands_for_the_log_and_the_crane_as_the_model_corrected_them(monkeypatch):
    monkeypatch.setattr(
        own_simulation, "corrected", lambda run, crane, model: (f"corrected {run.name}", f"{crane} too")
    )
    columns = {"time": np.arange(3.0), "motor_torque": ONE, "motor_torque_simulated": ONE}
    (found,) = own_simulation.against_simulations([Run("r", columns, metadata={"a": 1})], "model", "crane")
    stood = found.metadata[REFERENCE]
    assert (stood.model, stood.run, stood.crane, found.metadata["a"]) == ("model", "corrected r", "crane too", 1)


# -- what hangs
def moved(wire_mass=0.0, **columns):
    size = len(next(iter(columns.values())))
    grid = SimpleNamespace(time=0.1 * np.arange(size), dt=0.1, columns=columns)
    motion = SimpleNamespace(
        acceleration=np.full(size, 20.0), angle=-100.0 / 0.008 * np.linspace(0.0, 1.0, size), window=5
    )
    crane = SimpleNamespace(gear_ratio=100.0, drum=SimpleNamespace(radius=lambda _: 0.8), wire_mass=wire_mass)
    return load_of(grid, motion, crane, float("nan"))


def test_a_heaving_crane_accelerates_what_hangs_beside_the_rope():
    found = moved(heave_velocity=0.3 * 0.1 * np.arange(60.0))
    assert found.heave == pytest.approx(0.3)
    assert found.acceleration == pytest.approx(0.16 + 0.3)


def test_a_rope_on_a_larger_layer_is_faster_from_there_on():
    """100 rad/s by 0.2 mm of lever: 0.02 m/s, in the 3.1 s of half a turn."""
    layers = np.where(np.arange(400) < 200, 1.0, 2.0)
    grid = SimpleNamespace(time=0.1 * np.arange(400), dt=0.1, columns={"wire_layer": layers})
    motion = SimpleNamespace(acceleration=np.zeros(400), speed=np.full(400, 100.0), angle=10.0 * np.arange(400.0))
    crane = SimpleNamespace(gear_ratio=100.0, drum=SimpleNamespace(radius=lambda layer: 0.78 + 0.02 * layer))
    found = load_of(grid, motion, crane, 5e4)
    assert np.sum(found.acceleration) * 0.1 == pytest.approx(0.02)
    assert not found.heave.any()


def test_a_measured_force_is_a_mass_with_all_that_it_does():
    found = moved(rope_force=np.full(60, 9806.65), heave_velocity=np.arange(60.0))
    assert found.tension_measured
    assert found.mass == pytest.approx(9806.65 / GRAVITY)
    assert not found.acceleration.any()
    assert not found.heave.any()


@pytest.mark.parametrize(
    ("weight", "followed"),
    [(10.0, True), (-10.0, False), (0.0, False), (210.0, False), (190.0, True)],
)
def test_a_constant_mass_has_the_weight_of_the_wire_that_the_motors_turn_pays_out(weight, followed):
    """100 m; a cell above the wire weighs more with it, by no more than 200 kg/m of a wire that nobody knows."""
    rng, length = np.random.default_rng(0), np.linspace(0.0, 100.0, 400)
    mass = 1e6 + weight * length
    found = moved(hook_load=mass + 500.0 * rng.standard_normal(400))
    inside = slice(30, -30)
    wanted = mass if followed else np.full(400, np.median(mass))
    assert found.mass[inside] == pytest.approx(wanted[inside], abs=200.0)


@pytest.mark.parametrize(("weight", "followed"), [(25.0, True), (29.0, True), (31.0, False)])
def test_a_wire_weighs_half_more_than_the_crane_file_says_at_most(weight, followed):
    """20 kg/m there; most of the time little is paid out, and the mass is right at every length."""
    length = 100.0 * np.linspace(0.0, 1.0, 400) ** 4
    mass = 1e6 + weight * length
    found = moved(20.0, hook_load=mass + 50.0 * np.random.default_rng(0).standard_normal(400), wire_out=length)
    wanted = mass if followed else np.full(400, np.median(mass))
    assert found.mass[30:-30] == pytest.approx(wanted[30:-30], abs=30.0)


def test_a_load_that_changes_is_followed():
    mass = np.where(np.arange(400) < 200, 2e4, 3e4)
    found = moved(hook_load=mass.astype(float))
    assert (found.mass[30], found.mass[-30]) == pytest.approx((2e4, 3e4))


@pytest.mark.parametrize(("follows", "length"), [(True, True), (False, None), (None, None)])
def test_a_load_follows_the_length_where_its_mode_says_so_and_none_where_nothing_is_heard(monkeypatch, follows, length):
    asked = []

    class Behind:
        def __init__(self, rigid, dt, own, share):
            asked.append(own)

        def acceleration(self, *mode):
            return ONE

    monkeypatch.setattr(suspended_load, "Hung", Behind)
    paid_out = np.array([50.0, 60.0, 70.0])
    LOAD.on_wire(0.02, Mode(8.0, 0.05, follows), paid_out)
    assert [own is paid_out if length else own for own in asked] == [length] * 2
    assert LOAD.on_wire(0.02, Mode(8.0, 0.05, follows, unheard=True), paid_out) is LOAD


def test_on_a_wire_four_times_as_long_a_load_swings_half_as_fast_by_the_same_damper():
    """Half the frequency, at which one damper is twice the ratio; the mode is that at the median length."""
    time = 0.005 * np.arange(8000)
    length = np.where(np.arange(8000) < 4001, 50.0, 200.0)
    kicks = [np.where((time > at) & (time < at + 0.5), 1.0, 0.0) for at in (1.0, 25.0)]
    first, second = (Hung(kick, 0.005, length).acceleration(8.0, 0.05) for kick in kicks)
    assert first[:4000] == pytest.approx(Hung(kicks[0], 0.005).acceleration(8.0, 0.05)[:4000], abs=1e-9)
    alone = Hung(kicks[1], 0.005).acceleration(4.0, 0.1)
    assert second[5000:] == pytest.approx(alone[5000:], abs=0.02 * np.abs(alone).max())


@pytest.mark.parametrize(("spread", "share", "heavy"), [(0.3, 1.0, True), (0.3, 0.0, False), (0.01, 1.0, None)])
def test_a_wire_is_heavy_where_a_third_of_it_makes_one_stiffness_of_all_runs(spread, share, heavy):
    """Of six lengths; by a spread of next to nothing no mass is told."""
    length = 100.0 * np.exp(spread * np.linspace(-1.0, 1.0, 6) * 2.0)
    wire = 30.0 * length
    hanging = 2e4 + 0.0 * length
    swings = hanging - share * 2.0 / 3.0 * wire
    frequency = np.sqrt(4e8 / length / swings)
    assert heavy_by_tune(frequency, length, hanging, wire) is heavy
