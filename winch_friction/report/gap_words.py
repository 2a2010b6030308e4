"""The discrepancy result in words: the verdict, its size, how sure it is, and what to do next."""

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from winch_friction.discrepancy.run_states import EACH_RUN, SOME_RUNS
from winch_friction.physics.channels import RPM
from winch_friction.physics.effects import effect_text
from winch_friction.physics.errors import counted
from winch_friction.physics.friction import FrictionModel, Parameter, registered_terms
from winch_friction.physics.friction.term import file_of
from winch_friction.report.tables import estimate_for_people, number

if TYPE_CHECKING:
    from winch_friction.report.gap import GapResult

# mm RMS that stay of the heave per N m RMS of friction that is not fed forward: 8.9 mm of 457 N m to 24.3 mm of 648 N m
# on the three legs of the demo, whose controller and simulated 150 t crane they belong to
HEAVE_PER_TORQUE = (0.019, 0.037)
FAST = 0.9  # quantile of speed from which blocks count as top speed
HELD = 1e-9  # of its typical size: with no more deviation a shape stands where it was tried, and nothing was fitted
_VALUE = re.compile(r"(\w+) = ([-+.\de]+)(?=,|$| and )")  # of a shape, without a unit: SI


def shape_in_words(variant: str) -> str:
    """A shape's values, `C4 = 12.57`, in the units that people read them in, `C4 = 120 rpm`."""
    return _VALUE.sub(_with_unit, variant)


def _with_unit(found: re.Match[str]) -> str:
    declared = _declared(found[1])
    if declared is None or declared.unit in ("1", ""):
        return found[0]
    value, _, unit = estimate_for_people(float(found[2]), 0.0, declared.unit)
    shown = value.partition(" ")[0] if isinstance(value, str) else f"{number(value)} {unit}"  # a date, to the day
    return f"{found[1]} = {shown}"


def amount_in_units(name: str, value: float, std: float, unit: str) -> tuple[Any, float, str]:
    """A parameter's value, deviation and unit as people read them; the deviation is NaN of a shape that was tried and
    not fitted."""
    declared = _declared(name)
    tried = declared is not None and declared.shape and std <= HELD * abs(declared.typical)
    shown, deviation, said = estimate_for_people(value, std, unit)
    return shown, np.nan if tried else deviation, said


def _declared(name: str) -> Parameter | None:
    """The parameter of this name, which stands for the same in all terms."""
    every = (each for term in registered_terms().values() for each in term.parameters)
    return next((each for each in every if each.name == name), None)


def verdict_sentence(result: "GapResult") -> str:
    """The verdict in one sentence."""
    titles = "; ".join(f"{e.name} ({_lowered(effect_text(e.name).title)})" for e in result.effects)
    if result.verdict == "nothing_missing":
        return "Nothing is missing: what is left is noise and parameters within the model's own uncertainty."
    if result.verdict == "unexplained":
        signals = ", ".join(result.depends_on) or "no recorded signal"
        said = f"Something is missing that no named effect explains; it depends on {signals} ({result.refused})."
        return f"{said} {_proposed(result)}".rstrip()
    if result.verdict == "insufficient":
        return f"These runs cannot answer the question: {result.refused}."
    if result.verdict == "ambiguous":
        rivals = "; ".join(f"{e.name} or {' or '.join(e.rivals)}" for e in result.effects if e.rivals)
        return f"Missing: {titles}. These runs cannot tell apart: {rivals}."
    return f"Missing: {titles}."


def _proposed(result: "GapResult") -> str:
    """The simplest law that is proposed, in a sentence; nothing without one."""
    if not result.proposals:
        return ""
    first, more = result.proposals[0].sentence, len(result.proposals) - 1
    others = f" ({counted(more, 'other law does', 'other laws do')} about as well)" if more else ""
    return f"A law is proposed{others}: {first}."


def _lowered(title: str) -> str:
    return title[:1].lower() + title[1:]


def facts(result: "GapResult") -> list[tuple[str, str]]:
    """Size, proof and certainty, each in a few words."""
    side, unit = result.holdout, shown_unit(result)
    if not side.blocks.y.size:
        return [
            (each.what, "none of these" if each.sentence == each.what else each.sentence.removeprefix(f"{each.what}: "))
            for each in result.adequacy
            if not each.met
        ]
    found = [
        ("Gap on locked runs", f"{number(side.size_before.value, 3)} → {number(side.size_after.value, 3)} {unit} RMS"),
        ("Noise floor", f"{number(side.noise_floor, 3)} {unit}"),
    ]
    if result.effects:
        found.insert(0, ("What the repair changes at top speed", top_speed_change(result)))
        found += [("Heave that it would leave, RMS", left_of_heave(result)), ("How sure", how_sure(result))]
    return found


def left_of_heave(result: "GapResult") -> str:
    """What a feedforward without the repair would leave of the heave; nothing for a drive without hydraulics."""
    if result.unit != "bar":
        return ""
    low, high = (rate * gap_torque(result) for rate in HEAVE_PER_TORQUE)
    return f"{number(low, 2)} to {number(high, 2)} mm with the simulated 150 t crane's controller"


def gap_torque(result: "GapResult") -> float:
    """RMS over the locked runs of what the repair changes, N m at the motor shaft."""
    side = result.holdout
    rate = np.array([run.unit_torque for run in side.runs])[side.blocks.run]
    return float(np.sqrt(np.mean((rate * (side.before - side.after)) ** 2)))


def shown_unit(result: "GapResult") -> str:
    """The unit of the gap as people write it."""
    return "N·m" if result.unit == "N*m" else result.unit


def top_speed_change(result: "GapResult") -> str:
    """Mean size of before minus after among the fastest blocks of all runs, N m at the shaft and bar."""
    torque, pressure, speed = [], [], []
    for side in (result.train, result.holdout):
        rate = np.array([run.unit_torque for run in side.runs])[side.blocks.run]
        change = np.abs(side.before - side.after)
        speed.append(side.blocks.features["motor_speed"])
        torque.append(change * rate)
        pressure.append(change)
    fast = np.concatenate(speed)
    top = fast >= np.quantile(fast, FAST)
    size, bar = float(np.concatenate(torque)[top].mean()), float(np.concatenate(pressure)[top].mean())
    text = f"{number(size, 3)} N·m"
    text += f" = {number(bar, 3)} bar" if result.unit == "bar" else ""
    return f"{text} above {number(float(fast[top].min()) / RPM, 3)} rpm"


def how_sure(result: "GapResult") -> str:
    """The weakest of the effects' evidence."""
    weakest = max(result.effects, key=lambda e: e.p_value)
    chance = "below 1 in 1000" if weakest.p_value < 1e-3 else f"p = {weakest.p_value:.2g}"
    first = f"named first in {100 * weakest.selection_frequency:.0f} % of redrawn data"
    return f"chance finding {chance}; {first}"


def next_steps(result: "GapResult") -> list[str]:
    """What to do now, in order."""
    steps: list[str] = []
    plan: Any = result.next_experiment
    if plan and not plan["separates"]:
        steps.append(
            f"Run `winch-friction simulate {plan['scenario']}`, or its likeness on the crane: it supplies what these "
            "runs lack."
        )
    elif plan and plan["note"]:  # the best of them parts nothing: whoever runs it learns nothing
        steps.append(
            f"No experiment at hand separates {' from '.join(plan['separates'])} (the best one by "
            f"{plan['expected_z']:.1f} sigma): another channel must decide."
        )
    elif plan:
        steps.append(
            f"Separate {' from '.join(plan['separates'])}: run `winch-friction simulate {plan['scenario']}`, or its "
            f"likeness on the crane; it parts them by {plan['expected_z']:.1f} sigma."
        )
    elif result.verdict == "ambiguous":
        steps.append("No scenario at hand tells these names apart: measure what only one of them changes.")
    steps += [f"{e.name}: {effect_text(e.name).look}" for e in result.effects]
    if past := [e.name for e in result.effects if e.law_name in (SOME_RUNS, EACH_RUN)]:
        steps.append(
            f"See what was done between these runs: of {', '.join(past)} model.yaml says what it was in each of them, "
            "and nothing of the next one."
        )
    elif result.effects and (foreign := _not_live(result.model)):
        steps.append(
            f"Mend {foreign} at the source: a running node cannot take it out, and refuses model.yaml while "
            "that is among its corrections."
        )
    elif result.effects:
        own = _terms_file(result.model)
        steps.append(
            f"Replay a bag with model.yaml (`winch-friction replay BAG --model model.yaml{own}`), then let the running "
            f"compensator load it (`winch-friction load model.yaml{own}`); it takes over without a bump."
        )
    if result.verdict == "insufficient":
        lacking = [each for each in result.adequacy if not each.met]
        steps += [
            f"Bring {'' if each.sentence == each.what else 'runs with more of it: '}{each.sentence}."
            for each in lacking
        ]
    if result.verdict == "unexplained":
        steps += _after_no_name(result)
    if result.verdict == "nothing_missing":
        steps.append("Keep the model." if result.levels else "Nothing needs to be done: keep the model.")
    steps += [f"{result.levels}."] if result.levels else []
    return steps


def _terms_file(model: FrictionModel) -> str:
    """The option that a model with terms of a user's own file needs."""
    return "".join(sorted({f" --terms-file {file.name}" for term in model.terms if (file := file_of(term))}))


def _not_live(model: FrictionModel) -> str:
    """Names of what a model corrects and a running node cannot."""
    return ", ".join(dict.fromkeys(each.name for each in model.corrections if not each.declared.live))


def _after_no_name(result: "GapResult") -> list[str]:
    """What to do where no effect has the gap's name."""
    if not result.proposals:
        return [
            "Plot what is left, below, over the signals that it depends on, or declare a term of your own and pass it "
            "with --effects."
        ]
    files = "--model proposal_1.yaml --terms-file proposal_1.py"
    return [
        "Ask what on this crane could act as the proposed law does: it names no cause.",
        f"To use it without a cause: `winch-friction replay BAG {files}`; model.yaml does not hold it. Runs of another "
        "day tell whether it lasts: `winch-friction gap RUNS --model proposal_1.yaml --effects proposal_1.py`.",
    ]
