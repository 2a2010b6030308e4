"""Names stand for one term; duplicates and unknown names raise; users add their own."""

import pytest
import sympy as sp

from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import Scope, Term, register, registered_terms, term_named
from winch_friction.physics.friction.registry import load_file
from winch_friction.physics.friction.symbols import p


def test_unknown_name_lists_the_known_ones():
    with pytest.raises(InputError, match="'coulom' is not known; known terms are .*coulomb"):
        term_named("coulom")


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
    try:
        assert [term.name for term in load_file(path)] == ["test_user_term"]
        assert "wire_out" in term_named("test_user_term").reads
    finally:
        from winch_friction.physics.friction import registry

        registry._TERMS.pop("test_user_term", None)


def test_a_broken_users_file_is_one_line(tmp_path):
    path = tmp_path / "broken.py"
    path.write_text("1/0\n")
    with pytest.raises(InputError, match="broken.py: ZeroDivisionError"):
        load_file(path)
