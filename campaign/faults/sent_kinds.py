"""Kinds of faults in how messages are built, sent and timed, and in what they say late or in another order."""

import copy
import math
from typing import Any

import numpy as np

from campaign.faults.plain_kinds import (
    ACTIVE_A,
    ACTIVE_B,
    LOAD,
    NEEDED,
    REFERENCE,
    SPEED,
    SWASH,
    Fault,
    Messages,
    edited,
    fields_of,
    one_of,
    set_value,
    stamped,
)

LAYER, OIL, WIRE, HEAVE = "winch/wire_layer", "winch/oil_temperature", "winch/wire_out", "winch/heave_velocity"
ARRAYS = ("position", "velocity", "effort")
TICK = 0.02  # s


def malformed(rng: np.random.Generator) -> Fault:
    """Empty arrays, or another joint's name."""
    topic = one_of(rng, SPEED, REFERENCE, SWASH)
    change = one_of(
        rng,
        lambda m, _k, _r: [setattr(m, name, []) for name in ARRAYS],
        lambda m, _k, _r: setattr(m, "name", ["elbow"]),
        lambda m, _k, _r: setattr(m, "name", []),
    )
    return Fault("malformed", topic, edited(topic, change), silences=True)


def stall(rng: np.random.Generator) -> Fault:
    """The process stands still; afterwards everything that waited comes in one burst."""
    return Fault("stall and burst", "", lambda m, _k, _r: m, paused=True)


def joint_arrays(rng: np.random.Generator) -> Fault:
    """Joints that change their order, stand twice, or come among others; arrays of another length than the names."""
    topic = one_of(rng, SPEED, REFERENCE, SWASH)
    how = one_of(rng, "reordered", "twice", "short", "long", "others between")
    wrong = float(rng.uniform(-100.0, 100.0))

    def change(message: Any, _tick: int, r: np.random.Generator) -> None:
        if not all(len(getattr(message, name)) for name in ("name", *ARRAYS)):
            return  # a second fault has emptied it
        own = message.name[0]
        if how in ("reordered", "twice"):
            first = bool(r.integers(2)) if how == "reordered" else False
            other = "gripper" if how == "reordered" else own
            message.name = [other, own] if first else [own, other]
            for name in ARRAYS:
                value = getattr(message, name)[0]
                setattr(message, name, [wrong, value] if first else [value, wrong])
        elif how == "short":
            message.name = ["gripper", own]  # the value stands where the other joint's belongs
        elif how == "long":
            for name in ARRAYS:
                setattr(message, name, [*getattr(message, name), wrong, math.nan])

    def spoil(messages: Messages, tick: int, r: np.random.Generator) -> Messages:
        if how != "others between":
            return edited(topic, change)(messages, tick, r)
        out: Messages = []
        for name, message in messages:
            out.append((name, message))
            if name == topic:
                foreign = copy.copy(message)
                foreign.name = ["gripper"]
                out += stamped([(name, foreign)], {topic}, lambda time: time + 0.002)
        return out

    return Fault("joint arrays", f"{topic} {how}", spoil, silences=how == "short")


def lagging(rng: np.random.Generator) -> Fault:
    """Old values under fresh stamps: a filter, or a task that copies what another one wrote long ago."""
    topics = one_of(rng, (SPEED,), (REFERENCE,), (ACTIVE_A, ACTIVE_B), (SWASH,), (LOAD,), (SPEED, REFERENCE))
    ticks, kept = int(rng.integers(3, 60)), {topic: [] for topic in topics}

    def change(message: Any, topic: str) -> None:
        queue = kept[topic]
        queue.append([copy.deepcopy(getattr(message, name)) for name in fields_of(topic)])
        old = queue.pop(0) if len(queue) > ticks else queue[0]
        for name, value in zip(fields_of(topic), old, strict=True):
            setattr(message, name, copy.deepcopy(value))

    def spoil(messages: Messages, tick: int, r: np.random.Generator) -> Messages:
        for topic in topics:
            messages = edited(topic, lambda m, _k, _r, topic=topic: change(m, topic))(messages, tick, r)
        return messages

    return Fault("old values, fresh stamps", f"{', '.join(topics)}: {TICK * ticks:.2f} s", spoil, blind=len(topics) == 2
                 and SPEED in topics)  # fmt: skip


def uneasy_clock(rng: np.random.Generator) -> Fault:
    """The senders' clock hops to and fro by tens of milliseconds, or runs faster than ours."""
    topics = set(one_of(rng, (SPEED,), NEEDED))
    hop, every = float(rng.uniform(0.03, 0.12)), float(rng.uniform(0.1, 1.0))
    rate, held = float(one_of(rng, 1.0, 1.0, 1.2, 2.0, 5.0)), {}

    def shifted(time: float) -> float:
        passed = time - held.setdefault("first", time)
        return time + (rate - 1.0) * passed + (hop * (int(passed / every) % 2) if rate == 1.0 else 0.0)

    detail = f"{1e3 * hop:.0f} ms each {every:.1f} s" if rate == 1.0 else f"x {rate:g}"
    return Fault("uneasy clock", detail, lambda m, _k, _r: stamped(m, topics, shifted))


def batched(rng: np.random.Generator) -> Fault:
    """A gateway that sends everything, or one topic, only every so often: all that was collected, or the last one."""
    ticks, last = int(rng.integers(2, 15)), bool(rng.integers(2))
    topics, collected = one_of(rng, None, (SPEED,), (REFERENCE,), (SWASH,)), []

    def spoil(messages: Messages, tick: int, _r: np.random.Generator) -> Messages:
        held = [each for each in messages if topics is None or each[0] in topics]
        through = [each for each in messages if not (topics is None or each[0] in topics)]
        collected.append(held)
        if tick % ticks:
            return through
        out = [each for part in (collected[-1:] if last else collected) for each in part]
        collected.clear()
        return [*out, *through] if topics != (SPEED,) else [*through, *out]

    which = "the last" if last else "all"
    return Fault("batched", f"{which} each {TICK * ticks:.2f} s", spoil)


def changed_over(rng: np.random.Generator) -> Fault:
    """The hoses' sensors exchanged, a load that is picked up or set down, or a drum's sign, in mid-run."""
    how = one_of(rng, "ports exchanged", "load steps")
    factor = float(rng.uniform(0.1, 2.5))
    ports = {ACTIVE_A: ACTIVE_B, ACTIVE_B: ACTIVE_A}

    def spoil(messages: Messages, tick: int, r: np.random.Generator) -> Messages:
        if how == "load steps":
            return edited(LOAD, lambda m, _k, _r: set_value(m, LOAD, lambda v: factor * v))(messages, tick, r)
        found = dict(messages)
        return [(name, found.get(ports.get(name, name), message)) for name, message in messages]

    return Fault("changed over", how if how == "ports exchanged" else f"load x {factor:.2f}", spoil)


def slow_channels(rng: np.random.Generator) -> Fault:
    """The wire's layer, its length, the oil's temperature or the heave jump, vanish, or say what cannot be."""
    topics = rng.choice((LAYER, OIL, WIRE, HEAVE), size=int(rng.integers(1, 4)), replace=False).tolist()
    value = one_of(rng, -1.0, 0.0, 1.0, 2.5, 3.0, 99.0, 1e9, -1e9, math.nan, math.inf)
    each_tick = bool(rng.integers(2))

    def change(message: Any, _tick: int, r: np.random.Generator) -> None:
        name = "temperature" if hasattr(message, "temperature") else "data"
        setattr(message, name, value if not each_tick or r.random() < 0.5 else getattr(message, name))

    def spoil(messages: Messages, tick: int, r: np.random.Generator) -> Messages:
        for topic in topics:
            messages = edited(topic, change)(messages, tick, r)
        return messages

    return Fault("slow channels", f"{', '.join(topics)}: {value:g}", spoil)


SENT = (malformed, stall, joint_arrays, lagging, uneasy_clock, batched, changed_over, slow_channels)
