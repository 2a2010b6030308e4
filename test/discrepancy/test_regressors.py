"""From runs and effects to the columns of a regression, by figures: priors, sizes of machines, bounds, tolerances."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy import regressors as module
from winch_friction.discrepancy.candidates.candidate import (
    OF_DRUM,
    OF_WINCH,
    REFERENCE_GEAR,
    REFERENCE_INERTIA,
    REFERENCE_LIFT,
    REFERENCE_MOTOR,
    REFERENCE_MOTORS,
    REFERENCE_PRESSURE,
    Candidate,
    Shape,
)
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.problem import Base
from winch_friction.discrepancy.regressors import (
    CHURNING,
    LINE,
    PORT,
    accounted,
    base_of,
    block_size,
    correction_std,
    key_of,
    layout_of,
    machine_sizes,
    timing_column,
    tolerance_columns,
)
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.friction import FrictionModel, term_named
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.term import Parameter
from winch_friction.physics.friction.terms.effects_motor import REFERENCE_SPEED

COULOMB, VISCOUS = term_named("coulomb"), term_named("viscous")
TARE, SCALE = Correction("tare_load", 100.0, 10.0), Correction("pressure_scale", 0.0)


# -- the base and its prior
def base_at(value, bounds=(0.0, 1e3), std=2.0, held=(), loose=None, corrections=()):
    """The base of a model whose Coulomb friction is 50 N m, expanded around another value of it."""
    model = FrictionModel("m", (COULOMB,), (50.0,), np.array([[std**2]]), {COULOMB.parameters[0].name: bounds})
    return base_of(model, replace(model, values=(value,), bounds={}, corrections=corrections), loose, held)


@pytest.mark.parametrize(
    ("value", "bounds", "shift", "lower", "upper"),
    [
        (50.0, (0.0, 1e3), 0.0, -2.0, 2.0),  # two deviations of 2 N m
        (52.0, (0.0, 1e3), 1.0, -3.0, 1.0),  # around the seed, not around the point of expansion
        (47.0, (0.0, 1e3), -1.5, -0.5, 3.5),
        (52.0, (49.5, 52.5), 1.0, -1.25, 0.25),  # inside what the parameter may be
        (60.0, (0.0, 1e3), 5.0, -7.0, 0.0),  # from beyond it may stay, and come back
        (40.0, (45.0, 1e3), -5.0, 0.0, 7.0),
    ],
)
def test_a_parameter_moves_two_deviations_from_its_seed_inside_its_bounds(value, bounds, shift, lower, upper):
    base = base_at(value, bounds)
    assert (base.scale[0], base.shift[0], base.lower[0], base.upper[0]) == pytest.approx((2.0, shift, lower, upper))
    assert (base.parameters, base.shift[1:].tolist()) == (1, [0.0] * (len(base.names) - 1))


@pytest.mark.parametrize(("std", "loose", "scale"), [(0.0, None, 10.0), (2.0, 7.0, 7.0), (2.0, 0.0, 10.0)])
def test_what_states_no_deviation_has_a_fifth_of_its_size_and_what_is_loose_its_own(std, loose, scale):
    name = COULOMB.parameters[0].name
    assert base_at(50.0, std=std, loose={} if loose is None else {name: loose}).scale[0] == pytest.approx(scale)


def test_what_every_measurement_is_off_by_without_being_wrong():
    """Bounds in the tolerance's unit: a thousandth of the weight, a hundredth of the inertia, from a third of a sample
    early to six tenths late, a step of 0.15 bar either way, and from none to all of the rope's true tension."""
    base = base_at(50.0)
    bounds = {name: (low * std, high * std) for name, low, high, std in zip(
        base.names[1:], base.lower[1:], base.upper[1:], base.scale[1:], strict=True)}  # fmt: skip
    assert bounds == {
        "weight": pytest.approx((-1e-3, 1e-3)), "inertia": pytest.approx((-0.01, 0.01)),
        "timing": pytest.approx((-0.35, 0.6)), "zero": pytest.approx((-0.15, 0.15)),
        "passive zero": pytest.approx((-0.15, 0.15)), "tension": pytest.approx((0.0, 1.0)),
    }  # fmt: skip
    assert list(base.scale[1:]) == pytest.approx([5e-4, 5e-3, 0.3, 0.05, 0.05, 0.5])
    assert base.names[base.skew] == "timing"


def test_a_tolerance_that_is_held_has_no_room_and_the_others_have_theirs():
    held, free = base_at(50.0, held=("timing",)), base_at(50.0)
    off = held.scale / free.scale
    assert off[held.skew] < 1e-5
    assert np.delete(off, held.skew).tolist() == [1.0] * (len(off) - 1)
    assert held.lower.tolist() == free.lower.tolist()


def test_a_models_corrections_may_move_by_two_of_their_own_deviations():
    base = base_at(50.0, corrections=(TARE, SCALE), loose={key_of(TARE): 30.0})
    assert base.names[-2:] == (key_of(TARE), key_of(SCALE))
    assert base.scale[-2:] == pytest.approx([30.0, correction_std(SCALE)])
    assert (base.lower[-2:].tolist(), base.upper[-2:].tolist()) == ([-2.0, -2.0], [2.0, 2.0])
    assert base_at(50.0, corrections=(TARE,)).scale[-1] == 10.0


@pytest.mark.parametrize(("value", "shift", "lower", "upper"), [(115.0, 1.5, -3.5, 0.5), (150.0, 5.0, -7.0, 0.0)])
def test_a_correction_moves_two_deviations_from_what_the_model_says_of_it(value, shift, lower, upper):
    """Step by step a zero check of 1.5 +- 0.1 bar became 0.05 bar, and nothing was missing."""
    model = FrictionModel("m", (COULOMB,), (50.0,), np.eye(1), corrections=(TARE,))
    base = base_of(model, replace(model, corrections=(replace(TARE, value=value), SCALE)))
    assert (base.shift[-2], base.lower[-2], base.upper[-2]) == pytest.approx((shift, lower, upper))
    assert (base.shift[-1], base.lower[-1], base.upper[-1]) == (0.0, -2.0, 2.0)  # new: around where it was found


@pytest.mark.parametrize(("value", "share"), [(0.0, 0.02), (0.05, 1.0), (-0.05, 1.0)])
def test_a_correction_without_a_deviation_is_uncertain_by_a_fifth_of_itself_or_of_a_tenth_of_a_typical_one(
    value, share
):
    typical = SCALE.declared.parameter.typical
    wanted = 0.2 * abs(value) if value else share * typical
    assert correction_std(replace(SCALE, value=value)) == pytest.approx(wanted)


def test_a_corrections_name_holds_all_that_it_is_restricted_to():
    radius, during = Correction("layer_radius", 0.0), ((1.0, 2.0),)
    every = [SCALE, replace(SCALE, groups=("main",)), TARE, replace(TARE, during=during)]
    every += [radius, replace(radius, layers=(2,)), replace(radius, layers=(3,))]
    assert len(set(map(key_of, every))) == 7
    assert key_of(Correction("pressure_bend", 0.0, beyond=1e7)) != key_of(Correction("pressure_bend", 0.0, beyond=2e7))


# -- how large things are on a machine
def turning(motors=(20, 2), radius=1.0, speed=REFERENCE_SPEED, gear=440.0, swept=2.0):
    return SimpleNamespace(
        groups=[SimpleNamespace(count=count) for count in motors], gear_ratio=gear, radius=np.array([0.5, radius]),
        constants=(("max_displacement", swept * REFERENCE_MOTOR),), speed=np.full(9, -speed),
        inertia=3.0 * REFERENCE_INERTIA,
    )  # fmt: skip


def test_sizes_go_with_the_motors_their_number_the_lift_and_the_inertia():
    """Twice as many motors of twice the displacement, on a gear and a radius that lift as much of the motor's turns."""
    found = machine_sizes([turning((3,)), turning(radius=440.0 / REFERENCE_LIFT)])
    assert found["N*m"] == found["m^3/rad"] == pytest.approx(2.0)
    assert [found[name] for name in OF_WINCH] == pytest.approx([4.0, 4.0])
    assert found["kg"] == found["kg/m"] == pytest.approx(4.0)
    assert found["kg*m^2"] == pytest.approx(3.0)
    assert found[LINE] == pytest.approx(1.0 / 16.0)  # at a fixed flow, by its square
    assert (found[PORT], found[CHURNING], found[OF_DRUM]) == pytest.approx((2.0, 2.0, 1.0))
    larger = machine_sizes([turning(radius=2.0), turning(radius=4.0)])
    assert larger["kg"] == larger["kg/m"] == pytest.approx(4.0 * 440.0 / 4.0 / REFERENCE_LIFT)


@pytest.mark.parametrize(("speed", "slow"), [(REFERENCE_SPEED / 4.0, 4.0), (3.0, REFERENCE_SPEED / 20.0)])
def test_what_is_stated_at_a_fixed_speed_is_as_much_at_a_slow_machines_top(speed, slow):
    """A churning by the power 1.9; of what goes with the square six times are plausible anywhere. One run is slower."""
    found = machine_sizes([turning(speed=speed), turning(speed=0.5 * speed)])
    assert found[CHURNING] == pytest.approx(2.0 * slow**1.9)
    assert found[PORT] == pytest.approx(2.0 * slow**2 / 6.0)
    assert found[LINE] == pytest.approx(slow**2 / 6.0 / 16.0)


def test_a_share_of_the_drums_torque_is_larger_where_fewer_motors_turn_slower():
    found = machine_sizes([turning((1,), gear=20.0)])
    assert found[OF_DRUM] == pytest.approx(REFERENCE_GEAR * REFERENCE_MOTORS / (6.0 * 20.0))


@pytest.mark.parametrize(("given", "one"), [(3.0, 3.0), (22.0, 22.0), (0.5, 1.0)])
def test_without_pressures_torques_go_with_the_largest_that_was_given_in_the_regime(given, one):
    """In motors of the reference; an outlier at rest is none, and no machine is smaller than one motor."""
    motor = REFERENCE_MOTOR * REFERENCE_PRESSURE
    used = np.arange(50) > 0
    run = SimpleNamespace(
        groups=[], constants=(), used=used, drive_torque=np.where(used, -given * motor, 1e3 * motor),
        inertia=0.5 * REFERENCE_INERTIA,
    )  # fmt: skip
    small = replace_in(run, drive_torque=0.1 * run.drive_torque)
    found = machine_sizes([small, run, replace_in(run, used=np.zeros(50, bool))])
    assert (found["N*m"], found["N*m*s/rad"]) == pytest.approx((one, one))
    assert [found[name] for name in OF_WINCH] == pytest.approx([max(one / REFERENCE_MOTORS, 1.0)] * len(OF_WINCH))
    assert found["kg*m^2"] == 1.0
    assert machine_sizes([replace_in(run, inertia=5.0 * REFERENCE_INERTIA)])["kg*m^2"] == pytest.approx(5.0)


def replace_in(run, **changes):
    return SimpleNamespace(**{**vars(run), **changes})


# -- what a candidate may be
BASE = Base(("C2", "weight"), 1, np.array([2.0, 5e-4]), np.zeros(2), -np.ones(2), np.ones(2))
MASS = Parameter("m", "kg", 2000.0, lower=-2e4, upper=2e4)


def laid_out(monkeypatch, *candidates, model=None, sizes=None):
    monkeypatch.setattr(module, "machine_sizes", lambda _: sizes or {})
    model = model or FrictionModel("m", (COULOMB,), (50.0,), np.eye(1))
    return layout_of(BASE, candidates, [], model)


@pytest.mark.parametrize(
    ("parameter", "more", "scale", "bounds"),
    [
        (MASS, {}, 2000.0, (-6.0, 6.0)),
        (MASS, {"plausible": 30.0}, 2000.0, (-30.0, 30.0)),
        (replace(MASS, lower=0.0), {}, 2000.0, (0.0, 6.0)),  # of one sign
        (replace(MASS, typical=-3.0, lower=-9.0, upper=0.0), {}, -3.0, (0.0, 6.0)),  # a curve that may only fall
        (replace(MASS, typical=-3.0, lower=-9.0, upper=1.0), {}, -3.0, (-6.0, 6.0)),
        (Parameter("e", "1", 0.01, -0.02, 0.05), {"corrects": len}, 0.01, (-2.0, 5.0)),  # no more than is declared
        (Parameter("e", "1", 0.01, -0.2, 0.2), {"corrects": len}, 0.01, (-6.0, 6.0)),
        (Parameter("e", "1", 0.01, -0.02, 0.05), {}, 0.01, (-6.0, 6.0)),
        (MASS, {"shapes": lambda _: [Shape("", bounds=(0.5, 2.0))]}, 2000.0, (0.5, 2.0)),
    ],
)
def test_an_amplitude_is_of_typical_sizes_and_as_large_as_is_believed(monkeypatch, parameter, more, scale, bounds):
    layout = laid_out(monkeypatch, Candidate("wave", "", (parameter,), **more))
    assert layout.scales.tolist() == [2.0, 5e-4, scale]
    assert (layout.lower[2], layout.upper[2]) == pytest.approx(bounds)
    assert layout.bending is None


@pytest.mark.parametrize(("value", "scale"), [(1e-6, 1.0), (500.0, 500.0), (-500.0, 500.0)])
def test_what_the_model_has_already_may_change_by_as_much_as_it_is_and_either_way(monkeypatch, value, scale):
    (own,) = COULOMB.parameters
    model = FrictionModel("m", (COULOMB, VISCOUS), (value, 1.0), np.eye(2), {own.name: (-1e9, 1e9)})
    both = [Candidate(each.name, "", each.parameters, term=each) for each in (COULOMB, term_named("brake_drag"))]
    layout = laid_out(monkeypatch, *both, model=model)
    assert layout.scales[2] == pytest.approx(max(abs(own.typical), abs(value)) if scale > 1.0 else own.typical)
    assert layout.lower[2:].tolist() == [-6.0, 0.0]


def test_columns_stand_behind_the_base_those_of_each_shape_together(monkeypatch):
    shapes = lambda _: [Shape("one", {"groups": 1.0}), Shape("two", {"groups": 2.0})]
    own = Candidate("wave", "", (MASS, replace(MASS, name="n", typical=1.0)), shapes=shapes, law_name="bent", free=True,
                    brings=("level",), plausible=9.0, plain=True)  # fmt: skip
    layout = laid_out(monkeypatch, own, Candidate("other", "", (MASS,)), sizes={"kg": 3.0})
    first, second, other = layout.slots
    assert [slot.columns for slot in layout.slots] == [(2, 3), (4, 5), (6,)]
    assert layout.scales[2:].tolist() == [6000.0, 3.0, 6000.0, 3.0, 6000.0]
    assert (first.name, first.label, first.law, first.part, first.brings) == ("wave", "one", "bent", "1", ("level",))
    assert (second.label, second.part, second.most, second.free, second.plain) == ("two", "2", 9.0, True, True)
    assert (other.free, other.plain, other.most) == (False, False, 6.0)
    assert layout.upper[2] == LIMITS.unbounded  # what a bare model lacks is of any size


# -- tolerances as columns
def moving(dt=0.02, **more):
    own = {
        "time": np.zeros(2), "load": np.array([4e4, 2e4]), "radius": np.array([1.0, 1.5]), "gear_ratio": 100.0,
        "inertia": 2.0, "acceleration": np.array([3.0, -1.0]), "dt": dt, "corrections": np.array([[7.0], [8.0]]),
        "load_friction": np.array([50.0, -50.0]), "load_acceleration": GRAVITY * np.array([0.1, 0.2]),
        "rated_torque": 900.0,
        "groups": [SimpleNamespace(balances=b, of_zero=lambda step, b=b: np.full(2, 20.0 if b else 3.0) * step)
                   for b in (True, False, False)],
    }  # fmt: skip
    return SimpleNamespace(**{**own, **more})


@pytest.mark.parametrize(("dt", "unsure"), [(0.02, 1.0), (0.055, 1.0), (0.1, 15.0)])
def test_a_tolerances_column_is_the_torque_of_one_unit_of_it(monkeypatch, dt, unsure):
    """A sparse log hardly knows its acceleration; a zero is that of the driving group's transducers or the others'."""
    monkeypatch.setattr(module, "timing_column", lambda _: np.array([0.5, 0.6]))
    weight = 4e4 / 100.0 * GRAVITY
    np.testing.assert_allclose(
        tolerance_columns(moving(dt)),
        [
            [weight, 6.0 * unsure, 0.5, 20.0 * 0.15, 6.0 * 0.15, 5.0, 7.0],
            [0.75 * weight, -2.0 * unsure, 0.6, 20.0 * 0.15, 6.0 * 0.15, -10.0, 8.0],
        ],
    )
    electric = tolerance_columns(moving(dt, groups=[]))
    assert electric[:, 3] == pytest.approx(1e-3 * 900.0 / 0.1)  # a step is a thousandth of the rated torque
    assert electric[:, 4] == pytest.approx(0.0)


@pytest.mark.parametrize(("dt", "column"), [(0.005, 0.06), (0.02, 0.06), (0.1, 0.3)])
def test_a_fast_log_is_no_better_in_step_than_a_usual_one(monkeypatch, dt, column):
    asked = []
    monkeypatch.setattr(module, "delay_columns", lambda *own: asked.append(own) or np.full((2, 1), 3.0))
    run = SimpleNamespace(dt=dt)
    assert timing_column(run) == pytest.approx(column)
    assert asked == [(run, module.SMALL_DELAY)]


@pytest.mark.parametrize(("dt", "samples"), [(0.01, 20), (0.05, 4), (0.055, 4), (0.07, 3), (0.9, 1)])
def test_a_block_is_a_fifth_of_a_second(dt, samples):
    assert block_size(SimpleNamespace(dt=dt)) == samples


@pytest.mark.parametrize(
    ("present", "groups", "column"), [((), 1, 1), (("hook_load",), 1, None), ((), 0, None), (("wire_out",), 1, 1)]
)
def test_what_a_weight_could_explain_is_taken_out_where_nobody_weighed_a_hydraulic_winchs_load(
    monkeypatch, present, groups, column
):
    taken = []
    monkeypatch.setattr(module, "run_blocks", lambda *each: "table" * (each[-1] == "made"))
    monkeypatch.setattr(module, "regressors", lambda *_: ())
    monkeypatch.setattr(module, "without_column", lambda table, at: taken.append((table, at)) or "less")
    run = SimpleNamespace(
        time=None, gap=np.ones(1), unit_torque=2.0, used=None, direction=None, channels=None, present=present,
        groups=("main",) * groups, means={}, made=lambda size: "made",
    )  # fmt: skip
    layout = SimpleNamespace(base=BASE, slots=())
    found = module._blocks(run, layout, 1, 1.0, np.empty((2, 1)), False)
    assert (taken, found) == (([("table", column)], "less") if column else ([], "table"))
    assert BASE.names[1] == "weight"


# -- what is accounted for already
@pytest.mark.parametrize(
    ("kind", "carried", "of_stroke", "where"),
    [
        ("friction", False, False, "missing_torque"),
        ("load", False, False, "missing_torque"),
        ("signal", False, False, ""),  # the driving motors' own signals: they carry what they carried
        ("signal", False, True, ""),
        ("signal", True, False, "passive_error"),
        ("signal", True, True, "passive_stroke_error"),
    ],
)
def test_an_effect_is_accounted_for_where_it_changes_what_the_driving_motors_carry(
    monkeypatch, kind, carried, of_stroke, where
):
    """The second of three effects, of two amounts: 5 and 7 of scales of 10 and 100."""
    slots = [
        Slot(name, "", columns, origin=(Candidate(name, kind=own, of_stroke=of_stroke), Shape("", carried=carried)))
        for name, columns, own in (("first", (2, 3), "signal"), ("second", (4, 5), kind), ("third", (6,), "load"))
    ]
    columns = {"first": np.zeros((3, 2)), "second": np.array([[1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])}
    columns["third"] = np.zeros((3, 1))
    monkeypatch.setattr(module, "slot_columns", lambda run, slot: columns[slot.name])
    layout = SimpleNamespace(base=BASE, scales=np.array([9.0, 9.0, 9.0, 9.0, 10.0, 100.0, 9.0]))
    explanation = SimpleNamespace(slots=slots, beta=np.array([1.0, 1.0, 2.0, 3.0, 5.0, 7.0, 4.0]))
    found = accounted(SimpleNamespace(time=np.zeros(3)), layout, explanation)
    for name in ("missing_torque", "passive_error", "passive_stroke_error"):
        assert getattr(found, name).tolist() == ([50.0, 700.0, 750.0] if name == where else [0.0] * 3)


@pytest.mark.parametrize(("given", "rated", "least"), [(300.0, 900.0, 0.45), (-1200.0, 900.0, 0.6)])
def test_a_drive_without_pressures_closes_to_a_thousandth_in_the_unit_of_its_gap(given, rated, least):
    run = SimpleNamespace(groups=[], drive_torque=np.full(4, given), rated_torque=rated, unit_torque=2.0)
    assert module.least_noise_of(run) == pytest.approx(least)


def test_places_of_a_models_own_curve_bend_by_what_they_are_worth_beside_each_other(monkeypatch):
    """Scales of 1, 2 and 4, of a median of 2: a place with half the scale moves half as much per unit."""
    monkeypatch.setattr(module, "bending", lambda _: np.ones((3, 3)))
    parameters = tuple(SimpleNamespace(name=name) for name in ("level", "a", "b", "c"))
    model = SimpleNamespace(
        parameter_names=("C2", "level", "c", "b", "a"),
        terms=[SimpleNamespace(table=None), SimpleNamespace(table="table", parameters=parameters)],
    )
    ((columns, form),) = module._curves_of(model, np.array([9.0, 9.0, 4.0, 2.0, 1.0]))
    assert columns == (4, 3, 2)
    np.testing.assert_allclose(form, np.outer([0.5, 1.0, 2.0], [0.5, 1.0, 2.0]))
