"""Names stand for one term; duplicates and unknown names raise; users add their own."""

from dataclasses import replace

import pytest
import sympy as sp
from own_term_files import forgotten, own_terms

from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import Scope, Term, register, registered_terms, symbols, term_named
from winch_friction.physics.friction.symbols import p
from winch_friction.physics.friction.term import (
    file_of,
    irreplaceable,
    known_for_now,
    load_file,
    needed,
    unique_parameters,
)


def test_an_unknown_name_says_what_to_do():
    """The line held all of a hundred names, and what to do behind them."""
    with pytest.raises(InputError) as said:
        term_named("fairlead_grease")
    assert "one of your own needs its file (--terms-file;" in str(said.value)
    assert "winch-friction list terms" in str(said.value)
    assert len(str(said.value)) < 200


def test_a_slip_in_a_name_is_answered_by_what_was_meant_alone():
    with pytest.raises(InputError) as said:
        term_named("gear_load_los")
    assert "is not known; did you mean gear_load_loss" in str(said.value)
    assert "stribeck" not in str(said.value)


def test_duplicate_name_is_refused():
    with pytest.raises(InputError, match="declared twice"):
        register(registered_terms()["coulomb"])


def test_a_symbol_that_is_nothing_is_refused():
    with pytest.raises(InputError, match="neither signals nor parameters"):
        Term("odd", sp.Symbol("q"), (), Scope.SYSTEM, "test", "motor")


def test_a_system_term_cannot_read_a_group():
    with pytest.raises(InputError, match="scope must be MOTOR"):
        Term("odd", p, (), Scope.SYSTEM, "test", "motor")


def test_a_users_file_adds_a_term(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(
        "from winch_friction.physics.friction import Parameter, Scope, Term, register\n"
        "from winch_friction.physics.friction.symbols import wire_out\n"
        "k = Parameter('k_test_user', 'N', 0.1, doc='per metre')\n"
        "register(Term('test_user_term', k.symbol * wire_out, (k,), Scope.SHAFT, 'a test', 'gear and drum'))\n"
    )
    with forgotten("test_user_term"):
        assert [term.name for term in load_file(path)] == ["test_user_term"]
        assert "wire_out" in term_named("test_user_term").reads
        assert [term.name for term in load_file(path)] == ["test_user_term"]  # not run again
        path.write_text(path.read_text() + "# another opinion\n")
        with pytest.raises(InputError, match="mine.py: changed since"):
            load_file(path)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("\n1/0\n", r"wrong.py: ZeroDivisionError: division by zero \(line 2\)$"),
        (
            "from winch_friction.terms import signals as s\ns.rope\n",
            r"no signal 'rope'; an equation may read direction, ",
        ),
        (
            "from winch_friction.terms import *\nk = Parameter('k_idle', 'N*m', 1.0)\n"
            "register(Term('idle', signals.wire_out, (k,), Scope.SHAFT, 'a test', 'gear and drum'))\n",
            "wrong.py: term 'idle': its parameter k_idle stands in no equation of it",
        ),
        ("register = None\n", "wrong.py: declares no term"),
        ("def\n", "wrong.py: SyntaxError"),
        ("raise SystemExit\n", "wrong.py: SystemExit"),
        ("import no_such_module\n", "wrong.py: ModuleNotFoundError"),
        ("from winch_friction.physics.friction import *\nregister(term_named('coulomb'))\n", "wrong.py: .*twice"),
    ],
)
def test_a_wrong_users_file_is_one_line(tmp_path, monkeypatch, text, said):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "wrong.py").write_text(text)
    with pytest.raises(InputError, match=said) as refused:
        load_file("wrong.py")
    assert "\n" not in str(refused.value)
    assert "idle" not in registered_terms()


def test_a_signal_is_read_by_the_name_that_is_shown_for_it_as_well():
    """`show` says that a term reads speed_magnitude, and `signals.speed_magnitude` was not there."""
    for signal in symbols.SIGNAL_OF_SYMBOL.values():
        assert getattr(symbols, signal.name) is signal.symbol


@pytest.mark.parametrize(
    ("declared", "said"),
    [
        ("'k_test', 'bananas', 1.0", "parameter 'k_test': unit 'bananas' is not a product of SI units"),
        ("'k_test', 'bar', 1.0", "unit 'bar' is not a product of SI units"),
        ("'k_test', '', 1.0", "unit '' is not"),
        ("'k_test', 'N*m', -1.0", "typical value -1 is outside its bounds 0 ... inf"),
        ("'k_test', 'N*m', float('nan')", "typical value nan is outside"),
        ("'k_test', 'N*m', 1.0, lower=3.0, upper=2.0", "outside its bounds 3 ... 2"),
    ],
)
def test_a_parameter_that_cannot_be_is_refused_where_it_is_declared(tmp_path, declared, said):
    path = tmp_path / "wrong.py"
    path.write_text(f"from winch_friction.physics.friction import Parameter\nParameter({declared})\n")
    with pytest.raises(InputError, match=said) as refused:
        load_file(path)
    assert "wrong.py" in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("name", ["missing.py", "."])
def test_a_missing_users_file_is_one_line(tmp_path, name):
    with pytest.raises(InputError, match="not a readable Python file of terms"):
        load_file(tmp_path / name)


def test_a_users_file_that_fails_half_way_adds_nothing(tmp_path):
    path = own_terms(tmp_path, "half_way", "k_half_way")
    declared = path.read_text()
    path.write_text(declared + "1/0\n")
    with pytest.raises(InputError, match="ZeroDivisionError"):
        load_file(path)
    assert "half_way" not in registered_terms()
    path.write_text(declared)
    with forgotten("half_way"):
        assert [term.name for term in load_file(path)] == ["half_way"]


# -- what a term says of itself
@pytest.mark.parametrize(
    ("name", "reads", "groups"),
    [
        ("torque_offset", (), False), ("coulomb", ("direction",), False),
        ("gear_asymmetry", ("direction", "drum_torque", "gear_ratio"), False),
        ("presliding", ("direction", "drum_torque", "speed_magnitude"), False),
        ("dwell_stiction", ("direction", "drum_torque", "speed_magnitude"), False),
        ("torque_ripple", ("drum_torque", "gear_ratio", "shaft_angle"), False),
        ("line_active", ("count", "direction", "displacement", "role", "speed_magnitude"), True),
        ("case_ports", ("direction", "higher_port", "pressure", "pressure_sum"), True),
        ("wilson_constant", ("direction", "max_displacement"), False),
    ],
)  # fmt: skip
def test_a_term_reads_what_stands_in_its_equation_and_the_direction_that_it_opposes(name, reads, groups):
    term = term_named(name)
    assert (term.reads, term.reads_groups) == (reads, groups)


def test_a_channel_in_whose_place_nothing_can_stand_is_named():
    assert irreplaceable(("wire_layer", "shaft_angle", "time", "oil_temperature")) == ("oil_temperature", "shaft_angle")
    assert irreplaceable(("wire_out",)) == ("wire_out",)
    assert needed([term_named("torque_ripple"), term_named("coulomb"), term_named("layer_bedding")]) == ("shaft_angle",)


def test_a_parameter_of_two_terms_is_one_in_the_order_of_the_terms():
    own = Term("own", term_named("coulomb").equation, term_named("coulomb").parameters, Scope.SHAFT, "a test", "motor")
    found = unique_parameters([term_named("viscous"), term_named("coulomb"), own])
    assert [each.name for each in found] == ["C5", "C2"]


def test_a_proposed_term_is_known_while_its_model_is_read_and_no_longer():
    own = Term("proposed", sp.Integer(1), (), Scope.SHAFT, "a test", "motor")
    with known_for_now(own):
        assert term_named("proposed") is own
    assert "proposed" not in registered_terms()
    declared = term_named("coulomb")
    with known_for_now(replace(declared, doc="another")):
        assert term_named("coulomb") is declared
    assert term_named("coulomb") is declared


def test_a_users_term_is_of_its_file_and_a_declared_one_of_none(tmp_path):
    path = own_terms(tmp_path, "of_a_file", "k_of_a_file")
    with forgotten("of_a_file"):
        (term,) = load_file(path)
        assert file_of(term) == path.resolve()
        assert file_of(term_named("coulomb")) is None


def test_an_equation_is_shown_with_the_direction_that_it_opposes():
    assert term_named("coulomb").latex == "C_{2} s"
    assert term_named("torque_offset").latex == "T_{0}"
