"""Tables whose signals have columns of times of their own: put on one clock, or said why not; never taken for rows."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from importing.logs import example, write_workbook

from winch_friction.importing.carry_out import import_log
from winch_friction.importing.log import Log, number_column
from winch_friction.importing.map_text import map_text
from winch_friction.importing.mapping import load_map
from winch_friction.importing.one_clock import Signal, on_one_clock
from winch_friction.importing.own_clocks import with_own_clocks
from winch_friction.importing.propose import propose
from winch_friction.physics.channels import CM3_PER_REV, RPM
from winch_friction.physics.errors import InputError

SIGNALS = {  # channel -> name, unit, factor from SI, step s
    "motor_speed": ("MotorSpeed", "rpm", 1 / RPM, 0.1),
    "main.pressure_a": ("PressureA", "bar", 1e-5, 0.2),
    "main.pressure_b": ("PressureB", "bar", 1e-5, 0.2),
    "main.displacement": ("Displacement", "cm3/rev", 1 / CM3_PER_REV, 2.0),
    "hook_load": ("HookLoad", "t", 1e-3, 1.0),
}


def at(name: str, times):
    """A channel of the shipped run at other times, s from its first row, in the log's unit."""
    run = example("test_02")
    return np.interp(times, run.time - run.time[0], run[name]) * SIGNALS[name][2]


def series(steps: Callable[[float], float] = lambda step: step, late: float = 0.013):
    """Times and values of each signal at a rate and an origin of its own."""
    run = example("test_02")
    end = run.time[-1] - run.time[0]
    found = {}
    for k, (name, (_, _, _, step)) in enumerate(SIGNALS.items()):
        times = np.arange(late * k, end, steps(step))
        found[name] = times, at(name, times)
    return found


def side_by_side(rows: dict, time: Callable[[str], str], value: Callable[[str, str], str], delimiter: str = ";",
                 shown: Callable[[float], str] = "{:.3f}".format, head: str = "") -> str:  # fmt: skip
    names = [cell for name in rows for cell in (time(SIGNALS[name][0]), value(*SIGNALS[name][:2]))]
    most = max(len(times) for times, _ in rows.values())
    lines = [delimiter.join(names)]
    for k in range(most):
        cells = [(shown(t[k]), f"{v[k]:.4f}") if k < len(t) else ("", "") for t, v in rows.values()]
        lines.append(delimiter.join(cell for pair in cells for cell in pair))
    return head + "\n".join(lines) + "\n"


def taken(log: Path, crane, tmp_path: Path, settings=()):
    """The run of a proposal, by its map as it is written and read again."""
    found = propose([log], crane, "crane_150t", settings)
    assert not found.problems
    (tmp_path / "map.yaml").write_text(map_text(found.log_map), encoding="utf-8")
    return import_log(log, load_map(tmp_path / "map.yaml"), crane), found


def agree(run, tolerance: float, late: float = 0.0):
    """Whether each channel is the signal at these times; `tolerance` of its range, half the rows may lag by a step."""
    for name, (_, _, scale, _) in SIGNALS.items():
        told = run[name] * scale
        meant = at(name, run.time - run.time[0])
        known = np.isfinite(told)
        assert known.mean() > 0.95, name
        assert np.median(np.abs(told - meant)[known]) <= tolerance * max(np.ptp(meant), 0.02 * np.abs(meant).max()), (
            name
        )
    return True


HEADS = {
    "a pair each": (lambda n: f"{n} Time [s]", lambda n, u: f"{n} [{u}]", "{:.3f}".format),
    "the unit before the word": (lambda n: f"{n} [bar] Time", lambda n, u: f"{n} [{u}]", "{:.3f}".format),
    "one name again and again": (lambda n: "Time", lambda n, u: f"{n} [{u}]", "{:.3f}".format),
    "no name of a time": (lambda n: "X_Value", lambda n, u: f"{n} [{u}]", "{:.3f}".format),
    "ms": (lambda n: "Time [ms]", lambda n, u: f"{n} [{u}]", lambda t: f"{1e3 * t:.0f}"),
    "dates": (
        lambda n: f"{n} Timestamp", lambda n, u: f"{n} [{u}]",
        lambda t: str(np.datetime64("2026-03-04T13:07:05.000") + np.timedelta64(round(1e3 * t), "ms")),
    ),
}  # fmt: skip


@pytest.mark.parametrize("kind", HEADS)
def test_each_signal_is_taken_at_its_own_times(kind, tmp_path, crane_150t):
    """Rows were taken for instants: a pressure of every other instant ran at twice its pace, without a word."""
    time, value, shown = HEADS[kind]
    log = tmp_path / "log.csv"
    log.write_text(side_by_side(series(), time, value, shown=shown), encoding="utf-8")
    run, found = taken(log, crane_150t, tmp_path)
    assert agree(run, 0.02)
    assert any("columns of times, each of the columns behind it" in each for each in found.notes)
    assert found.log_map.log["clocks"] == "held"


def test_a_scopes_head_of_labels_before_each_value(tmp_path, crane_150t):
    """Its last row of properties (`Port; 851`) is half of numbers, and was taken for the first of values."""
    names = [
        cell for each, unit, *_ in SIGNALS.values() for cell in ("SymbolName", f"MAIN.f{each}_{unit}".split("/")[0])
    ]
    names[7] = "MAIN.fDisplacement_ccm"
    body = side_by_side(series(), str, lambda n, u: n, "\t", lambda t: f"{1e3 * t:.0f}").partition("\n")[2]
    label = lambda *cells: "\t".join(cells * len(SIGNALS)) + "\n"
    head = "Name\tScope Project\n\n" + label("Data-Type", "REAL64") + "\t".join(names) + "\n"
    log = tmp_path / "scope.csv"
    log.write_text(head + label("NetID", "5.24.1.2.1.1") + label("Port", "851") + "\n" + body, encoding="utf-8")
    run, found = taken(log, crane_150t, tmp_path)
    assert agree(run, 0.02)
    assert found.log_map.columns["hook_load"].source == "MAIN.fHookLoad_t"


def test_a_spreadsheet_of_pairs_below_their_tags(tmp_path, crane_150t):
    """Rows are narrower than the names where the first signals end late: the others were cut off without a word."""
    rows = series(lambda step: 3.0 * step)
    tags = [cell for name in rows for cell in (f"WINCH.{SIGNALS[name][0]}", None)]
    heads = [cell for name in rows for cell in ("Timestamp", f"Value ({SIGNALS[name][1]})")]
    begin = np.datetime64("2026-03-04T13:07:05.000")
    stamp = lambda t: (begin + np.timedelta64(round(1e3 * t), "ms")).astype(object)
    body = [
        [c for t, v in rows.values() for c in ((stamp(t[k]), float(v[k])) if k < len(t) else (None, None))]
        for k in range(max(len(t) for t, _ in rows.values()))
    ]
    log = write_workbook(tmp_path / "log.xlsx", [tags, heads, *body])
    run, _ = taken(log, crane_150t, tmp_path)
    assert agree(run, 0.05)


@pytest.mark.parametrize("kind", ["mat", "h5"])
def test_structs_with_a_time_of_their_own_are_signals_of_it(kind, tmp_path, crane_150t):
    """Of timeseries of several rates those of the commonest length were taken, and the others left out."""
    rows, log = series(), tmp_path / f"log.{kind}"
    if kind == "mat":
        from scipy.io import savemat

        savemat(log, {"log": {"_".join(SIGNALS[n][:2]).replace("cm3/rev", "ccm"): {"Time": t, "Data": v}
                              for n, (t, v) in rows.items()}})  # fmt: skip
    else:
        h5py = pytest.importorskip("h5py")
        with h5py.File(log, "w") as file:
            for name, (times, values) in rows.items():
                group = file.create_group(SIGNALS[name][0])
                group.create_dataset("time", data=times).attrs["unit"] = "s"
                group.create_dataset("value", data=values).attrs["unit"] = SIGNALS[name][1]
    run, found = taken(log, crane_150t, tmp_path)
    assert agree(run, 0.02)
    assert not [each for each in found.notes if "left out" in each]


def corners(times, values, slack):
    """A swinging door: the corners of straight lines that leave no value by more than `slack`."""
    kept, low, high = [0], -np.inf, np.inf
    for k in range(1, len(times)):
        pivot = kept[-1]
        step = times[k] - times[pivot]
        up, down = (values[k] + slack - values[pivot]) / step, (values[k] - slack - values[pivot]) / step
        low, high = max(low, down), min(high, up)
        if low > high:
            kept.append(k - 1)
            step = times[k] - times[k - 1]
            high, low = (values[k] + slack - values[k - 1]) / step, (values[k] - slack - values[k - 1]) / step
    return [*kept, len(times) - 1]


def changes(times, values, slack):
    """A logger of changes: the values that leave the last one written by more than `slack`."""
    kept = [0]
    for k in range(1, len(times)):
        if abs(values[k] - values[kept[-1]]) > slack:
            kept.append(k)
    return kept


@pytest.mark.parametrize(("rule", "clocks"), [(corners, "lines"), (changes, "held")])
def test_what_a_historian_left_out_is_drawn_as_it_wrote(rule, clocks, tmp_path, crane_150t):
    """A ramp between two corners was a stair of its whole height."""
    rows = {}
    for name, (times, values) in series(lambda _: 0.1, 0.0).items():
        kept = rule(times, values, 0.004 * max(np.ptp(values), 0.05 * np.abs(values).max()))
        rows[name] = times[kept], values[kept]
    log = tmp_path / "log.csv"
    log.write_text(side_by_side(rows, lambda n: f"{n} Time [s]", lambda n, u: f"{n} [{u}]"), encoding="utf-8")
    run, found = taken(log, crane_150t, tmp_path)
    assert found.log_map.log["clocks"] == clocks
    assert agree(run, 0.01)
    other = "held" if clocks == "lines" else "lines"
    _, told = taken(log, crane_150t, tmp_path, (f"log.clocks={other}",))
    assert told.log_map.log["clocks"] == other


def test_a_log_of_changes_is_held_where_that_is_said(tmp_path, crane_150t):
    """Its columns share a clock and have a value where it changed: most cells were empty, with no way to hold them."""
    rows = series(lambda _: 0.1, 0.0)
    times, last, lines = rows["motor_speed"][0], {}, [["Time [s]", *(f"{n} [{u}]" for n, u, *_ in SIGNALS.values())]]
    for k, t in enumerate(times):
        cells = [f"{t:.1f}"]
        for name, (_, values) in rows.items():
            moved = name not in last or abs(values[k] - last[name]) > 0.02 * np.abs(values).max()
            last[name] = values[k] if moved else last[name]
            cells.append(f"{values[k]:.4f}" if moved else "")
        lines.append(cells)
    log = tmp_path / "log.csv"
    log.write_text("\n".join(";".join(row) for row in lines), encoding="utf-8")
    asked = propose([log], crane_150t, "crane_150t")
    assert any("of a log of changes, where each holds until the next" in each for each in asked.notes), asked
    run, _ = taken(log, crane_150t, tmp_path, ("log.clocks=held",))
    assert len(run) == len(times)
    assert agree(run, 0.5)
    assert all(np.isfinite(run[name]).all() for name in SIGNALS)


def test_times_that_all_say_the_same_are_one(tmp_path, crane_150t):
    """`MOTOR.SPEED [rpm] time [s]` was taken for the speed of the drum."""
    log = tmp_path / "log.csv"
    rows = series(lambda _: 0.1, 0.0)
    log.write_text(side_by_side(rows, lambda n: f"{n} [rpm] time [s]", lambda n, u: f"{n} [{u}]"), encoding="utf-8")
    run, found = taken(log, crane_150t, tmp_path)
    assert agree(run, 1e-3)
    assert "drum_speed" not in run
    assert not any(source.endswith("time [s]") for source in (e.source for e in found.log_map.columns.values()))


def test_two_tables_of_one_length_are_asked_about_and_answered(tmp_path, crane_150t):
    """Whether both clocks tell of the same rows nobody can see; said, it is done."""
    rows = series(lambda _: 0.1, 0.0)
    fast, slow = list(rows)[:3], list(rows)[3:]
    times = rows["motor_speed"][0]
    cells = [["t1 [s]", *(f"{n} [{u}]" for n, u, *_ in (SIGNALS[c] for c in fast)),
              "t2 [s]", *(f"{n} [{u}]" for n, u, *_ in (SIGNALS[c] for c in slow))]]  # fmt: skip
    for k, t in enumerate(times):
        later = t + 7.0
        cells.append([f"{t:.2f}", *(f"{rows[c][1][k]:.4f}" for c in fast), f"{later:.2f}",
                      *(f"{at(c, later):.4f}" for c in slow)])  # fmt: skip
    log = tmp_path / "log.csv"
    log.write_text("\n".join(";".join(row) for row in cells), encoding="utf-8")
    found = propose([log], crane_150t, "crane_150t")
    assert any("--set log.clocks=held" in each for each in found.problems)
    run, _ = taken(log, crane_150t, tmp_path, ("log.clocks=held",))
    assert run["main.displacement"][0] != run["main.displacement"][0]  # nothing was logged before
    one = propose([log], crane_150t, "crane_150t", ("log.clocks=one", "time.from=t1 [s]"))
    assert not one.problems


def test_what_the_map_says_of_clocks_is_held_against_the_log(tmp_path, crane_150t):
    log = tmp_path / "log.csv"
    log.write_text(side_by_side(series(), lambda n: "Time", lambda n, u: f"{n} [{u}]"), encoding="utf-8")
    run, found = taken(log, crane_150t, tmp_path)
    plain = tmp_path / "plain.csv"
    plain.write_text(
        "MotorSpeed [rpm];Time [s]\n" + "\n".join(f"{k % 7};{k / 10}" for k in range(50)), encoding="utf-8"
    )
    with pytest.raises(InputError, match=r"plain\.csv: log\.clocks is 'held', but no column of times begins it"):
        import_log(plain, found.log_map, crane_150t)
    with pytest.raises(InputError, match=r"'log\.clocks=two': write one of one, held, lines"):
        propose([log], crane_150t, "crane_150t", ("log.clocks=two",))


def two_clocks(times, values) -> Log:
    """A speed every 0.1 s, and a pressure at these times, with a value each."""
    fill = np.full(100 - len(times), np.nan)
    cells = {
        "Speed Time [s]": 0.1 * np.arange(100), "Speed [rpm]": np.arange(100.0),
        "Pressure Time [s]": np.append(times, fill), "Pressure [bar]": np.append(values, fill),
    }  # fmt: skip
    return Log(Path("log.csv"), tuple(number_column(*each) for each in cells.items()), {}, str)


def test_rows_of_a_clock_that_stand_out_of_order_are_sorted():
    times, values = 0.1 * np.arange(90.0), np.arange(90.0) ** 2
    turned = np.arange(90)
    turned[40:42] = 41, 40
    ordered, sorted_ = (
        with_own_clocks(two_clocks(times[order], values[order])).column("Pressure [bar]").values
        for order in (np.arange(90), turned)
    )
    assert sorted_.tolist() == ordered.tolist()


def test_clocks_that_share_no_time_are_not_put_on_one():
    """A second recording below or beside the first; what is between them nobody knows."""
    times = 0.1 * np.arange(90.0)
    assert len(with_own_clocks(two_clocks(times + 5.0, times)).columns) == 3
    apart = two_clocks(times + 50.0, times)
    assert with_own_clocks(apart) is apart


@pytest.mark.parametrize("lines", [False, True])
def test_nothing_is_known_before_a_signals_first_value(lines):
    signals = [
        Signal(name, np.arange(9.0), times=first + 0.1 * np.arange(9)) for name, first in (("a", 0.0), ("b", 0.3))
    ]
    (_, _, late), _ = on_one_clock(signals, lines)
    assert late.values == pytest.approx([np.nan] * 3 + [*range(6)], nan_ok=True)
