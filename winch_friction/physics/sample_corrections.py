"""Corrections taken out of what a running node reads, one sample after the other."""

import math
from dataclasses import replace

from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.corrections import SIGNAL_ORDER, corrected_crane, in_turn, true_value
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.declared_correction import Action
from winch_friction.physics.friction.model import FrictionModel
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.physics.winch.crane import Crane


class SampleCorrector:
    """Takes a model's corrections out of one sample after the other; `crane` is the crane as corrected.

    What a running node cannot take out (a delay, a gas that cools) is refused with `InputError`, by name, if it may be
    there from `since` on (s, the samples' clock now; not known: whenever it may be there at all), unless `refuse` is
    False: then `uncorrected` names it, together with what the latest sample lacked the channel for. What was over by
    then is `past`, with the end of its last window; a clock that is set back into such a window makes it `standing`.
    """

    def __init__(self, crane: Crane, model: FrictionModel, refuse: bool = True, since: float = -math.inf) -> None:
        for name, value, kind in ("crane", crane, Crane), ("model", model, FrictionModel):
            if not isinstance(value, kind):  # the two exchanged, or the name of a file
                raise InputError(
                    f"{name} must be a {kind.__name__} (wf.load_{name} reads one), found a {type(value).__name__}"
                )
        self.crane = corrected_crane(crane, model.corrections, model.name)
        foreign = [c for c in model.corrections if not c.declared.live]
        self._over = [c for c in foreign if c.ends < since]
        self.impossible = tuple(dict.fromkeys(c.name for c in foreign if not c.ends < since))
        if refuse and self.impossible:
            raise InputError(
                f"model '{model.name}': a running node cannot take out {', '.join(self.impossible)}; "
                "mend it at its source and take it out of the model's corrections, or end its windows ('during')"
            )
        self.past = {c.name: max(e.ends for e in self._over if e.name == c.name) for c in self._over}
        live = [c for c in in_turn(model.corrections) if c.declared.live]
        self._signals = [c for action in SIGNAL_ORDER for c in live if c.declared.action is action]
        self._lacking: tuple[Correction, ...] = ()
        self._weighed = False  # a load cell that falls silent leaves the rope's force as it was
        self.idle = not (self._signals or self._over)  # it changes no sample and refuses none

    @property
    def uncorrected(self) -> tuple[str, ...]:
        """Names of corrections that the latest sample went without."""
        return self.impossible + tuple(c.name for c in self._lacking)

    def standing(self, time: float) -> tuple[str, ...]:
        """Names of what was taken to be over and is there at `time` s all the same: the sample cannot be used."""
        return tuple(dict.fromkeys(c.name for c in self._over if c.holds(time)))

    def left(self, time: float) -> tuple[str, ...]:
        """What is known to be wrong with the latest sample, at `time` s, and was not taken out: in words."""
        over = [f"{name} cannot be taken out" for name in self.standing(time)]
        without = [f"{c.name} cannot be taken out without {', '.join(c.declared.reads)}" for c in self._lacking]
        return (*over, *without)

    def __call__(self, sample: Sample) -> Sample:
        """The sample without its errors; the given one is left as it is."""
        if not self._signals:
            return sample
        groups = {name: replace(member) for name, member in sample.groups.items()}
        out = replace(sample, groups=groups)
        self._weighed = self._weighed or math.isfinite(sample.hook_load)
        there = (c for c in self._signals if c.holds(sample.time))
        self._lacking = tuple(c for c in there if not _correct(out, c, self._weighed))
        return out


def past_corrections(corrector: SampleCorrector) -> str:
    """What a model says of a time that is over, and is not taken out of what comes now: for diagnostics."""
    return ", ".join(f"{name} until {end:.0f} s" for name, end in corrector.past.items())


def _correct(sample: Sample, c: Correction, weighed: bool) -> bool:
    """Correct a sample in place; False where it lacks what that takes. What a mass is missing in is the rope's force
    where no load was ever `weighed`."""
    if c.declared.action is Action.MASS:
        length = sample.wire_out if "wire_out" in c.declared.reads else 1.0
        if math.isfinite(length):
            mass = float(c.error(sample.time, None)) * length
            sample.hook_load += mass
            if not weighed and math.isfinite(sample.rope_force):
                sample.rope_force += GRAVITY * mass
        lacks = math.isfinite(sample.hook_load) or (math.isfinite(sample.rope_force) and not weighed)
        return math.isfinite(length) or not lacks
    error = float(c.error(sample.time, sample.oil_temperature))
    if error != error:
        return False
    for name, member in sample.groups.items():
        if not c.groups or name in c.groups:
            _correct_group(member, c, error)
    return True


def _correct_group(member: GroupSample, c: Correction, error: float) -> None:
    for channel in c.declared.channels:
        setattr(member, channel, float(true_value(getattr(member, channel), c, error)))
