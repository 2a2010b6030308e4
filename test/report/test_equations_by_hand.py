"""What a term's equation looks like to a reader: its symbols, reference speeds, and the table that explains them."""

import re

import pytest
import sympy as sp

from winch_friction.physics.channels import RPM
from winch_friction.physics.friction import Parameter, term_named
from winch_friction.physics.friction.symbols import (
    CONSTANTS,
    GROUP_SIGNALS,
    WINCH_SIGNALS,
    X,
    mu,
    omega,
    p,
    p_sum,
    rho,
    s,
    w,
)
from winch_friction.physics.friction.term import Scope, State, Term
from winch_friction.report import equations
from winch_friction.report.dashboard import dashboard_page
from winch_friction.report.equations import mathml, symbol_table, term_html, written

SIZE = Parameter("c", "N*m", 1.0, doc="how much")
POWER = Parameter("k", "1", 1.5, shape=True, doc="how steep")
SIGNALS = {each.name: each.symbol for each in (*WINCH_SIGNALS, *GROUP_SIGNALS, *CONSTANTS)}


def term(equation, scope=Scope.MOTOR, **more):
    own = (SIZE, POWER) if POWER.symbol in equation.free_symbols else (SIZE,)
    return Term("own", equation, own, scope, "here", "motor", **more)


def rows(html):
    body = html.partition("<tbody>")[2]
    return [re.findall(r"<td[^>]*>(.*?)</td>", row) for row in re.findall(r"<tr>(.*?)</tr>", body)]


@pytest.mark.parametrize(
    ("name", "symbol"),
    [
        ("direction", "sgn(ω)"), ("speed_magnitude", "|ω|"), ("speed", "ω"), ("drum_torque", "T_d"),
        ("acceleration", "ω̇"), ("oil_temperature", "ϑ"), ("shaft_angle", "φ"), ("wire_layer", "layer"),
        ("wire_out", "L"), ("motor_total", "N"), ("count", "n"), ("pressure", "Δp"), ("pressure_sum", "Σp"),
        ("displacement", "D"), ("max_displacement", "D_max"), ("density", "ρ"), ("viscosity", "μ"), ("gear_ratio", "i"),
        ("higher_port", "sgn(p_A - p_B)"), ("role", "role"),
    ],
)  # fmt: skip
def test_a_signal_is_written_as_people_write_it(name, symbol):
    own = term(SIZE.symbol * SIGNALS[name], opposing=False)
    assert written(own) in (f"c*{symbol}", f"{symbol}*c")
    (_, signal, *_) = rows(symbol_table(own, {}))
    (known,) = [each for each in (*WINCH_SIGNALS, *GROUP_SIGNALS, *CONSTANTS) if each.name == name]
    assert signal[:2] == [symbol, known.doc]


@pytest.mark.parametrize(
    ("equation", "text"),
    [
        (SIZE.symbol * (w / (2000.0 * RPM)) ** POWER.symbol, "c*sgn(ω)*(|ω|/ω_0)^k   (ω_0 = 2000 rpm)"),
        (SIZE.symbol * (1e-9 + w / (150.0 * RPM)) ** POWER.symbol, "c*sgn(ω)*(|ω|/ω_0)^k   (ω_0 = 150 rpm)"),
        (SIZE.symbol * (2.0 * w + p), "c*sgn(ω)*(2.0*|ω| + Δp)"),  # no speed to be referred to
        (SIZE.symbol * (p + 0.001), "c*sgn(ω)*(Δp + 0.001)"),
        (SIZE.symbol * (1e-9 * p + 5e-8), "1.0e-9*c*sgn(ω)*Δp"),
        (SIZE.symbol * (p * 1e6 + 5.0), "1000000.0*c*sgn(ω)*Δp"),
        (SIZE.symbol * (p**2 + w) / rho, "c*sgn(ω)*(|ω| + Δp^2)/ρ"),
    ],
)
def test_what_only_keeps_a_derivative_finite_is_left_out_and_speeds_have_a_reference(equation, text):
    assert written(term(equation)) == text


def test_a_speed_with_its_sign_has_a_reference_too():
    signed = term(SIZE.symbol * (omega / (100.0 * RPM)) ** POWER.symbol, opposing=False)
    assert written(signed) == "c*(ω/ω_0)^k   (ω_0 = 100 rpm)"


@pytest.mark.parametrize(
    ("scope", "counted"),
    [(Scope.MOTOR, "of each motor"), (Scope.SYSTEM, "at each motor's shaft"), (Scope.SHAFT, "at the common shaft")],
)
def test_each_symbol_is_explained_once_with_its_unit(scope, counted):
    z = sp.Symbol("z_own", real=True)
    own = term(SIZE.symbol * w * z, scope, state=State(z, gain=s * X, decay=mu * w, doc="the bend"))
    found = rows(symbol_table(own, {sp.Symbol("ω_0", real=True): 50.0 * RPM}))
    assert found[0] == ["T", f"friction torque {counted.replace(chr(39), '&#x27;')}", "N·m"]
    assert found.count(["z_own", "the bend", "–"]) == found.count(["c", "how much", "N·m"]) == 1
    named = [row[0] for row in found]
    assert sorted(named) == sorted(["T", "sgn(ω)", "sgn(ω)", "|ω|", "D_max", "μ", "ω_0", "z_own", "c"])
    assert ["ω_0", "reference speed, 50\u00a0rpm", "rpm"] in [
        [row[0], row[1].replace(" rpm", "\u00a0rpm"), row[2]] for row in found
    ]
    against = "direction of motion: the torque opposes it"
    assert any(row[1] == against for row in found)
    assert not any(row[1] == against for row in rows(symbol_table(term(w * SIZE.symbol, opposing=False), {})))
    nameless = term(SIZE.symbol * z, state=State(z, gain=w, decay=w))
    assert ["z_own", "memory of the term", "–"] in rows(symbol_table(nameless, {}))


def test_a_memory_is_a_formula_of_its_own_gain_less_what_decays(monkeypatch):
    said = []
    monkeypatch.setattr(equations, "_formula", lambda name, expression: said.append((name, str(expression))) or "")
    z = sp.Symbol("z_own", real=True)
    term_html(term(SIZE.symbol * z, state=State(z, gain=p, decay=p_sum)))
    assert said == [("T", "c*sgn(ω)*z_own"), ("z_own\u0307", "-z_own*Σp + Δp")]


def test_numbers_have_four_digits_and_brackets_are_drawn():
    label = lambda expression, name="": re.search('aria-label="(.*?)"', mathml(expression, name))[1]
    a = sp.Symbol("a", real=True)
    assert label(sp.Float(1234.5678) * a) == "1235.0*a"
    assert label(sp.Float(0.0012345678) * a, "T") == "T = 0.001235*a"
    drawn = mathml(2 * (a + 1) ** 2)
    assert "mfenced" not in drawn
    assert drawn.count("<mo>(</mo>") == drawn.count("<mo>)</mo>") == 1


def test_a_shipped_terms_reference_is_what_its_equation_has():
    assert written(term_named("churning")) == "T_ch*sgn(ω)*(|ω|/ω_0)^n_ch   (ω_0 = 2000 rpm)"
    assert "reference speed, 2000" in term_html(term_named("churning"))


# -- the dashboard's page
def test_the_dashboards_tables_and_drawings_are_under_their_own_names():
    page = dashboard_page()
    heads = {
        name: re.findall(r'<th scope="col">(.*?)</th>', head)
        for name, head in re.findall(r'aria-label="(\w+)"><table><thead>(.*?)</thead><tbody id="\1">', page)
    }
    assert heads == {
        "state": ["part", "says"], "estimates": ["parameter, SI", "value", "± 1 σ", "status"],
        "inputs": ["input", "rate [Hz]", "age [s]"],
    }  # fmt: skip
    drawn = re.findall(r'<figure hidden aria-label="(.*?)"><h3>\1</h3><div class="canvas" id="(\w+)"', page)
    assert drawn == [("Friction torque", "torque"), ("Torque over speed", "loop"), ("Speed", "speed"),
                     ("Tracking error", "error")]  # fmt: skip
    assert '<p id="faults" class="good">nothing heard yet</p>' in page
    assert '<span id="link" role="status">connecting</span>' in page
