"""More kinds of faults: several channels at once, sensors that change places, clocks that run wrong, coarse values."""

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
    doubled,
    edited,
    one_of,
    set_value,
    stamped,
    stuck_at,
)
from winch_friction.online.agreement import SLOWEST

BAR = 1e5  # Pa
BIASED_IN = 10.0  # s in which a bias has come
PERIODS_PER_SECOND = 50.0


def frozen_and_step(rng: np.random.Generator) -> Fault:
    """Two channels repeat one value while a third steps."""
    topics = rng.choice((SPEED, REFERENCE, ACTIVE_A, ACTIVE_B, SWASH, LOAD), size=3, replace=False).tolist()
    factor = float(rng.uniform(-1.5, 2.0))
    first, second = stuck_at(topics[0]), stuck_at(topics[1])
    step = edited(topics[2], lambda m, _k, _r: set_value(m, topics[2], lambda v: factor * v))
    return Fault(
        "two frozen, one steps",
        f"{topics[0]}, {topics[1]}; {topics[2]} x {factor:.2f}",
        lambda m, k, r: step(second(first(m, k, r), k, r), k, r),
        blind={SPEED, REFERENCE} <= set(topics),
    )


def slow_stamp(rng: np.random.Generator) -> Fault:
    """Stamps that advance at half the speed, as those of a slow simulation do, or hardly at all."""
    rate, held = float(one_of(rng, 0.5, 0.3, 0.05)), {}
    topics = set(one_of(rng, (SPEED,), NEEDED))

    def late(time: float) -> float:
        first = held.setdefault("first", time)
        return first + rate * (time - first)

    spoil = lambda m, _k, _r: stamped(m, topics, late)
    return Fault("slow stamps", f"x {rate:g}", spoil, silences=rate < SLOWEST, detection=0.0)


def groups_swapped(rng: np.random.Generator) -> Fault:
    """The active and the passive group's sensors change places."""
    names = ("pressure_a", "pressure_b", "displacement")
    some = names if rng.random() < 0.5 else (one_of(rng, *names),)
    other = {
        f"winch/{g}/{n}": f"winch/{o}/{n}" for n in some for g, o in (("active", "passive"), ("passive", "active"))
    }

    def spoil(messages: Messages, _tick: int, _r: np.random.Generator) -> Messages:
        found = dict(messages)
        out = []
        for name, message in messages:
            source = found.get(other.get(name, name), message)
            out.append((name, copy.copy(source) if source is not message else message))
        return out

    return Fault("groups swapped", ", ".join(some), spoil)


def unit_changed(rng: np.random.Generator) -> Fault:
    """bar that become Pa in mid-run, rad/s that are called rpm, kg that are pounds, a fraction that is per cent."""
    topic, factor = one_of(
        rng, (ACTIVE_A, 1e5), (ACTIVE_B, 1e5), (ACTIVE_A, 1e-3), (ACTIVE_A, 14.5038), (SPEED, math.pi / 30.0),
        (REFERENCE, math.pi / 30.0), (LOAD, 2.2046), (LOAD, 1e3), (SWASH, 0.01),
    )  # fmt: skip
    spoil = edited(topic, lambda m, _k, _r: set_value(m, topic, lambda v: v * factor))
    impossible = factor == 1e5 and topic == ACTIVE_A
    return Fault("unit changed", f"{topic} x {factor:.3g}", spoil, silences=impossible, detection=0.05)


def coarse(rng: np.random.Generator) -> Fault:
    """Values in steps: 5 bar, 2 rad/s, 5 % of displacement, 5 t."""
    topic, step = one_of(rng, (ACTIVE_A, 5.0 * BAR), (SPEED, 2.0), (REFERENCE, 5.0), (SWASH, 0.05), (LOAD, 5e3))
    spoil = edited(topic, lambda m, _k, _r: set_value(m, topic, lambda v: step * float(np.rint(v / step))))
    return Fault("coarse steps", topic, spoil)


def contradicting_copies(rng: np.random.Generator) -> Fault:
    """Every message twice under one stamp, with different values."""
    topic, factor = one_of(rng, SPEED, REFERENCE, ACTIVE_A, SWASH, LOAD), float(rng.uniform(-1.0, 2.0))

    def spoil(messages: Messages, _tick: int, r: np.random.Generator) -> Messages:
        def either_first(own: Any, other: Any) -> Messages:
            return [own, other] if r.integers(0, 2) == 0 else [other, own]

        return doubled(messages, topic, lambda v: factor * v, either_first)

    return Fault("copies that contradict", topic, spoil)


def bias(rng: np.random.Generator) -> Fault:
    """A bias that comes within ten seconds."""
    topic, size = one_of(rng, (SPEED, 30.0), (ACTIVE_A, 80.0 * BAR), (ACTIVE_B, 80.0 * BAR), (SWASH, 0.3), (LOAD, 4e4))
    rate, begun = float(rng.choice((-1.0, 1.0))) * size / BIASED_IN, {}

    def change(message: object, tick: int, _r: np.random.Generator) -> None:
        since = (tick - begun.setdefault("tick", tick)) / PERIODS_PER_SECOND
        set_value(message, topic, lambda v: v + rate * since)

    return Fault("growing bias", topic, edited(topic, change))


def crossed(rng: np.random.Generator) -> Fault:
    """The command comes as the measured speed and the other way round, or one of them as both."""
    both = one_of(rng, None, SPEED, REFERENCE)

    def spoil(messages: Messages, _tick: int, _r: np.random.Generator) -> Messages:
        found = dict(messages)
        values = {name: found[name].velocity for name in (SPEED, REFERENCE) if name in found}
        out = []
        for name, message in messages:
            source = (both or (REFERENCE if name == SPEED else SPEED)) if name in values else ""
            if source in values:
                message = copy.copy(message)
                message.velocity = list(values[source])
            out.append((name, message))
        return out

    return Fault("speed and command crossed", both or "exchanged", spoil)


def dead_zero(rng: np.random.Generator) -> Fault:
    """Sensors that lost their supply say exactly zero, with fresh stamps."""
    topics = set(
        rng.choice((SPEED, ACTIVE_A, ACTIVE_B, SWASH, LOAD), size=int(rng.integers(1, 4)), replace=False).tolist()
    )

    def spoil(messages: Messages, tick: int, r: np.random.Generator) -> Messages:
        for topic in topics:
            messages = edited(topic, lambda m, _k, _r, topic=topic: set_value(m, topic, lambda _v: 0.0))(
                messages, tick, r
            )
        return messages

    return Fault("dead zero", ", ".join(sorted(topics)), spoil)


def jittered_stamps(rng: np.random.Generator) -> Fault:
    """Stamps that stagger by tens of milliseconds, forwards and back."""
    size, topics = float(rng.uniform(0.005, 0.08)), set(NEEDED)
    return Fault(
        "staggering stamps", f"{1e3 * size:.0f} ms",
        lambda m, _k, r: stamped(m, topics, lambda time: time + size * r.standard_normal()), blind=True,
    )  # fmt: skip


def clipped(rng: np.random.Generator) -> Fault:
    """A channel that saturates far below what is there."""
    topic, most = one_of(rng, (SPEED, 40.0), (REFERENCE, 40.0), (ACTIVE_A, 120.0 * BAR), (SWASH, 0.3), (LOAD, 2e4))
    spoil = edited(topic, lambda m, _k, _r: set_value(m, topic, lambda v: max(-most, min(most, v))))
    return Fault("clipped", topic, spoil)


def now_and_then(rng: np.random.Generator) -> Fault:
    """A loose contact, a sender among several: the sign of speed or command is right in one message of so many."""
    topic, each, batch = one_of(rng, SPEED, REFERENCE), int(rng.integers(2, 9)), int(rng.integers(1, 4))

    def change(message: Any, tick: int, _r: np.random.Generator) -> None:
        if tick // batch % each:
            set_value(message, topic, lambda v: -v)

    return Fault("wrong, now and then right", f"{topic}: {batch} of {batch * each}", edited(topic, change))


MIXED = (
    now_and_then,
    frozen_and_step, slow_stamp, groups_swapped, unit_changed, coarse, contradicting_copies, bias, crossed, dead_zero,
    jittered_stamps, clipped,
)  # fmt: skip
