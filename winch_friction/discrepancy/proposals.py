"""Laws for what has no name: searched on the training runs, proven on the locked ones, and called proposals.

A proposal says on what the gap depends and how, with amounts and units, so that it shrinks; not what it is.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from winch_friction.discrepancy.answer import AMBIGUOUS, MISSING, UNEXPLAINED, Verdict
from winch_friction.discrepancy.candidates.candidate import ParameterEstimate
from winch_friction.discrepancy.candidates.friction import friction_candidate
from winch_friction.discrepancy.closer_laws import closer, fitted
from winch_friction.discrepancy.engine.crossfit import flip_p_values
from winch_friction.discrepancy.engine.grammar import Grammar, Scored
from winch_friction.discrepancy.engine.selection import Finding, Selection
from winch_friction.discrepancy.expansion import expand_around
from winch_friction.discrepancy.law_as_term import ProposedTerm, amount_in_words, declare, in_words
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.proof import Side, Trial, adds, fits_only_its_own, left_beside_a_refit, unproven
from winch_friction.discrepancy.search import Search
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.discrepancy.vocabulary import BY_NAME, WORDS, covered, evaluated, factors
from winch_friction.physics.channels import beside
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.term import known_for_now

FIRST_STEP = 0.25  # of a constant: half the way between two of the grid's


@dataclass(frozen=True)
class Proposal:
    """One proposed law with its evidence on locked runs; `text` is its file of terms, `model` the repaired model."""

    declared: ProposedTerm
    parameters: dict[str, ParameterEstimate]
    text: str
    model: FrictionModel
    before: float
    after: float
    noise_floor: float
    unit: str
    p_value: float
    weight: int = 0  # of its law: words and constants, how much there is to read
    held: Side | None = field(default=None, repr=False, compare=False)  # the locked runs as it leaves them

    @property
    def closed(self) -> float:
        """Share of the locked gap above the noise that it closes."""
        return (self.before - self.after) / max(self.before - self.noise_floor, 1e-9)

    @property
    def worthwhile(self) -> bool:
        """Whether it closes of the locked gap what a law must close of the others' to be proposed: of its square above
        the noise."""
        removed, above = self.before**2 - self.after**2, self.before**2 - self.noise_floor**2
        return removed >= LIMITS.proposal_gain * above

    @property
    def sentence(self) -> str:
        """In plain words; never a cause."""
        k = next(iter(self.parameters.values()))
        return (
            f"{self.declared.sentence}, {amount_in_words(beside(k.value, k.std), k.unit)}; "
            f"closes {100 * min(self.closed, 1.0):.0f} % of the gap; what it is, the data do not say"
        )

    def content(self, stem: str) -> dict[str, Any]:
        """The entry of `proposals` in gap.json; `stem` names its two files."""
        return {
            "equation": str(self.declared.term.equation), "latex": self.declared.term.latex,
            "opposing": self.declared.term.opposing, "reads": list(self.declared.reads),
            "parameters": {k: {"value": e.value, "std": e.std, "unit": e.unit} for k, e in self.parameters.items()},
            "terms_file": f"{stem}.py", "model_file": f"{stem}.yaml",
            "holdout": {"before": self.before, "after": self.after, "noise_floor": self.noise_floor,
                        "closed": self.closed, "unit": self.unit},
            "p_value": self.p_value, "sentence": self.sentence,
        }  # fmt: skip


Evaluate = Callable[[Search], Trial]


def propose(refit: Trial, train: Sequence[str], evaluate: Evaluate, rng: np.random.Generator) -> tuple[Proposal, ...]:
    """At most three laws for an unexplained gap, the simplest first; none where nothing holds on the locked runs.

    `refit` is the trial without a name; `evaluate` puts the file that a search would write to the locked runs.
    """
    search = refit.search
    if search.verdict.kind != UNEXPLAINED:
        return ()
    runs = [run for run in search.expansion.runs if run.name in train]
    found: list[Proposal] = []
    for scored, p_value in _laws(search, runs, rng)[: LIMITS.proposals_tried]:
        proposal = _proven(refit, train, scored, p_value, evaluate, rng)
        if proposal is not None and proposal.worthwhile:
            found.append(proposal)
        if len(found) == LIMITS.most_proposals:
            break
    best = max((each.closed for each in found), default=0.0)
    return _simplest_first([each for each in found if each.closed >= LIMITS.proposal_share * best], rng)


def _simplest_first(found: Sequence[Proposal], rng: np.random.Generator) -> tuple[Proposal, ...]:
    """The laws by how much there is to read; a longer one stands before a shorter one only where it takes more off the
    locked gap, surely and by an amount that a balance of a winch can tell."""
    order: list[Proposal] = []
    for each in sorted(found, key=lambda one: one.weight):
        shorter = ((k, other) for k, other in enumerate(order) if other.weight < each.weight)
        beaten = (k for k, other in shorter if other.held and each.held and adds(other.held, each.held, rng))
        order.insert(next(beaten, len(order)), each)
    return tuple(order)


def explained(verdict: str, proposals: Sequence[Proposal]) -> bool:
    """Whether a name, or an equation that closes nearly all of the locked gap, says what is missing: then it is not
    the seed that is wrong, however far a fit without them would move it."""
    return verdict in (MISSING, AMBIGUOUS) or any(each.closed >= LIMITS.closes_nearly_all for each in proposals)


def near_laws(
    search: Search, train: Sequence[str], rng: np.random.Generator, without: Sequence[str] = ()
) -> list[Scored]:
    """Laws of the grammar, `without` these kinds of factors, that come near the one that answers for a search's gap
    best, this one, for its length, first."""
    runs = [run for run in search.expansion.runs if run.name in train]
    return [scored for scored, _ in _sure_laws(search, runs, rng, without)]


def _laws(search: Search, runs: Sequence[PreparedRun], rng: np.random.Generator) -> list[tuple[Scored, float]]:
    """The best law and those that are answers of their own beside it, with their chances."""
    before = search.cross.explain(()).loss
    sure = _sure_laws(search, runs, rng, closely=True)
    return [pair for pair in sure if pair is sure[0] or _another(pair[0], sure[0][0], before)]


def _sure_laws(
    search: Search, runs: Sequence[PreparedRun], rng: np.random.Generator, without: Sequence[str] = (),
    closely: bool = False,
) -> list[tuple[Scored, float]]:  # fmt: skip
    """Laws that come near the best on held-out segments, significantly; the simplest first. `closely`: with constants
    between those of the grid."""
    cross, base = search.cross, search.cross.explain(())
    blocks = cross.problem.blocks
    torque = np.array([1.0 / run.unit_torque for run in runs])[blocks.run]
    most = max((len(run.groups) for run in runs), default=1) or 1
    members = np.zeros((most, len(blocks.y)))
    for k, run in enumerate(runs):
        for g, group in enumerate(run.groups):
            members[g, blocks.run == k] = group.count
    grammar = Grammar(cross, base, torque, blocks.direction, members)
    words = [f for word in WORDS for f in factors(word, covered(word, runs)) if f.kind not in without]
    values = evaluated([*words, *(closer(grammar, runs, most) if closely else ())], runs, most)
    fit = partial(fitted, grammar, runs=runs, most=most)
    ranked = grammar.search(values, fit if closely else None)
    excess = max(base.loss - cross.floor, 1e-9)
    if not ranked or base.loss - ranked[0].loss < LIMITS.proposal_gain * excess:
        return []
    best = base.loss - ranked[0].loss
    near = [each for each in ranked if base.loss - each.loss >= LIMITS.proposal_share * best]
    near = [fit(each)[0] if closely else _tuned(grammar, each, runs, most) for each in near[: LIMITS.grammar_judged]]
    p_values = flip_p_values(np.array([base.losses - each.losses for each in near]), rng)
    sure = [(each, float(p)) for each, p in zip(near, p_values, strict=True) if p <= LIMITS.remainder_p]
    sure.sort(key=lambda pair: _order(pair[0], base.loss))
    return sure


def _another(law: Scored, head: Scored, before: float) -> bool:
    """Whether a law is an answer of its own beside the best one, and not that one with something added."""
    more = set(law.law.signals) >= set(head.law.signals)
    return not more and _order(law, before) <= _order(head, before) + LIMITS.as_good


def _order(scored: Scored, before: float) -> float:
    """Log of the loss that is left, with a price for every word and constant."""
    return float(np.log(max(scored.loss, 1e-9) / before)) + LIMITS.word_price * scored.law.weight


def _tuned(grammar: Grammar, scored: Scored, runs: Sequence[PreparedRun], most: int) -> Scored:
    """The law with its constants moved to where it fits best, one after the other between the grid's values."""
    best, step = scored, FIRST_STEP
    for _ in range(LIMITS.tuning_rounds):
        for k, factor in enumerate(best.law.factors):
            if BY_NAME[factor.signal].whole:
                continue
            for j, (name, value) in enumerate(factor.constants):
                moved = [value * (1.0 + s) for s in (-step, -0.5 * step, 0.5 * step, step)]
                for trial in moved:
                    constants = (*factor.constants[:j], (name, float(f"{trial:.4g}")), *factor.constants[j + 1 :])
                    other = replace(factor, constants=constants)
                    law = replace(best.law, factors=(*best.law.factors[:k], other, *best.law.factors[k + 1 :]))
                    judged = grammar.screened(law, evaluated(law.factors, runs, most))
                    if judged.inside < best.inside:
                        best, factor = judged, other
        step *= 0.5
    return grammar.judged(best, evaluated(best.law.factors, runs, most))


def _proven(
    refit: Trial, train: Sequence[str], scored: Scored, p_value: float, evaluate: Evaluate, rng: np.random.Generator
) -> Proposal | None:
    """A law as a term, refitted with the model and put to the locked runs; None where these do not bear it out."""
    if sum(factor.kind == "lag" or factor.signal == "run_time" for factor in scored.law.factors) > 1:
        return None  # one memory is all that a proposal may have
    declared = declare(scored.law, scored.amount)
    grid = {name: (value,) for name, value in declared.constants.items()}
    candidate = friction_candidate(declared.term, grid, hydraulic=False, own_size=True)
    with known_for_now(declared.term):
        own = refit.search
        expansion = expand_around(own.given, own.expansion, own.cross.explain(()), [candidate])
        cross = expansion.cross(train, expansion.layout.slots)
        base, final = cross.explain(()), cross.explain(expansion.layout.slots)
        finding = Finding(final.slots[0], (), p_value, float(cross.gain(base, final)), 1.0)
        selection = Selection(base, final, (finding,))
        own = replace(
            refit.search, expansion=expansion, cross=cross, selection=selection, verdict=Verdict(MISSING), left=()
        )
        trial = evaluate(own)
    held = trial.holdout
    if unproven(declared.term.name, refit.holdout, held, rng) or fits_only_its_own(trial.train, held):
        return None
    if left_beside_a_refit(refit.holdout, held) > LIMITS.outdone:
        return None  # what the model's own parameters take off the gap, fitted anew, is not the equation's merit
    found = trial.repaired.parameters[declared.term.name]
    declared = replace(declared, sentence=in_words(scored.law, [found[name].value for name in declared.constants]))
    return Proposal(
        declared, dict(found), declared.text, trial.repaired.model,
        held.size_before.value, held.size_after.value, held.noise_floor, own.given.crane.drive.unit, p_value,
        scored.law.weight, held,
    )  # fmt: skip
