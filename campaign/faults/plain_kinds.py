"""Kinds of faults: each spoils the messages of one tick, as sensors, networks, clocks and people do."""

import copy
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from campaign.faults.voyages import MESSAGES
from winch_friction.records.topics import stamp_header

Messages = list[tuple[str, Any]]
SPEED, REFERENCE = "winch/joint_states", "winch/reference"
ACTIVE_A, ACTIVE_B, SWASH = "winch/active/pressure_a", "winch/active/pressure_b", "winch/active/displacement"
LOAD = "winch/hook_load"
NEEDED = (SPEED, REFERENCE, ACTIVE_A, SWASH)


@dataclass
class Fault:
    """One fault while it lasts: `spoil(messages, tick, rng)` gives what arrives instead."""

    kind: str
    detail: str
    spoil: Callable[[Messages, int, np.random.Generator], Messages]
    silences: bool = False  # a needed input is gone, or cannot be believed: the torque must go to zero
    detection: float = 0.0  # s that it may take to see that
    blind: bool = False  # nothing that arrives shows how the shaft turns now: late as a whole, or all of it wrong
    paused: bool = False  # the process does not run at all; afterwards everything comes at once
    memory: dict[str, Any] = field(default_factory=dict)


def one_of(rng: np.random.Generator, *choices: Any) -> Any:
    return choices[int(rng.integers(len(choices)))]


def drop_out(rng: np.random.Generator) -> Fault:
    """A topic falls silent, or several."""
    topics = set(rng.choice((SPEED, REFERENCE, ACTIVE_A, ACTIVE_B, SWASH, LOAD), size=int(rng.integers(1, 4))).tolist())
    silent = bool(topics & set(NEEDED))
    return Fault(
        "drop-out", ", ".join(sorted(topics)), lambda m, _k, _r: [e for e in m if e[0] not in topics], silences=silent
    )


def everything_silent(rng: np.random.Generator) -> Fault:
    """All topics fall silent."""
    return Fault("all silent", "", lambda _m, _k, _r: [], silences=True)


def packet_loss(rng: np.random.Generator) -> Fault:
    """Some messages never arrive."""
    share = float(rng.uniform(0.05, 0.6))
    return Fault("packet loss", f"{share:.2f}", lambda m, _k, r: [e for e in m if r.random() > share])


def edited(topic: str, change: Callable[[Any, int, np.random.Generator], None]) -> Any:
    def spoil(messages: Messages, tick: int, rng: np.random.Generator) -> Messages:
        out = []
        for name, message in messages:
            if name == topic:
                message = copy.copy(message)
                change(message, tick, rng)
            out.append((name, message))
        return out

    return spoil


def fields_of(topic: str) -> tuple[str, ...]:
    if topic in (SPEED, REFERENCE):
        return ("velocity",)
    return ("position",) if topic == SWASH else ("data",) if topic == LOAD else ("fluid_pressure",)


def set_value(message: Any, topic: str, change: Callable[[float], float]) -> None:
    for name in fields_of(topic):
        value = getattr(message, name)
        if isinstance(value, list):
            setattr(message, name, [change(each) for each in value])
        else:
            setattr(message, name, change(value))


def not_a_number(rng: np.random.Generator) -> Fault:
    """NaN or infinity in a field."""
    topic, value = one_of(rng, *NEEDED, LOAD), one_of(rng, math.nan, math.inf, -math.inf)
    spoil = edited(topic, lambda m, _k, _r: set_value(m, topic, lambda _v: value))
    return Fault("not a number", f"{topic} {value}", spoil, silences=topic in NEEDED)


def absurd(rng: np.random.Generator) -> Fault:
    """A value that no sensor of this crane can say."""
    topic = one_of(rng, *NEEDED, LOAD)
    value = {SPEED: 2999.0, REFERENCE: -2999.0, ACTIVE_A: 1.9e8, SWASH: one_of(rng, 25.0, -25.0), LOAD: 9.9e6}[topic]
    spoil = edited(topic, lambda m, _k, _r: set_value(m, topic, lambda _v: value))
    return Fault("absurd value", f"{topic} {value:g}", spoil, silences=topic in NEEDED, detection=0.05)


def wrong_unit(rng: np.random.Generator) -> Fault:
    """bar for Pa, rpm for rad/s, per cent for a fraction, t for kg, and back."""
    topic, factor = one_of(
        rng, (ACTIVE_A, 1e-5), (SPEED, 30.0 / math.pi), (REFERENCE, 30.0 / math.pi), (SWASH, 100.0), (LOAD, 1e-3)
    )
    spoil = edited(topic, lambda m, _k, _r: set_value(m, topic, lambda v: v * factor))
    return Fault("wrong unit", f"{topic} x {factor:.3g}", spoil)


def wrong_sign(rng: np.random.Generator) -> Fault:
    """A flipped sign of speed or command."""
    topic = one_of(rng, SPEED, REFERENCE)
    return Fault("wrong sign", topic, edited(topic, lambda m, _k, _r: set_value(m, topic, lambda v: -v)))


def spikes(rng: np.random.Generator) -> Fault:
    """Single wild values."""
    topic, share = one_of(rng, SPEED, REFERENCE, ACTIVE_A, SWASH, LOAD), float(rng.uniform(0.02, 0.3))
    size = float(10.0 ** rng.uniform(-1.0, 6.0))

    def change(message: Any, _tick: int, r: np.random.Generator) -> None:
        if r.random() < share:
            set_value(message, topic, lambda v: v + size * r.standard_normal() * max(abs(v), 1.0))

    return Fault("spikes", topic, edited(topic, change))


def drift(rng: np.random.Generator) -> Fault:
    """A sensor that drifts away."""
    topic, rate = one_of(rng, SPEED, ACTIVE_A, SWASH, LOAD), float(rng.normal(0.0, 0.3))
    change = lambda m, k, _r: set_value(m, topic, lambda v: v * (1.0 + rate * 0.02 * (k % 500)))
    return Fault("drift", topic, edited(topic, change))


def stuck_at(topic: str) -> Any:
    """What repeats the first value of a topic from now on."""
    held: dict[str, Any] = {}

    def change(message: Any, _tick: int, _r: np.random.Generator) -> None:
        for name in fields_of(topic):
            held.setdefault(name, copy.deepcopy(getattr(message, name)))
            setattr(message, name, copy.deepcopy(held[name]))

    return edited(topic, change)


def stuck(rng: np.random.Generator) -> Fault:
    """A sensor that repeats one value with fresh stamps."""
    topic = one_of(rng, SPEED, REFERENCE, ACTIVE_A, SWASH, LOAD)
    return Fault("stuck value", topic, stuck_at(topic))


def stamped(messages: Messages, topics: set[str], stamp: Callable[[float], float]) -> Messages:
    out = []
    for name, message in messages:
        if name in topics and hasattr(message, "header"):
            message = copy.copy(message)
            time = message.header.stamp.sec + message.header.stamp.nanosec * 1e-9
            message.header = stamp_header(stamp(time), MESSAGES)
        out.append((name, message))
    return out


def frozen_stamp(rng: np.random.Generator) -> Fault:
    """Live data under a stamp that stands still."""
    topics, held = set(one_of(rng, (SPEED,), (SPEED, REFERENCE), (REFERENCE,), NEEDED)), {}

    def spoil(messages: Messages, _tick: int, _r: np.random.Generator) -> Messages:
        return stamped(messages, topics, lambda time: held.setdefault("stamp", time))

    return Fault("frozen stamp", ", ".join(sorted(topics)), spoil, silences=True)


def future_stamp(rng: np.random.Generator) -> Fault:
    """One message, or all, an hour or a second ahead."""
    ahead, topics = float(one_of(rng, 0.3, 1.0, 3600.0)), {one_of(rng, *NEEDED)}
    once = bool(rng.random() < 0.5)

    def spoil(messages: Messages, tick: int, _r: np.random.Generator) -> Messages:
        state["n"] += 1
        return messages if once and state["n"] > 1 else stamped(messages, topics, lambda time: time + ahead)

    state = {"n": 0}
    return Fault("future stamp", f"{ahead:g} s {'once' if once else 'all'}", spoil)


def zero_stamp(rng: np.random.Generator) -> Fault:
    """Stamps of 0."""
    topics = set(one_of(rng, (SPEED,), NEEDED))
    return Fault("stamp of 0", "", lambda m, _k, _r: stamped(m, topics, lambda _t: 0.0), silences=True, detection=0.1)


def clock_set(rng: np.random.Generator) -> Fault:
    """The senders' clock is set, forwards or back, and goes on from there."""
    step = float(one_of(rng, -0.5, -3.0, -1000.0, 0.4, 30.0, 1e6))
    topics = {SPEED, REFERENCE, ACTIVE_A, ACTIVE_B, SWASH, "winch/passive/pressure_a", "winch/passive/pressure_b",
              "winch/passive/displacement"}  # fmt: skip
    spoil = lambda m, _k, _r: stamped(m, topics, lambda time: time + step)
    return Fault("clock set", f"{step:g} s", spoil, blind=True)


def other_clocks(rng: np.random.Generator) -> Fault:
    """Sources whose clocks differ."""
    offset = {topic: float(rng.uniform(-3.0, 3.0)) for topic in (SPEED, REFERENCE, ACTIVE_A, SWASH)}

    def spoil(messages: Messages, _tick: int, _r: np.random.Generator) -> Messages:
        for topic, by in offset.items():
            messages = stamped(messages, {topic}, lambda time, by=by: time + by)
        return messages

    return Fault("different clocks", "", spoil, blind=True)


def duplicated(rng: np.random.Generator) -> Fault:
    """Every message comes twice or more."""
    times = int(rng.integers(2, 6))
    return Fault("duplicates", f"x {times}", lambda m, _k, _r: [e for e in m for _ in range(times)])


def reordered(rng: np.random.Generator) -> Fault:
    """Messages of several ticks in any order."""
    waiting: Messages = []
    depth = int(rng.integers(10, 60))

    def spoil(messages: Messages, _tick: int, r: np.random.Generator) -> Messages:
        waiting.extend(messages)
        out = []
        while len(waiting) > depth:
            out.append(waiting.pop(int(r.integers(len(waiting)))))
        return out

    return Fault("reordered", f"depth {depth}", spoil, blind=True)


def delayed(rng: np.random.Generator) -> Fault:
    """Everything comes late by the same time."""
    ticks, queue = int(rng.integers(2, 80)), []

    def spoil(messages: Messages, _tick: int, _r: np.random.Generator) -> Messages:
        queue.append(messages)
        return queue.pop(0) if len(queue) > ticks else []

    return Fault("delayed", f"{20 * ticks} ms", spoil, blind=True)


def flood(rng: np.random.Generator) -> Fault:
    """Ten messages where there was one, a little apart in time."""

    def spoil(messages: Messages, _tick: int, _r: np.random.Generator) -> Messages:
        out: Messages = []
        for part in range(10):
            shift = -0.018 + 0.002 * part
            out += stamped(messages, {name for name, _ in messages}, lambda time, shift=shift: time + shift)
        return out

    return Fault("flood", "x 10", spoil)


def doubled(
    messages: Messages, topic: str, change: Callable[[float], float], arranged: Callable[[Any, Any], Messages]
) -> Messages:
    """Every message of a topic with a copy of changed value, as they are `arranged`."""
    out: Messages = []
    for name, message in messages:
        if name != topic:
            out.append((name, message))
            continue
        other = copy.copy(message)
        set_value(other, topic, change)
        out += arranged((name, message), (name, other))
    return out


def second_publisher(rng: np.random.Generator) -> Fault:
    """Somebody else publishes the opposite of speed or command between ours."""
    topic = one_of(rng, SPEED, REFERENCE, ACTIVE_A)

    def spoil(messages: Messages, _tick: int, _r: np.random.Generator) -> Messages:
        def later(own: Any, other: Any) -> Messages:
            return [own, *stamped([other], {topic}, lambda time: time + 0.003)]

        return doubled(messages, topic, lambda v: -v, later)

    return Fault("second publisher", topic, spoil, detection=1.0)
