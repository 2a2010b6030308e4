"""A candidate's column is the torque that the error of its transducers adds, port by port."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.candidates.candidate import ALL, ParameterEstimate, Shape, Sides
from winch_friction.discrepancy.candidates.creep import creeping_columns
from winch_friction.discrepancy.candidates.feedback import (
    _swivel,
    bends_over,
    bent_pressure_columns,
    curve_columns,
    feedback_candidates,
    parabola_columns,
    s_shaped_columns,
    warm_parabola_columns,
)
from winch_friction.discrepancy.candidates.signals import (
    bent_columns,
    bowed_warm_columns,
    curved_columns,
    offset_law,
    scale_columns,
    signal_candidates,
    warm_columns,
    warm_scale_columns,
)
from winch_friction.discrepancy.catalogue import all_candidates
from winch_friction.discrepancy.preparation.motors import GroupSignals
from winch_friction.discrepancy.regressors import machine_sizes
from winch_friction.physics.channels import CM3_PER_REV, RPM
from winch_friction.physics.corrections import corrected, straight, unbent, unswung
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.declared_correction import DECLARED
from winch_friction.physics.signals import Run

A, B, SWASH, MOTORS = np.array([2.2e7, 1.1e7, 3.0e6]), np.array([2.5e6, 4.0e6, 9.0e6]), 2.4e-5, 3


def run():
    drop, zero = A - B, np.zeros(3)
    group = GroupSignals("active", MOTORS, drop, A + B, zero, np.full(3, SWASH), True, drop)
    return SimpleNamespace(groups=[group], time=zero)


@pytest.mark.parametrize("port_a", [0.0, 1.0])
@pytest.mark.parametrize(("columns", "power", "error"), [(scale_columns, 1, 1e-3), (curved_columns, 2, 5e-11)])
def test_a_column_is_the_torque_that_the_error_adds(columns, power, error, port_a):
    logged_b = B if port_a else B + error * B**power
    added = MOTORS * SWASH * ((A + error * A**power - logged_b) - (A - B))
    column = columns(run(), {"groups": ALL, "port_a": port_a})
    np.testing.assert_allclose(error * column[:, 0], added, rtol=1e-6)


@pytest.mark.parametrize("error", [5e-10, -5e-10, 1e-20, 0.0])
def test_a_gain_that_grows_is_taken_out_exactly(error):
    np.testing.assert_allclose(straight(A * (1.0 + error * A), error), A, rtol=1e-12)


def machine(motors, swept, gear, radius, inertia=1.54, rpm=2100.0):
    group, speed = SimpleNamespace(count=motors), np.linspace(-rpm, rpm, 2001) * RPM
    return SimpleNamespace(
        constants=(("max_displacement", swept),), groups=[group], gear_ratio=gear, radius=np.array([radius]),
        inertia=inertia, speed=speed, top_speed=float(np.percentile(np.abs(speed), 99)), dt=0.02, channels={},
    )  # fmt: skip


def test_typical_sizes_are_those_of_the_machine():
    reference = machine_sizes([machine(11, 215 * CM3_PER_REV, 250.0, 1.136)])
    for size in reference.values():
        assert size == pytest.approx(1.0, rel=0.01)
    small = machine_sizes([machine(4, 80 * CM3_PER_REV, 150.0, 0.4, 0.14)])
    whole = 4 * 80 / (11 * 215)
    line = next(each for each in all_candidates() if each.name == "line_pressure_drop" and not each.law_name)
    assert line.scale(line.linear[0], small) == pytest.approx(line.linear[0].typical / whole**2)
    churning = next(each for each in all_candidates() if each.name == "churning" and not each.law_name)
    assert churning.scale(churning.linear[0], small) == pytest.approx(churning.linear[0].typical * 80 / 215)
    slow = machine_sizes([machine(4, 80 * CM3_PER_REV, 150.0, 0.4, 0.14, rpm=1000.0)])  # it is stated at 2000 rpm
    assert churning.scale(churning.linear[0], slow) == pytest.approx(
        2.0**1.9 * churning.scale(churning.linear[0], small), rel=0.01
    )
    assert {name for name in slow if slow[name] != pytest.approx(small[name], rel=0.01)} == {"churning"}
    offset = next(each for each in all_candidates() if each.name == "torque_offset")  # of the shaft, by all its motors
    assert offset.plausible * offset.scale(offset.linear[0], reference) == pytest.approx(66.0, rel=0.01)
    assert offset.scale(offset.linear[0], small) == pytest.approx(11.0 * whole)
    # of four motors behind 150 each carries 4.6 times the share of the drum's torque, which is within what is
    # plausible of it anyway: a null with so much "had" a break-away of six times the typical share
    direct = machine_sizes([machine(2, 80 * CM3_PER_REV, 4.6, 0.4)])
    for name in ("presliding", "dwell_stiction"):
        bristle = next(each for each in all_candidates() if each.name == name and not each.law_name)
        force, share = (bristle.scale(p, small) / p.typical for p in bristle.linear)
        assert (force, share) == pytest.approx((80 / 215, 1.0))
        assert bristle.scale(bristle.linear[1], direct) / bristle.linear[1].typical == pytest.approx(
            250 * 11 / (4.6 * 2) / bristle.plausible
        )
    sheave = next(each for each in all_candidates() if each.name == "sheave_bending" and not each.law_name)
    for sizes in (small, direct):  # of the shaft, a share of what it carries, however few motors turn it
        assert sheave.scale(sheave.linear[0], sizes) == sheave.linear[0].typical
    assert machine_sizes([machine(14, 300 * CM3_PER_REV, 300.0, 1.3)])["drum_torque"] == 1.0  # large ones: no less
    assert small["kg*m^2"] == pytest.approx(0.14 / 1.54)
    assert small["kg"] == pytest.approx(whole * (150.0 / 0.4) / (250.0 / 1.136), rel=0.01)
    assert replace(line, own_size=True).scale(line.linear[0], small) == line.linear[0].typical


@pytest.mark.parametrize(
    ("rpm", "more"), [(2000.0, 1.0), (900.0, 1.0), (400.0, 25.0 / 6.0), (120.0, (209.44 / 20.0) ** 2 / 6.0)]
)
def test_what_is_stated_at_a_speed_that_a_motor_never_reaches_may_be_more_there(rpm, more):
    """Churning of a motor of 2800 cm3/rev and 130 rpm was a line "of an implausible size, 30 times what is typical"."""
    laws = {(each.name, each.law_name): each for each in all_candidates()}
    usual, own = (machine_sizes([machine(1, 2800 * CM3_PER_REV, 6.2, 0.5, rpm=each)]) for each in (2100.0, rpm))
    for name in ("line_pressure_drop", "port_turbulence"):
        law = laws[name, ""]
        first = law.linear[0]
        assert law.scale(first, own) == pytest.approx(more * law.scale(first, usual), rel=0.01)


@pytest.mark.parametrize(("rpm", "octaves"), [(2000.0, 0.0), (500.0, 0.0), (300.0, 2.0), (70.0, 4.0)])
def test_laws_of_the_speed_follow_a_motor_of_large_stroke(rpm, octaves):
    """Of 8000 cm3/rev and 70 rpm none of their speeds was within half of its own: no Stribeck curve but the base's."""
    runs = [machine(2, 8000 * CM3_PER_REV, 4.6, 0.5, rpm=rpm)]
    laws = {each.law_name: each for each in all_candidates() if each.law_name}
    for law, slowest in (("stribeck_gauss", 4.0), ("dwell_by_speed", 3.0), ("notch_power", 10.0)):
        name = next(name for name in laws[law].continuous if name[0] in "vw")
        values = [shape.values[name] for shape in laws[law].shapes(runs)]
        assert min(values) == slowest / 2.0**octaves
        parameter = next(p for p in laws[law].term.parameters if p.name == name)
        assert all(parameter.lower < 0.7 * value < parameter.upper for value in values)


@pytest.mark.parametrize(
    ("given", "one", "whole", "inertia", "heavier"),
    [(2053.0, 2.0, 1.0, 3.08, 2.0), (22600.0, 22.0, 2.0, 154.0, 100.0), (300.0, 1.0, 1.0, 0.1, 1.0)]
    + [(None, 1.0, 1.0, 1.54, 1.0)],
)
def test_an_electric_drive_that_carries_like_several_motors_may_lose_as_much(given, one, whole, inertia, heavier):
    """A motor of 215 cm3 gives 1027 N m at 300 bar; a small drive is not held to less than that motor's sizes. Of its
    inertia the share that is believed to be missing is a hydraulic winch's: 1.54 kg m^2 there."""
    gap, used = np.full(400, (given or 0.0) / 4.0), np.full(400, given is not None)
    run = SimpleNamespace(constants=(), groups=[], gap=gap, drive_torque=4.0 * gap, used=used, inertia=inertia)
    sizes = machine_sizes([run])
    assert set(sizes) == {"N*m", "N*m*s/rad", "torque_offset", "direction_asymmetry", "kg*m^2"}
    assert sizes["kg*m^2"] == pytest.approx(heavier)
    assert sizes["N*m"] == sizes["N*m*s/rad"] == pytest.approx(one, rel=0.01)
    assert sizes["torque_offset"] == pytest.approx(whole, rel=0.01)


def test_a_creeping_zero_is_there_after_its_time():
    creeping = SimpleNamespace(**vars(run()) | {"start": 100.0, "time": np.array([0.0, 50.0, 500.0])})
    columns = creeping_columns(creeping, {"groups": ALL, "from": 100.0, "to": 200.0})
    np.testing.assert_allclose(columns[:, 0], MOTORS * SWASH)
    np.testing.assert_allclose(columns[:, 1], MOTORS * SWASH * np.array([0.0, 0.5, 1.0]))


def test_a_feedback_that_drifts_reads_the_oil():
    warm = SimpleNamespace(**vars(run()) | {"channels": {"oil_temperature": np.array([40.0, 50.0, 30.0])}})
    columns = warm_columns(_swivel, warm, {"groups": ALL})
    np.testing.assert_allclose(columns[:, 0], MOTORS * (A - B))
    np.testing.assert_allclose(columns[:, 1], MOTORS * (A - B) * np.array([0.0, 10.0, -10.0]))


def test_a_zero_that_bends_with_the_warmth_has_its_square_and_asks_for_cold_and_warm_oil():
    warm = SimpleNamespace(**vars(run()) | {"channels": {"oil_temperature": np.array([40.0, 50.0, 20.0])}})
    columns = bowed_warm_columns(offset_law, warm, {"groups": ALL})
    np.testing.assert_allclose(columns, MOTORS * SWASH * np.array([[1.0, 0.0, 0.0], [1, 10, 100], [1, -20, 400]]))
    (own,) = [each for each in all_candidates() if each.law_name == "thermal zero that bends"]
    logs = [
        SimpleNamespace(
            channels={"oil_temperature": np.full(3, oil)}, present=frozenset({"oil_temperature"}), groups=[1]
        )
        for oil in (38.0, 44.0, 58.0)
    ]
    assert own.untestable(logs) is None
    assert own.untestable(logs[:2]).needs == "runs of colder and warmer oil"


@pytest.mark.parametrize("port_a", [0.0, 1.0])
def test_a_span_that_shifts_with_the_oil_is_the_torque_that_its_correction_takes_out(port_a):
    oil, gain = np.array([40.0, 55.0, 10.0]), np.array([0.0, 15.0, -30.0])
    warm = SimpleNamespace(**vars(run()) | {"channels": {"oil_temperature": oil}})
    columns = warm_scale_columns(warm, {"groups": ALL, "port_a": port_a})
    np.testing.assert_array_equal(columns[:, :1], scale_columns(run(), {"groups": ALL, "port_a": port_a}))
    shown = (A - B * (1.0 if port_a == 0.0 else 0.0)) * 1e-3 * gain
    np.testing.assert_allclose(1e-3 * columns[:, 1], MOTORS * SWASH * shown, rtol=1e-9)
    name = "pressure_thermal_span_a" if port_a else "pressure_thermal_span"
    assert Correction(name, 1e-3).error(np.zeros(3), oil) == pytest.approx(1e-3 * gain)
    assert DECLARED[name].live
    assert len(DECLARED[name].channels) == 2 - port_a


def test_a_gain_that_bends_is_both_its_parts():
    values = {"groups": ALL, "port_a": 0.0}
    both = bent_columns(run(), values)
    np.testing.assert_array_equal(both[:, :1], scale_columns(run(), values))
    np.testing.assert_array_equal(both[:, 1:], curved_columns(run(), values))


@pytest.mark.parametrize(("name", "period", "tested"), [
    ("signal_delay", 0.05, True), ("signal_delay", 0.2, True), ("signal_delay", 0.3, False),
    ("inertia_error", 0.05, True), ("inertia_error", 0.2, True),
])  # fmt: skip
def test_delays_of_a_sample_and_inertias_are_looked_for_at_any_rate(name, period, tested):
    still = np.zeros(3)
    log = SimpleNamespace(
        dt=period, present=frozenset(), groups=[1], inertia=1.0, acceleration=np.arange(3.0), load=still,
        radius=still, gear_ratio=1.0, load_acceleration=still, gap=np.arange(3.0), used=np.ones(3, bool),
    )  # fmt: skip
    candidate = next(each for each in all_candidates() if each.name == name and not each.law_name)
    assert (candidate.untestable([log]) is None) is tested


@pytest.mark.parametrize("error", [0.02, -0.03])
def test_the_column_of_a_bend_is_the_torque_that_its_correction_takes_out(error):
    """Port by port: beyond the pressure alone, and what port B has there counts against port A."""
    at = 8.0e6
    bent = Correction("pressure_bend", error, beyond=at)
    logged = [true + error * np.maximum(true - at, 0.0) for true in (A, B)]
    for shown, true in zip(logged, (A, B), strict=True):
        np.testing.assert_allclose(unbent(shown, bent), true, rtol=1e-12)
    column = bent_pressure_columns(run(), {"groups": ALL, "beyond": at})
    np.testing.assert_allclose(error * column[:, 1], MOTORS * SWASH * ((logged[0] - logged[1]) - (A - B)), rtol=1e-9)
    np.testing.assert_allclose(column[:, 0], MOTORS * SWASH * (A - B))


@pytest.mark.parametrize("share", [0.15, 0.5, 0.8])
def test_the_column_of_an_s_is_the_torque_that_its_correction_takes_out(share):
    error, stroke = 1.2e-7, SWASH / share  # of a motor that is driven at this share of its stroke
    own = run()
    own.constants = (("max_displacement", stroke),)
    swung = Correction("displacement_s_shape", error, beyond=stroke)
    column = s_shaped_columns(own, {"groups": ALL})[:, 2]
    shown = SWASH + error * column / (MOTORS * (A - B))
    np.testing.assert_allclose(unswung(shown, swung), SWASH, rtol=1e-9)


PARABOLA = {"D_0": 2e-8, "e_D": -3e-3, "D_b": 1.5e-8, "D_T": 4e-10}  # of a motor that sweeps SWASH at half stroke


def shown_by_a_parabola(true, celsius):
    stroke = true / (2.0 * SWASH)
    bow = 4.0 * PARABOLA["D_b"] * stroke * (1.0 - stroke)
    return true * (1.0 + PARABOLA["e_D"]) + PARABOLA["D_0"] + bow + PARABOLA["D_T"] * (celsius - 40.0)


@pytest.mark.parametrize("share", [0.1, 0.45, 0.9])
def test_a_feedback_that_is_wrong_at_both_ends_adds_what_its_columns_say(share):
    own, true = run(), share * 2.0 * SWASH
    own.constants, own.channels = (("max_displacement", 2.0 * SWASH),), {"oil_temperature": np.full(3, 55.0)}
    own.groups = [replace(own.groups[0], displacement=np.full(3, true))]
    added = MOTORS * (A - B) * (shown_by_a_parabola(true, 55.0) - true)
    columns = warm_parabola_columns(own, {"groups": ALL})
    np.testing.assert_allclose(columns @ list(PARABOLA.values()), added, rtol=1e-9)
    np.testing.assert_allclose(parabola_columns(own, {"groups": ALL}), columns[:, :3])


def test_what_a_parabola_says_of_a_feedback_is_taken_out_by_its_corrections(crane_150t, crane2_model):
    law = next(each for each in feedback_candidates() if each.law_name == "a parabola that shifts with the oil")
    sides = Sides(replace(crane_150t, max_displacement=2.0 * SWASH), ("main",), ())
    found = {p.name: ParameterEstimate(PARABOLA[p.name], 1e-3 * abs(PARABOLA[p.name]), p.unit) for p in law.linear}
    corrections = law.corrects(found, Shape("all groups", {"groups": ALL}), sides)
    true = SWASH * np.array([0.2, 0.9, 1.8])
    columns = {
        "time": np.arange(3.0), "motor_speed": np.ones(3), "main.pressure_a": A, "main.pressure_b": B,
        "main.displacement": shown_by_a_parabola(true, 55.0), "oil_temperature": np.full(3, 55.0),
    }  # fmt: skip
    model = replace(crane2_model, corrections=tuple(corrections))
    right, _ = corrected(Run("run", columns), crane_150t, model)
    np.testing.assert_allclose(right["main.displacement"], true, rtol=2e-5)  # the bow bends what the gain has made
    scale = next(each for each in corrections if each.name == "displacement_scale")
    bow = 4.0 * PARABOLA["D_b"] / (2.0 * SWASH)
    assert scale.std == pytest.approx(1e-3 * np.hypot(PARABOLA["e_D"], bow))


@pytest.mark.parametrize(("strokes", "said"), [(3, True), (4, False)])
def test_an_s_needs_a_displacement_more_than_it_has_numbers(strokes, said):
    runs = []
    for share in np.linspace(0.2, 0.9, strokes):
        own = run()
        own.used, own.constants, own.present = np.ones(3, bool), (("max_displacement", SWASH),), frozenset()
        own.groups = [replace(own.groups[0], displacement=np.full(3, share * SWASH))]
        runs.append(own)
    s = next(each for each in feedback_candidates() if each.law_name == "bends twice over the stroke")
    assert (s.untestable(runs) is not None) is said


def test_the_columns_of_a_feedbacks_curve_are_its_zero_and_its_bends():
    at = {"beyond_1": 0.5 * SWASH, "beyond_2": 0.75 * SWASH, "beyond_3": 1.5 * SWASH}
    columns = curve_columns(run(), {"groups": ALL, **at})
    expected = [1.0, 0.5 * SWASH, 0.25 * SWASH, 0.0]
    np.testing.assert_allclose(columns, (A - B)[:, None] * MOTORS * np.array(expected))


def test_where_a_transducer_may_bend_stays_while_the_pressures_are_reckoned_anew():
    own = run()
    own.used, own.constants = np.ones(3, bool), (("max_displacement", 2.0 * SWASH),)
    (found,) = [each for each in bends_over([own, own]) if each.name == "pressure_scale"]
    other = run()
    other.used, other.constants, other.groups[0] = own.used, own.constants, replace(other.groups[0], pressure_sum=A)
    assert [each.label for each in found.shapes([other])] == [each.label for each in found.shapes([own])]


def loaded(*levels):
    """Runs whose high pressure wanders by 1 MPa around a level each, Pa."""
    runs = []
    for k, level in enumerate(levels):
        high = level + 1e6 * np.sin(np.arange(200.0) + k)
        group = GroupSignals("main", MOTORS, high, high, np.zeros(200), np.full(200, SWASH), True, high)
        own = {"constants": (("max_displacement", 2.0 * SWASH),), "used": np.ones(200, bool), "time": np.zeros(200)}
        runs.append(SimpleNamespace(groups=[group], **own))
    return runs


def bends_of(runs):
    return next((each for each in bends_over(runs) if each.name == "pressure_scale"), None)


def test_a_transducer_may_bend_where_few_runs_have_been():
    """Ten of twelve runs are light: a bend at 15 MPa lies beyond nine tenths of what was sampled."""
    runs = loaded(*np.linspace(3e6, 8e6, 10), 20e6, 24e6)
    places = np.array([each.values["beyond"] for each in bends_of(runs).shapes(runs)])
    assert np.abs(places - 15e6).min() < 1.5e6
    assert np.ptp(np.diff(places)) < 1.0  # Pa: one pressure is as likely as another


@pytest.mark.parametrize("levels", [(3e6, 5e6, 6e6, 7e6, 8e6, 24e6), (3e6, 20e6, 21e6, 22e6, 23e6, 24e6)])
def test_what_one_run_alone_has_on_its_side_of_a_bend_is_that_runs_own(levels):
    runs = loaded(*levels)
    places = [each.values["beyond"] for each in bends_of(runs).shapes(runs)]
    reached = np.array(levels) + 1e6 > np.array(places)[:, None], np.array(levels) - 1e6 < np.array(places)[:, None]
    assert places
    assert all(side.sum(axis=1).min() >= 2 for side in reached)


def test_a_bend_that_is_found_is_looked_for_between_its_neighbours_of_the_same_side():
    own = bends_of(runs := loaded(3e6, 5e6, 8e6, 12e6, 16e6, 20e6))
    shapes = own.shapes(runs)
    finer = own.refined(shapes[2]).shapes(runs)
    more = sorted(each.values["beyond"] for each in finer if each not in shapes)
    assert len(more) == 6
    assert shapes[1].values["beyond"] < more[0] < more[-1] < shapes[3].values["beyond"]
    assert len({each.label for each in finer}) == len(finer)
    again = own.refined(shapes[2])
    assert again.refined(shapes[2]) is again


def test_a_feedback_may_bow_by_what_its_zero_may_be_off():
    """Six cubic centimetres of a motor of 250, up within a quarter of the stroke and down again in the next."""
    runs = []
    for share in np.linspace(0.2, 0.9, 8):
        own = run()
        own.used, own.constants = np.ones(3, bool), (("max_displacement", SWASH),)
        own.groups = [replace(own.groups[0], displacement=np.full(3, share * SWASH))]
        runs.append(own)
    (curve,) = [each for each in bends_over(runs) if each.name == "swivel_offset"]
    turn = 2.0 * (6.0 / 250.0) / 0.25
    assert all(curve.plausible * bend.typical >= 0.999 * turn for bend in curve.linear[1:])


@pytest.mark.parametrize(("rate", "small"), [(50.0, True), (26.0, True), (24.0, False), (20.0, False)])
def test_a_delay_within_a_sample_is_how_the_log_was_made(rate, small):
    delay = next(each for each in all_candidates() if each.name == "signal_delay")
    runs = [SimpleNamespace(dt=1.0 / rate, channels={"heave_velocity": np.zeros(3)})]
    labels = [shape.label for shape in delay.shapes(runs)]
    assert {"small, of the speed", "small, of the pressures"} & set(labels) == (
        {"small, of the speed", "small, of the pressures"} if small else set()
    )
    assert delay.untestable(labelled(runs)) is None
    assert "speed late, about 100 ms" in labels


def labelled(runs):
    """The same with what every candidate asks of runs."""
    return [SimpleNamespace(**vars(run), present=frozenset(), groups=[1]) for run in runs]


@pytest.mark.parametrize(
    ("compensated", "law", "told"),
    [
        (5, "bows and shifts with the oil", False),  # three constants for the levels of five runs
        (6, "bows and shifts with the oil", True),
        (5, "bends at a pressure", False),  # two, and where it bends
        (6, "bends at a pressure", True),
        (2, "bows over the stroke", True),
    ],
)
def test_a_law_of_many_constants_needs_runs_that_can_contradict_it(compensated, law, told):
    """They sorted five runs of heave compensation, in which the load was another than the cell said."""
    rng = np.random.default_rng(0)

    def group(balances):
        return SimpleNamespace(
            balances=balances, pressure=rng.uniform(5e6, 3e7, 400), displacement=rng.uniform(2e-5, 3.4e-5, 400),
            name="active" if balances else "passive", pressure_sum=rng.uniform(6e6, 4e7, 400),
        )  # fmt: skip

    runs = [
        SimpleNamespace(
            groups=[group(True), *([group(False)] if k < compensated else [])],
            constants=(("max_displacement", 3.5e-5),),
            used=np.ones(400, bool),
            direction=np.ones(400),
            time=np.arange(400.0),
        )
        for k in range(12)
    ]
    every = [*feedback_candidates(), *signal_candidates(), *bends_over(runs)]
    candidate = next(each for each in every if each.law_name == law)
    labels = [shape.label for shape in candidate.shapes(runs)]
    assert any("passive" in label for label in labels) is told
    assert any("driving" in label for label in labels)  # all twelve have it
