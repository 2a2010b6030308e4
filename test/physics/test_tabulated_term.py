"""A tabulated term is a term like any other: file, arrays, scalars, kernel, Jacobian, LaTeX."""

from dataclasses import replace

import numpy as np
import pytest

from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel, Scope, term_named
from winch_friction.physics.friction.compiled import compiled, layout
from winch_friction.physics.friction.table import FACTORS, Table, at_knots, in_windows, outlined, tabulated
from winch_friction.records.model_file import model_from_text, model_to_text

WARM = Table(
    "warm_grip", (("oil_temperature", (20.0, 35.0, 60.0)),), "N*m*s/rad", ("speed_magnitude",), Scope.SYSTEM,
    shape="falling", anchor="high",
)  # fmt: skip
SURFACE = Table(
    "swash_map", (("pressure", (50e5, 150e5, 250e5)), ("displacement", (1e-5, 2e-5, 3.4e-5))), scope=Scope.MOTOR,
    shape="rising",
)  # fmt: skip


def _model(*tables, values=None):
    terms = (term_named("coulomb"), *(tabulated(each) for each in tables))
    count = sum(len(term.parameters) for term in terms)
    return FrictionModel("m", terms, tuple(values or [3.0] * count))


def _point(**signals):
    at = {symbol.name: 0.0 for symbol in layout(1)} | {"s": 1.0, "N": 11.0, "n_{0}": 11.0}
    named = {"w": "w", "celsius": r"\vartheta", "p": "p_{0}", "D": "D_{0}"}
    return tuple((at | {named[k]: v for k, v in signals.items()})[symbol.name] for symbol in layout(1))


def test_the_curve_is_linear_between_its_knots_and_constant_beyond_them():
    functions = _model(WARM, values=[0.0, 0.02, 0.01]).compile(1)
    for celsius, expected in (
        (0.0, 0.03),
        (20.0, 0.03),
        (27.5, 0.02),
        (35.0, 0.01),
        (47.5, 0.005),
        (60, 0.0),
        (90, 0.0),
    ):
        torque = functions.scalar_torque(_point(w=100.0, celsius=celsius), (0.0, 0.02, 0.01), ())
        assert torque == pytest.approx(11 * 100.0 * expected), celsius


def test_a_curve_over_the_flow_reads_motors_speed_and_displacement():
    """The same flow by other speeds gives the same pressure, and pressure times displacement is the torque."""
    valve = Table(
        "valve", (("flow", (0.0, 0.01, 0.03)),), "Pa", ("displacement",), Scope.MOTOR, shape="rising", anchor="low"
    )
    model = _model(valve, values=[0.0, 1e5, 3e5])
    again = model_from_text(model_to_text(model))
    for functions in (model.compile(1), again.compile(1)):
        for w, D in ((100.0, 2e-5), (200.0, 1e-5)):  # 11 motors: 0.022 m^3/s
            torque = functions.scalar_torque(_point(w=w, D=D), (0.0, 1e5, 3e5), ())
            assert torque == pytest.approx(11 * D * (1e5 + 0.6 * 3e5))


@pytest.mark.parametrize(("shape", "anchor"), [
    ("rising", "low"), ("rising", "none"), ("falling", "high"), ("falling", "low"), ("convex_rising", "none"),
    ("convex_rising", "low"), ("free", "none"),
])  # fmt: skip
def test_the_values_at_the_knots_are_those_of_the_term(shape, anchor):
    table = Table(
        "curve", (("oil_temperature", (20.0, 35.0, 60.0)),), "N*m", (), Scope.SHAFT, shape=shape, anchor=anchor
    )
    matrix = at_knots(table)
    rises = np.linspace(0.5, 2.0, matrix.shape[1]) * (-1.0 if (shape, anchor) == ("falling", "low") else 1.0)
    model = FrictionModel("m", (tabulated(table),), tuple(rises))
    functions = model.compile(1)
    found = [functions.scalar_torque(_point(w=1.0, celsius=at), tuple(rises), ()) for at in (20.0, 35.0, 60.0)]
    np.testing.assert_allclose(matrix @ rises, found, rtol=1e-12)


def test_scalar_arrays_and_kernel_agree():
    model = _model(WARM, SURFACE)
    functions = model.compile(1)
    rng = np.random.default_rng(1)
    theta = tuple(rng.uniform(0.1, 2.0, len(model.values)))
    points = [
        _point(w=rng.uniform(0, 200), celsius=rng.uniform(10, 70), p=rng.uniform(0, 3e7), D=rng.uniform(0, 4e-5))
        for _ in range(50)
    ]
    columns = tuple(np.array(points).T)
    many = functions.vector_torque(columns, theta, ())
    assert many == pytest.approx([functions.scalar_torque(x, theta, ()) for x in points])
    assert many == pytest.approx([functions.kernel(x, theta, ()) for x in points])
    gradient = np.array([np.broadcast_to(g, 50) for g in functions.vector_gradient(columns, theta, ())]).T
    whole = [functions.scalar_torque_and_gradient(x, theta, ()) for x in points]
    assert gradient == pytest.approx(np.array(whole)[:, 2:])
    assert gradient @ np.array(theta) == pytest.approx(many)  # linear in its parameters


def test_bounds_make_it_monotone():
    term = tabulated(SURFACE)
    assert len(term.parameters) == 9
    assert all(p.lower == 0.0 for p in term.parameters[1:])
    assert set(term.reads) == {"direction", "pressure", "displacement"}
    assert all(p.lower == 0.0 for p in tabulated(WARM).parameters)  # what is still to come of a falling curve


MIXED = Table(
    "grip_map", (("pressure", (50e5, 150e5, 250e5)), ("speed_magnitude", (10.0, 60.0, 160.0))), scope=Scope.MOTOR,
    shape="rising falling", anchor="low none", side="hoisting",
)  # fmt: skip
SMALL = Table(
    "swash_curve", (("pressure", (50e5, 150e5, 250e5)),), "Pa", ("displacement_left",), Scope.MOTOR,
    shape="convex_rising", anchor="low",
)  # fmt: skip


def test_a_surface_may_rise_with_one_signal_and_fall_with_the_other_and_is_never_negative():
    term = tabulated(MIXED)
    assert [p.name for p in term.parameters] == [f"grip_map_{k}_{m}" for k in (1, 2) for m in (0, 1, 2)]
    assert all((p.lower, p.upper) == (0.0, float("inf")) for p in term.parameters)
    functions = _model(MIXED).compile(1)
    rng = np.random.default_rng(2)
    theta = (0.0, *rng.uniform(0.1, 2.0, 6))

    def at(p, w, s=1.0):
        return functions.scalar_torque(tuple(s if k == 0 else v for k, v in enumerate(_point(w=w, p=p))), theta, ())

    grid = np.array([[at(p, w) for w in (5.0, 30.0, 90.0, 200.0)] for p in (30e5, 90e5, 180e5, 300e5)])
    assert np.all(grid[0] == 0.0)  # anchored at the least pressure
    assert np.all(np.diff(grid, axis=0)[:, :-1] > 0.0)
    assert np.all(np.diff(grid, axis=1)[1:] < 0.0)
    assert np.all(grid[1:] > 0.0)
    assert at(180e5, 30.0, -1.0) == 0.0  # lowering it does not count


def test_a_curve_may_be_times_the_displacement_that_is_left():
    model = FrictionModel("m", (tabulated(SMALL),), (2.0, 0.0), constants={"max_displacement": 3e-5})
    functions = model.compile(1)
    for displacement, pressure, expected in ((1e-5, 150e5, 0.5), (3e-5, 150e5, 0.0), (1e-5, 50e5, 0.0)):
        torque = functions.scalar_torque(_point(p=pressure, D=displacement), (2.0, 0.0), ())
        assert torque == pytest.approx(11 * 2.0 * 2e-5 * expected), (displacement, pressure)


def test_the_model_file_carries_it_whole():
    model = _model(WARM, SURFACE, MIXED, SMALL)
    again = model_from_text(model_to_text(model))
    assert again.terms == model.terms
    assert again.values == model.values
    assert [p.unit for p in again.parameters] == [p.unit for p in model.parameters]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"knots": {"oil_temperature": [20.0, 20.0]}}, "must be at least two and rising"),
        ({"knots": {"moon": [1.0, 2.0]}}, "signal 'moon' is not known"),
        ({"scope": "moon"}, "scope 'moon' is none of"),
        ({"shape": "round"}, "shape 'round' is none of"),
        ({"shape": "rising falling"}, "must be one word, or one for each of oil_temperature"),
        ({"side": "sideways"}, "side 'sideways' is none of"),
        ({"times": ["moon"]}, "factor 'moon' is not known"),
        ({"times": []}, r"unit N\*m\*s/rad times 1 is not N\*m"),
        ({"colour": "red"}, "unknown key 'colour'"),
    ],
)
def test_a_wrong_table_is_refused_in_one_line(change, said):
    import yaml

    content = yaml.safe_load(model_to_text(_model(WARM)))
    content["tables"]["warm_grip"] |= change
    with pytest.raises(InputError, match=said) as refused:
        model_from_text(yaml.safe_dump(content))
    assert "\n" not in str(refused.value)


def test_a_table_may_not_take_a_declared_terms_name():
    text = model_to_text(_model(WARM)).replace("warm_grip", "churning")
    with pytest.raises(InputError, match="'churning' exists already"):
        model_from_text(text)


def test_latex_and_limits():
    assert "vartheta" in tabulated(WARM).latex
    with pytest.raises(InputError, match="one or 2 different signals"):
        Table("t", ())


def test_windows_are_one_level_there_and_nothing_elsewhere():
    hangs = Table("hangs", (("time", (10.0, 20.0, 40.0, 50.0)),), scope=Scope.SYSTEM, shape="windows")
    model = _model(hangs, values=[0.0, 4.0])
    again = model_from_text(model_to_text(model), "m")
    at = layout(1).index(next(each for each in layout(1) if each.name == "t"))
    for functions in (model.compile(1), again.compile(1)):
        for time, expected in ((9.0, 0.0), (10.5, 4.0), (20.5, 0.0), (45.0, 4.0), (60.0, 0.0)):
            point = tuple(time if k == at else value for k, value in enumerate(_point()))
            assert functions.scalar_torque(point, (0.0, 4.0), ()) == pytest.approx(11.0 * expected), time
    with pytest.raises(InputError, match="a knot at either end"):
        Table("hangs", (("time", (10.0, 20.0, 40.0)),), shape="windows")


def test_windows_may_have_so_many_times_the_level_each():
    windows = ("time", (10.0, 20.0, 40.0, 50.0, 60.0, 70.0))
    drags = Table("drags", (windows,), scope=Scope.SYSTEM, shape="windows", weights=(0.25, 1.0, 0.0))
    model = _model(drags, values=[0.0, 4.0])
    again = model_from_text(model_to_text(model), "m")
    assert again.terms[-1].table == drags
    at = layout(1).index(next(each for each in layout(1) if each.name == "t"))
    for functions in (model.compile(1), again.compile(1)):
        for time, expected in ((9.0, 0.0), (10.5, 1.0), (20.5, 0.0), (45.0, 4.0), (65.0, 0.0)):
            point = tuple(time if k == at else value for k, value in enumerate(_point()))
            assert functions.scalar_torque(point, (0.0, 4.0), ()) == pytest.approx(11.0 * expected), time
    for weights, shape, said in (
        ((1.0,), "windows", "one for each of the windows"),
        ((1.0, -0.5, 0.0), "windows", "0 or more"),
        ((1.0, float("nan"), 0.0), "windows", "0 or more"),
        ((1.0, 1.0, 1.0), "free", "one for each of the windows"),
    ):
        with pytest.raises(InputError, match=said):
            Table("drags", (windows,), shape=shape, weights=weights)


def test_windows_are_told_in_words():
    """Two dozen of them were as many nested steps."""
    knots = tuple(1.7e9 + 100.0 * k for k in range(47))
    long = Table("drags", (("time", (*knots, float("inf"))),), scope=Scope.SYSTEM, shape="windows",
                 weights=(0.0, 0.25, *(1.0,) * 22))  # fmt: skip
    told = tabulated(long).latex
    assert told.startswith(r"drags_{0} s m{\left(t \right)},\quad m{\left(t \right)} = \text{0.25 from 1700000200 to ")
    assert told.endswith("1 from 1700004400 to 1700004500 s, 1 after 1700004600 s, 0 elsewhere}")
    assert "cases" not in told
    assert tabulated(replace(WEIGHED, times=("wire_out",), unit="N")).latex.startswith("L s weighed_{0} m{")
    assert "cases" in tabulated(WARM).latex


HINGES = Table(
    "hinges", (("speed_magnitude", (5.0, 40.0, 90.0)),), scope=Scope.SYSTEM, shape="convex_rising", anchor="low"
)
WINDOW = Table("window", (("wire_out", (20.0, 55.0)),), shape="windows")
WEIGHED = replace(WINDOW, name="weighed", knots=(("wire_out", (20.0, 55.0, 60.0, 90.0)),), weights=(0.3, 1.0))


@pytest.mark.parametrize("table", [WARM, SURFACE, HINGES, WINDOW, WEIGHED], ids=lambda table: table.name)
def test_one_outline_serves_every_table_of_its_form(table):
    constants = (("gear_ratio", 250.0), ("max_displacement", 3.4e-5))
    moved = replace(table, knots=tuple((name, tuple(1.07 * k for k in at)) for name, at in table.knots), typical=2.0)
    term, _ = outlined(table)
    assert outlined(moved)[0] is term  # so that what is compiled of it is found again
    rng = np.random.default_rng(3)
    x = [rng.uniform(0.0, 1.3, 400) for _ in layout(2)]
    for symbol, values in zip(layout(2), x, strict=True):
        values *= {"w": 100.0, "l": 80.0, "L": 80.0, r"\vartheta": 80.0}.get(symbol.name, 1.0)
        values *= {"p_": 2e7, "D_": 3.4e-5}.get(symbol.name[:2], 1.0)
    for each in (table, moved):
        own = compiled((tabulated(each),), 2, constants)
        linear = own.vector_gradient(tuple(x), (1.0,) * len(own.parameters), ())
        outline, knots = outlined(each)
        shared = compiled((outline,), 2, constants)
        columns = shared.vector_columns(tuple(x), tuple(knots.get(p.name, 1.0) for p in shared.parameters), ())
        assert len(columns) == len(linear)
        for column, derivative in zip(columns, linear, strict=True):
            np.testing.assert_allclose(column, derivative, rtol=1e-9, atol=1e-12 * np.abs(derivative).max())
            assert np.ptp(column) > 0.0


# -- what its parameters may be
OIL, INF = ("oil_temperature", (20.0, 35.0, 60.0)), float("inf")


@pytest.mark.parametrize(
    ("shape", "anchor", "bounds", "docs"),
    [
        ("free", "none", [(-INF, INF, 2.0)] * 3,
         ["level at the first knots", "rise over oil_temperature 20 ... 35", "rise over oil_temperature 35 ... 60"]),
        ("rising", "low", [(0.0, INF, 2.0)] * 2,
         ["rise over oil_temperature 20 ... 35", "rise over oil_temperature 35 ... 60"]),
        ("rising", "none", [(-INF, INF, 2.0), (0.0, INF, 2.0), (0.0, INF, 2.0)], None),
        ("rising", "high", [(-INF, 0.0, -2.0)] * 2, None),  # below zero, of which the rise is still to come
        ("falling", "low", [(-INF, 0.0, -2.0)] * 2, None),
        ("falling", "high", [(0.0, INF, 2.0)] * 2, None),
        ("convex_rising", "low", [(0.0, INF, 2.0)] * 2, None),
    ],
)  # fmt: skip
def test_the_sign_of_a_rise_is_that_of_the_curves_shape(shape, anchor, bounds, docs):
    term = tabulated(Table("curve", (OIL,), shape=shape, anchor=anchor, typical=2.0))
    assert [(p.lower, p.upper, p.typical) for p in term.parameters] == bounds
    assert [p.name for p in term.parameters] == [f"curve_{k}" for k in range(0 if anchor == "none" else 1, 3)]
    assert docs is None or [p.doc for p in term.parameters] == docs


@pytest.mark.parametrize(("side", "counts"), [("both", (1.0, 1.0)), ("hoisting", (1.0, 0.0)), ("lowering", (0.0, 1.0))])
def test_a_curve_of_one_side_counts_that_way_alone(side, counts):
    model = FrictionModel("m", (tabulated(Table("t", (OIL,), side=side)),), (5.0, 0.0, 0.0))
    points = [(s, *_point(celsius=30.0)[1:]) for s in (1.0, -1.0)]
    told = [model.compile(1).scalar_torque(point, model.values, ()) for point in points]
    assert told == pytest.approx([5.0 * counts[0], -5.0 * counts[1]])


def test_a_window_is_one_behind_its_begin_up_to_its_end():
    table = Table("t", (("time", (10.0, 20.0, 40.0, 50.0)),), shape="windows", weights=(0.5, 2.0))
    told = [in_windows(table, 3.0, at) for at in (10.0, 10.1, 20.0, 20.1, 40.0, 50.0, 51.0)]
    assert told == [0.0, 1.5, 1.5, 0.0, 0.0, 6.0, 0.0]
    assert table.in_times
    assert not replace(table, knots=(("wire_out", (10.0, 20.0, 40.0, 50.0)),)).in_times
    assert not Table("t", (("time", (10.0, 20.0)),)).in_times


@pytest.mark.parametrize(
    ("factor", "value", "unit"),
    [("flow", 11 * 2e-5 * 30.0, "m^3/s"), ("displacement_left", 3e-5 - 2e-5, "m^3/rad"),
     ("speed_magnitude", 30.0, "rad/s"), ("count", 11.0, "1")],
)  # fmt: skip
def test_what_multiplies_a_curve_is_of_one_motor_of_its_group(factor, value, unit):
    assert FACTORS[factor][1] == unit
    assert not {"higher_port", "role"} & set(FACTORS)
    table = Table("t", (("pressure", (0.0, 1e7)),), times=(factor,), scope=Scope.MOTOR)
    model = FrictionModel("m", (tabulated(table),), (2.0, 0.0), constants={"max_displacement": 3e-5})
    point = _point(p=5e6, D=2e-5, w=30.0)
    assert model.compile(1).scalar_torque(point, model.values, ()) == pytest.approx(11.0 * 2.0 * value)
