"""A kept text is read as it was written, or not at all."""

import os

import pytest

from winch_friction.physics.friction.sources import keep, read_kept

TEXT = "def equation(x):\n    return x[0]  # 20 °C\n"


def test_is_read_as_it_was_written(tmp_path):
    keep(tmp_path / "own", TEXT)
    assert read_kept(tmp_path / "own") == TEXT
    assert [each.name for each in tmp_path.iterdir()] == ["own"]


@pytest.mark.parametrize("damage", [lambda raw: raw[:-3], lambda raw: b"", lambda raw: raw + b"x", lambda raw: b"\xff"])
def test_what_is_not_whole_is_not_read(tmp_path, damage):
    path = tmp_path / "own"
    keep(path, TEXT)
    path.write_bytes(damage(path.read_bytes()))
    assert read_kept(path) is None


def test_another_users_is_not_read(tmp_path, monkeypatch):
    keep(tmp_path / "own", TEXT)
    stranger = os.getuid() + 1
    monkeypatch.setattr(os, "getuid", lambda: stranger)
    assert read_kept(tmp_path / "own") is None


def test_nothing_is_left_where_it_cannot_be_written(tmp_path):
    (tmp_path / "taken").mkdir()
    with pytest.raises(OSError, match="taken"):
        keep(tmp_path / "taken", TEXT)
    assert [each.name for each in tmp_path.iterdir()] == ["taken"]
    assert read_kept(tmp_path / "taken") is None
