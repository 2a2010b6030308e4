"""Which recordings a fleet has, when an earlier result still stands, and which names cannot."""

import os

import pytest

from winch_friction.fleet.recordings import find_recordings
from winch_friction.physics.errors import InputError


def touched(folder, *names, size=10):
    for name in names:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(b"x" * size)
    return folder


def test_a_folder_is_a_crane_and_each_run_file_or_bag_a_recording(tmp_path):
    touched(tmp_path, "north/b.csv", "north/a.mcap", "south/bag/metadata.yaml", "south/bag/0.mcap", "south/notes.txt")
    found = find_recordings([str(tmp_path)])
    assert [(each.crane, each.name) for each in found] == [("north", "a"), ("north", "b"), ("south", "bag")]
    assert found[2].size == 20


def test_a_logger_under_windows_writes_capitals(tmp_path):
    assert [each.name for each in find_recordings([str(touched(tmp_path, "north/A.CSV"))])] == ["A"]


def test_what_a_system_hides_is_no_recording(tmp_path):
    """A Mac writes one beside each file that it copies to a share."""
    touched(tmp_path, "north/a.csv", "north/._a.csv", "north/.a.csv")
    assert [each.name for each in find_recordings([str(tmp_path)])] == ["a"]


def test_the_last_file_of_a_bag_that_was_written_dates_it(tmp_path):
    touched(tmp_path, "north/bag/metadata.yaml", "north/bag/0.mcap")
    os.utime(tmp_path / "north/bag/metadata.yaml", ns=(10**18, 10**18))
    os.utime(tmp_path / "north/bag/0.mcap", ns=(2 * 10**18, 2 * 10**18))
    (found,) = find_recordings([str(tmp_path)])
    assert found.changed == 2 * 10**18


def test_two_recordings_of_one_crane_and_name_are_refused(tmp_path):
    touched(tmp_path, "east/north/a.csv", "west/north/a.csv")
    with pytest.raises(InputError, match="two recordings are named 'north/a'"):
        find_recordings([str(tmp_path)])


def test_the_same_recording_named_twice_is_one(tmp_path):
    touched(tmp_path, "north/a.csv")
    assert len(find_recordings([str(tmp_path), str(tmp_path / "north")])) == 1


def test_a_recording_that_has_grown_is_another_version(tmp_path):
    before = find_recordings([str(touched(tmp_path, "north/a.csv"))])[0]
    touched(tmp_path, "north/a.csv", size=11)
    os.utime(tmp_path / "north" / "a.csv", ns=(before.changed, before.changed))  # its size alone says so
    after = find_recordings([str(tmp_path)])[0]
    assert after.changed == before.changed
    assert (before.crane, before.name, before.address) == (after.crane, after.name, after.address)
    assert before.version != after.version


def test_a_recording_that_was_made_anew_is_another_version_though_it_has_the_same_size(tmp_path):
    """As by `import --set motor_speed.sign=-1 --overwrite`."""
    before = find_recordings([str(touched(tmp_path, "north/a.csv"))])[0]
    os.utime(tmp_path / "north" / "a.csv", ns=(1, before.changed + 1))
    assert find_recordings([str(tmp_path)])[0].version != before.version


def test_a_simulators_truth_and_a_fleets_own_results_are_no_recordings(tmp_path):
    touched(tmp_path, "north/a.csv", "north/truth/a_truth.csv", "out/replay/north/a.parquet", "out/store/part.parquet")
    found = find_recordings([str(tmp_path)], without=[tmp_path / "out" / "replay", tmp_path / "out" / "store"])
    assert [(each.crane, each.name) for each in found] == [("north", "a")]
