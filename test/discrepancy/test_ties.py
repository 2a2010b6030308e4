"""What the equations make one thing has parallel regressors, and is never given a single name."""

from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from gap_rig import names_of, runs_with

from campaign.gap import diagnose
from campaign.gap_cases import Case
from campaign.rig import DRAWN
from winch_friction.discrepancy.answer import GapOptions
from winch_friction.discrepancy.candidates.candidate import ParameterEstimate
from winch_friction.discrepancy.candidates.families import literature
from winch_friction.discrepancy.candidates.friction import friction_candidate
from winch_friction.discrepancy.catalogue import all_candidates
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.selection import Finding
from winch_friction.discrepancy.preparation.prepare import prepare
from winch_friction.discrepancy.ties import (
    TIES,
    Company,
    Member,
    Partner,
    Tie,
    _best_pair,
    _covariance,
    _partner,
    _times,
    company,
    e_D,
    known_combination,
    unsought,
)
from winch_friction.discrepancy.workflow import find_gap
from winch_friction.physics.friction import term_named
from winch_friction.physics.signals import Run
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model

PARALLEL = 0.98


@cache
def _prepared():
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    # heave compensation at one wire length with the passive motors on, and a constant speed run without them
    return [prepare(run, crane, model) for run in runs_with(4060, "paper")], model


def _candidate(name, model):
    """What no search looks for, else the catalogue's, else a term's."""
    known = {each.name: each for each in (*unsought(model), *all_candidates()) if not each.law_name}
    return known[name] if name in known else friction_candidate(term_named(name))


def _column(member, runs, run, model):
    candidate = _candidate(member.name, model)
    shape = next(each for each in candidate.shapes(runs) if each.label.startswith(member.label))
    columns = candidate.columns(run, shape.values)[run.used]
    return columns[:, np.argmax(np.abs(columns).sum(axis=0))]


@pytest.mark.parametrize("tie", TIES, ids=lambda tie: f"{tie.first.name}-{tie.second.name}-{tie.second.label}")
def test_both_sides_of_a_tie_are_one_column(tie):
    runs, model = _prepared()
    # hook and wire are one at one wire length alone, which each run keeps to
    for some in [[run] for run in runs[:3]] if tie.first.name == tie.second.name else [runs]:
        sides = [
            np.concatenate([_column(member, runs, run, model) / run.unit_torque for run in some])
            for member in (tie.first, tie.second)
        ]
        first, second = (side / np.linalg.norm(side) for side in sides)
        assert abs(first @ second) > PARALLEL


def test_no_tie_is_said_twice_and_each_says_what_would_break_it():
    assert len({(tie.first, tie.second) for tie in TIES}) == len(TIES)
    assert all(tie.why and tie.separates for tie in TIES)


def _scaled(run, factor):
    return Run(run.name, {k: v * factor if k.endswith("displacement") else v for k, v in run.columns.items()})


@pytest.mark.parametrize("seed", [4061, pytest.param(4062, marks=pytest.mark.long)])
def test_a_gain_error_of_the_displacement_is_no_single_name(seed):
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    runs = [_scaled(run, 1.02) for run in runs_with(seed, "paper")]
    result = find_gap(runs, crane, model, GapOptions(plan=False))
    assert result.verdict == "ambiguous"
    named = names_of(result)
    assert any({"pressure_scale", "displacement_scale"} <= each for each in named), named
    assert all(len(each) <= 3 for each in named)
    for effect in result.effects:
        if effect.name == "pressure_scale":
            known = effect.content()["identifiable_combination"]
            assert known["expression"].startswith("e_p + ")
            assert known["expression"].endswith("e_D")
            assert known["value"] == pytest.approx(0.02, abs=0.01)
    assert any("displacement_scale" in note for note in result.notes)


@pytest.mark.long
def test_what_is_one_with_the_finding_on_any_runs_takes_only_the_room_that_is_left():
    """Radius and load show as a product alone; a third cause that does as well says more than the load beside it."""
    said = diagnose(Case("law", (("gear_asymmetry:catalogue", 1.0),), DRAWN, 26000133, (0.0, 1.5)))
    (names,) = said["sets"]
    assert set(names) == {"gear_asymmetry", "layer_radius", "pressure_scale"}
    assert any("without room in a set" in note and "load_scale" in note for note in said["answer"]["notes"])


def test_hook_and_wire_come_physical_and_with_their_deviations():
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    runs = [_light(run) for run in runs_with(4063, "paper")]
    result = find_gap(runs, crane, model, GapOptions(plan=False))
    effect = next(each for each in result.effects if each.name == "tare_load")
    for each in effect.parameters.values():
        assert each.std > 0.0
    assert effect.parameters.get("mu_w") is None or effect.parameters["mu_w"].value >= 0.0


def _light(run):
    """A load cell that hangs 900 kg and 12 kg/m of wire higher than it says."""
    columns = dict(run.columns)
    columns["hook_load"] = columns["hook_load"] - 900.0 - 12.0 * columns["wire_out"]
    return Run(run.name, columns)


def _between(low, high):
    """Estimates of a hook's mass and a wire's weight from weighings at wire lengths between these, 50 kg each."""
    length = np.linspace(low, high, 40)
    columns = np.column_stack([np.ones(40), length]) / 50.0
    covariance = np.linalg.inv(columns.T @ columns)
    std = np.sqrt(np.diag(covariance))
    names, units, values = ["m_h", "mu_w"], ["kg", "kg/m"], [900.0, 12.0]
    return covariance, {n: ParameterEstimate(*x) for n, *x in zip(names, values, std, units, strict=True)}, names


def test_what_is_tied_is_known_as_a_combination_at_the_length_that_was_run():
    known = _best_pair(*_between(118.0, 122.0))
    assert known.expression == "m_h + 120 m * mu_w"
    assert known.value == pytest.approx(900.0 + 120.0 * 12.0)
    assert known.std == pytest.approx(50.0 / np.sqrt(40), rel=1e-6)
    assert known.unit == "kg"


def test_what_is_known_alone_needs_no_combination():
    assert _best_pair(*_between(0.0, 2000.0)) is None


@pytest.mark.parametrize(("value", "combined"), [(2.0, True), (4.0, False)])  # in deviations of each
def test_what_is_half_tied_is_a_combination_only_where_neither_is_known_alone(value, combined):
    std, names = np.array([50.0, 0.5]), ["m_h", "mu_w"]
    estimates = {n: ParameterEstimate(value * s, s, u) for n, s, u in zip(names, std, ["kg", "kg/m"], strict=True)}
    found = _best_pair(np.outer(std, std) * np.array([[1.0, -0.7], [-0.7, 1.0]]), estimates, names)
    assert (found is not None) is combined
    if combined:
        assert found.expression == "m_h + 70 m * mu_w"
        assert found.std == pytest.approx(50.0 * np.sqrt(1.0 - 0.7**2))


def test_a_partners_size_is_what_it_needs_alone_and_its_factor_what_of_it_is_one_of_the_found():
    own, other = (
        SimpleNamespace(columns=(k,), origin=(SimpleNamespace(linear=(e,)), None)) for k, e in enumerate((None, e_D))
    )
    cross = SimpleNamespace(
        problem=SimpleNamespace(layout=SimpleNamespace(scales=np.array([2.0, 0.5]))),
        covariance=lambda _: np.diag([9.0, 0.25]),
    )
    found, alone = (SimpleNamespace(slots=(s,), beta=np.array([7.0, b])) for s, b in ((own, 3.0), (other, 4.0)))
    partner = _partner(TIES[0], cross, found, alone)
    assert (partner.size.value, partner.size.std, partner.factor) == (2.0, 0.25, 3.0)
    assert partner.parameter == "e_D"


def test_estimates_that_were_fitted_once_more_keep_how_they_go_together():
    """The correlation is the search's, the deviations those of the estimates."""
    names = ["a", "b"]
    slot = SimpleNamespace(columns=(4, 5), origin=(SimpleNamespace(linear=[SimpleNamespace(name=n) for n in names]),))
    cross = SimpleNamespace(
        problem=SimpleNamespace(columns=lambda _: (0, 4, 5)),
        covariance=lambda _: np.array([[1.0, 0.0, 0.0], [0.0, 4.0, 3.0], [0.0, 3.0, 9.0]]),
    )
    unnamed = SimpleNamespace(parameter_names=(), covariance=None)
    search = SimpleNamespace(
        cross=cross, given=SimpleNamespace(model=unnamed),
        selection=SimpleNamespace(final=SimpleNamespace(slots=(slot,))),
    )  # fmt: skip
    estimates = {name: ParameterEstimate(1.0, std, "1") for name, std in (("a", 0.2), ("b", 6.0))}
    found = _covariance(search, SimpleNamespace(slot=slot), estimates, names, unnamed)
    np.testing.assert_allclose(found, [[0.04, 0.6], [0.6, 36.0]])


def test_what_no_tie_speaks_of_keeps_what_a_set_has_no_room_for():
    search = SimpleNamespace(expansion=SimpleNamespace(model=None, runs=()), train=())
    found = Finding(Slot("wear_drift", "", (0,)), (Slot("brake_drag", "", (1,)),), 0.0, 0.1, 1.0, ("coulomb",))
    assert company(search, found) == Company(("brake_drag",), (), ("coulomb",))


def _traces(name, **fixed):
    """Unit vectors over all runs of a law's shapes that have these values."""
    runs, _ = _prepared()
    law = next(each for each in literature() if each.term is not None and each.term.name == name)
    for shape in law.shapes(runs):
        if fixed.items() <= shape.values.items():
            own = np.concatenate([law.columns(run, shape.values)[run.used, 0] for run in runs])
            yield own / np.linalg.norm(own)


def test_a_line_of_each_motors_own_is_a_ports_loss_whichever_way_the_oil_passes():
    """Every one-way shape of a port that goes with the flow through its motor is one of the line, but for its size."""
    lines, ports = list(_traces("line_each_motor", n_le=2.0)), list(_traces("port_one_way", m_po=3.0))
    assert len(ports) == 4
    for port in ports:
        assert max(abs(float(port @ line)) for line in lines) == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize(
    ("factor", "unit", "said"),
    [
        (1.0, "1", "+ e_D"), (-1.01, "1", "- e_D"), (1.03, "1", "+ 1.03 * e_D"), (-0.25, "1", "- 0.25 * e_D"),
        (1.0, "m", "+ 1 m * e_D"), (-120.04, "m", "- 120 m * e_D"),
    ],
)  # fmt: skip
def test_a_summand_has_its_sign_and_no_factor_that_is_nearly_one(factor, unit, said):
    assert _times(factor, unit, "e_D") == said


SIDES = Tie(Member("pressure_scale"), Member("displacement_scale"), "a product", "a gauge")


def test_a_partner_is_said_with_the_size_that_would_do_the_same_and_what_tells_the_two_apart():
    own = Partner(SIDES, ParameterEstimate(0.0234, 0.0041, "1"), 1.0, "e_D")
    assert own.name == "displacement_scale"
    assert own.note == (
        "pressure_scale and displacement_scale (e_D = 0.0234 ± 0.0041) are one thing in these runs (a product); "
        "to tell them apart: a gauge"
    )
    assert "(m = 900 ± 50 kg)" in Partner(SIDES, ParameterEstimate(900.0, 50.0, "kg"), 1.0, "m").note


@pytest.mark.parametrize(("tied_to", "expression"), [("pressure_scale", "e_p + 3 * e_D"), ("brake_drag", None)])
def test_of_an_effect_with_one_amplitude_and_a_partner_their_sum_is_known_as_well_as_the_amplitude(tied_to, expression):
    linear = tuple(SimpleNamespace(name=name) for name in ("e_p", "unseen"))
    found = SimpleNamespace(slot=Slot("pressure_scale", "", (1,), origin=(SimpleNamespace(linear=linear), None)))
    tie = Tie(Member(tied_to), Member("displacement_scale"), "a product", "a gauge")
    partner = Partner(tie, ParameterEstimate(0.01, 0.002, "1"), 3.0, "e_D")
    known = known_combination(None, found, {"e_p": ParameterEstimate(0.03, 0.001, "1")}, [partner], None)
    assert (known and known.expression) == expression
    if known:
        assert (known.value, known.std, known.unit, known.because) == (0.03, 0.001, "1", "a product")


def test_of_three_estimates_the_two_that_are_tied_most_are_combined_by_what_spreads_less():
    """b and c: the one that spreads less keeps its factor of one beside the other."""
    std = np.array([1.0, 2.0, 8.0])
    related = np.array([[1.0, 0.3, 0.2], [0.3, 1.0, 0.95], [0.2, 0.95, 1.0]])
    estimates = {n: ParameterEstimate(v, s, "kg") for n, v, s in zip("abc", (50.0, 60.0, 70.0), std, strict=True)}
    known = _best_pair(np.outer(std, std) * related, estimates, list("abc"))
    assert known.because == "b and c are tied in these runs, correlation 0.950"
    assert known.expression == "c - 3.8 * b"  # 0.95 * 8 / 2
    assert known.value == pytest.approx(70.0 - 3.8 * 60.0)
    assert known.std == pytest.approx(8.0 * np.sqrt(1.0 - 0.95**2))
