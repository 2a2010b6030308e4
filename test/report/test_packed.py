"""Packed scripts are kept, and a file that is not whole is made anew."""

import base64
import gzip

import pytest

from winch_friction.report.packed import packed

SOURCE = b"let shaft = 1;\n" * 500


@pytest.fixture
def kept(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "winch_friction" / "packed"


def unpacked(text):
    return gzip.decompress(base64.b64decode(text))


def test_is_read_from_the_second_time_on(kept, monkeypatch):
    first = packed(SOURCE)
    assert unpacked(first) == SOURCE
    monkeypatch.setattr(gzip, "compress", None)  # whoever packs again fails
    assert packed(SOURCE) == first


@pytest.mark.parametrize("damage", [lambda text: text[:-20], lambda text: "", lambda text: text + "A", lambda _: "ä"])
def test_what_is_not_whole_is_made_anew(kept, damage):
    whole = packed(SOURCE)
    (path,) = kept.iterdir()
    path.write_text(damage(path.read_text(encoding="ascii")), encoding="utf-8")
    assert packed(SOURCE) == whole
    assert path.read_text(encoding="ascii").endswith(whole)


def test_works_where_nothing_can_be_kept(kept, monkeypatch):
    kept.mkdir(parents=True)
    (kept / "in the way").touch()
    monkeypatch.setattr("winch_friction.report.packed.cache_root", lambda kind: kept / "in the way")
    assert unpacked(packed(SOURCE)) == SOURCE
