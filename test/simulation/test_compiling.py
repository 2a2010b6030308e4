"""Compiled code is never older than its sources, and needs no writable home."""

import pytest

from winch_friction.simulation.compiling import cache_root, compiled, in_order, source_digest


def test_any_change_of_a_source_is_another_key(tmp_path):
    one, two = tmp_path / "one.py", tmp_path / "two.py"
    one.write_text("a = 1\n")
    two.write_text("b = 1\n")
    before = source_digest([one, two])
    assert source_digest([one, two]) == before
    two.write_text("b = 2\n")
    assert source_digest([one, two]) != before


def test_without_a_writable_home_the_temporary_directory_serves(monkeypatch, tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(blocked))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    assert cache_root().parent == tmp_path
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    assert cache_root() == tmp_path / "cache" / "winch_friction" / "numba"


def test_numbas_own_setting_is_left_alone():
    import numba

    before = numba.config.CACHE_DIR
    assert compiled(_twice)(2.0) == 4.0
    assert before == numba.config.CACHE_DIR


def _twice(x):
    return 2.0 * x


def test_arguments_are_given_by_name_in_the_order_of_the_parameters():
    def function(first, count, plant, state):
        return first, count, plant, state

    rest = in_order(function, "first", "count", state="s", plant="p")
    assert function(1, 2, *rest) == (1, 2, "p", "s")
    for wrong in ({"plant": 1}, {"plant": 1, "state": 2, "other": 3}):
        with pytest.raises(TypeError, match=r"state|other"):
            in_order(function, "first", "count", **wrong)
    with pytest.raises(TypeError, match="first"):
        in_order(function, "count", first=1, plant=2, state=3)
