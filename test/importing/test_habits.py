"""Single habits of strangers' logs: each of these was once refused, read wrongly, or ended in a traceback."""

import numpy as np
import pytest

from campaign.import_habits import became, kinds
from winch_friction.commissioning.check import quick_check
from winch_friction.importing.names import name_concepts, name_score
from winch_friction.importing.units import header_readings
from winch_friction.physics.signals import Run

MENDED = (
    "Dutch",
    "French",
    "Swedish",
    "units behind underscores",
    "two starts in one file",
    "header again in the middle",
    "a summary at the end",
    "units inside the cells",
    "parquet of strings",
    "mat v7.3",
    "load counts downwards",
    "a port is frozen",
    "groups as AHC and PHC",
    "LabVIEW measurement file",
    "MATLAB timetable v7.3",
    "WinCC archive, a row per value",
    "newest row first",
    ".NET ticks",
    "IEC time",
    "date, time and milliseconds apart",
    "seconds and nanoseconds apart",
    "slow channels with blanks",
    "negative numbers in parentheses",
    "zero bytes behind a power cut",
    "last line cut off",
    "tenths of a bar",
    "displacement negative",
    "MPa of one port, bar of the other",
)


@pytest.mark.parametrize("kind", [each for each in kinds() if each.name in MENDED], ids=lambda kind: kind.name)
def test_a_habit_is_imported_or_its_cause_is_said(kind, tmp_path):
    result = became(kind, tmp_path)
    assert result.good, f"{result.outcome}: {result.said}"


@pytest.mark.parametrize(
    ("header", "name", "unit"),
    [
        ("displacement_cc_rev", "displacement", "cc/rev"),
        ("motor_speed_rad_s", "motor_speed", "rad/s"),
        ("t_s", "t", "s"),
    ],
)
def test_a_unit_of_two_words_is_read_behind_an_underscore(header, name, unit):
    assert header_readings(header)[0] == (name, unit)


WORDS = {"Motortoerental": "motor_speed", "Cylindrée": "displacement", "Charge au crochet": "hook_load"}


@pytest.mark.parametrize(("word", "channel"), WORDS.items())
def test_a_neighbours_word_names_its_channel(word, channel):
    assert name_score(channel, name_concepts(word)) > 0.6


def test_a_frozen_pressure_is_told_only_of_the_port_that_holds_the_load(crane_150t):
    time = np.arange(0.0, 60.0, 0.05)
    steady = np.ones(len(time))
    columns = {
        "time": time, "motor_speed": 80.0 * np.sin(0.5 * time), "main.pressure_a": 150e5 + 10e5 * np.sin(0.5 * time),
        "main.pressure_b": 25e5 * steady, "main.displacement": 3.4e-5 * steady, "hook_load": 77e3 * steady,
    }  # fmt: skip
    stuck = lambda changed: [
        each for each in quick_check([Run("r", {**columns, **changed})], crane_150t) if each.cause == "stuck"
    ]
    assert not stuck({})  # a boost pressure that a simulation holds
    assert stuck({"main.pressure_a": 150e5 * steady})[0].channel == "main.pressure_a"
