"""Which recordings a fleet has, when an earlier result still stands, and which names cannot."""

import os

import pytest

from winch_friction.fleet import recordings as module
from winch_friction.fleet.recordings import Recording, at_hand, find_recordings
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


@pytest.fixture
def bucket():
    """A store in memory, with a run file and a bag of two files."""
    fsspec = pytest.importorskip("fsspec")
    filesystem = fsspec.filesystem("memory")
    for name, content in (("north/a.csv", b"abc"), ("south/bag/metadata.yaml", b"m"), ("south/bag/0.mcap", b"12345")):
        filesystem.pipe(f"/logs/{name}", content)
    yield "memory://logs"
    filesystem.rm("/logs", recursive=True)


def test_what_lies_in_a_bucket_is_found_fetched_and_removed_afterwards(bucket):
    run, bag = find_recordings([bucket])
    assert [(each.crane, each.name, each.size, each.changed) for each in (run, bag)] == [
        ("north", "a", 3, 0), ("south", "bag", 6, 0),
    ]  # fmt: skip
    with at_hand(run) as path:
        assert (path.name, path.read_bytes()) == ("a.csv", b"abc")
    assert not path.exists()
    with at_hand(bag) as path:
        assert path.is_dir()
        assert {each.name: each.read_bytes() for each in path.iterdir()} == {"metadata.yaml": b"m", "0.mcap": b"12345"}
    assert not path.exists()


@pytest.mark.parametrize(("size", "fetched"), [(6, True), (5, False)])
def test_a_recording_that_is_too_large_is_not_fetched(bucket, monkeypatch, size, fetched):
    monkeypatch.setattr(module, "LARGEST_LOCAL_COPY", size)
    bag = find_recordings([bucket])[1]
    if fetched:
        with at_hand(bag) as path:
            assert path.exists()
        return
    with pytest.raises(InputError, match="too many to fetch"), at_hand(bag):
        pass


def test_a_recording_on_this_machine_is_itself_and_stays(tmp_path):
    touched(tmp_path, "north/a.csv")
    (found,) = find_recordings([str(tmp_path)])
    with at_hand(found) as path:
        assert path == tmp_path / "north" / "a.csv"
    assert path.exists()


def test_a_source_with_nothing_in_it_is_named(tmp_path):
    touched(tmp_path, "north/a.csv", "south/notes.txt")
    with pytest.raises(InputError, match="south: no recording there"):
        find_recordings([str(tmp_path / "north"), str(tmp_path / "south")])
    with pytest.raises(InputError, match="west: no such file or folder"):
        find_recordings([str(tmp_path / "west")])
    with pytest.raises(InputError, match="north: no recording there"):
        find_recordings([str(tmp_path / "north")], without=[tmp_path])


def test_every_file_of_a_bag_is_of_its_version():
    one = Recording("a", "c", "n", (("x/0.mcap", 5), ("x/metadata.yaml", 1)), 7)
    for files, changed in ((one.files[:1], 7), (one.files, 8), ((("x/1.mcap", 5), one.files[1]), 7)):
        assert Recording("a", "c", "n", files, changed).version != one.version
    assert Recording("b", "d", "m", (("y/0.mcap", 5), ("y/metadata.yaml", 1)), 7).version == one.version
