"""Two things measured side by side in one process: the ratio survives a noisy machine, single times do not."""

import gc
import subprocess
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from statistics import median
from typing import Any

from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Run, Sample
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.records.sample_stream import InputHold
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate

PATIENCE = 5.0  # periods; a stamp that advances by one of ten counts as standing still
ENDING = 20.0  # s for a process to end by itself
REPEATS = 7  # the median of seven ratios stands three disturbed pairs


@dataclass(frozen=True)
class Row:
    """One line of the table.

    `value` in `unit`, `against` whose value `other`: `ratio` is the median over pairs and `spread` its smallest and
    largest; the goal is met when the ratio (without one: the value) is at most `at_most`, at least `at_least`.
    """

    name: str
    value: float
    unit: str
    against: str = ""
    other: float | None = None
    ratio: float | None = None
    spread: tuple[float, float] | None = None
    at_most: float | None = None
    at_least: float | None = None
    note: str = ""

    @property
    def goal(self) -> str:
        """The goal in words; empty without one."""
        if self.at_most is not None:
            return f"<= {self.at_most:g}"
        return f">= {self.at_least:g}" if self.at_least is not None else ""

    @property
    def met(self) -> bool | None:
        """Whether the goal is met; None without one."""
        found = self.value if self.ratio is None else self.ratio
        if self.at_most is not None:
            return found <= self.at_most
        return found >= self.at_least if self.at_least is not None else None


@dataclass(frozen=True)
class Paired:
    """Median processor times of both in s, and the ratio ours / theirs: median, smallest, largest."""

    ours: float
    theirs: float
    ratio: float
    spread: tuple[float, float]

    @property
    def inverse(self) -> tuple[float, tuple[float, float]]:
        """How many times faster ours is: median and spread."""
        return 1.0 / self.ratio, (1.0 / self.spread[1], 1.0 / self.spread[0])


def seconds(work: Callable[[], Any], clock: Callable[[], float] = time.process_time) -> float:
    """Processor time of one call, garbage collected before and not during it."""
    gc.collect()
    gc.disable()
    try:
        begin = clock()
        work()
        return clock() - begin
    finally:
        gc.enable()


def paired(ours: Callable[[], Any], theirs: Callable[[], Any], smoke: bool = False, repeats: int = REPEATS) -> Paired:
    """Both measured in turn, A B A B ..., after a warm-up; a smoke run takes one pair without a warm-up."""
    if not smoke:
        ours(), theirs()
    times = [(seconds(ours), seconds(theirs)) for _ in range(1 if smoke else repeats)]
    ratios = [a / max(b, 1e-9) for a, b in times]
    return Paired(median(a for a, _ in times), median(b for _, b in times), median(ratios), (min(ratios), max(ratios)))


@dataclass
class Pace:
    """When to send next, at `rate` Hz by the clock on the wall.

    A sender that was itself kept waiting goes on from then and stamps what it measures then, as a controller does.
    With the stamps of its timetable the first speed after a pause would have advanced by less than a tenth of the
    clock, which nodes refuse as a stamp that stands still.
    """

    rate: float
    pauses: int = 0
    _last: float = field(default_factory=time.time)

    def next(self) -> float:
        """The next time to send at, s; it may be over already, by less than `PATIENCE` periods."""
        due, now = self._last + 1.0 / self.rate, time.time()
        if now - due > PATIENCE / self.rate:
            due, self.pauses = now, self.pauses + 1
        self._last = due
        return due


@lru_cache(maxsize=4)
def sea(duration: float = 60.0) -> tuple[Crane, FrictionModel, Run, list[Sample]]:
    """Crane, model, and a simulated heave compensation at 50 Hz of so many s, as a run and as samples."""
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    run = simulate(load_scenario("ahc_irregular").override({"duration": duration}), crane, model, seed=5).run
    return crane, model, run, list(InputHold(run.groups).samples(run))


def sea_seconds(smoke: bool) -> float:
    """How long a sea the steps are measured over."""
    return 2.0 if smoke else 60.0


def end(processes: Sequence[subprocess.Popen[Any]]) -> None:
    """Ask processes to end, and make those that do not within `ENDING`: how a node ends is the tests' matter, and a
    relay that meets its signal while it starts to wait may never hear of it."""
    for each in processes:
        each.terminate()
    for each in processes:
        try:
            each.wait(ENDING)
        except subprocess.TimeoutExpired:
            each.kill()
            each.wait()
