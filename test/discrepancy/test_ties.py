"""What the equations make one thing has parallel regressors, and is never given a single name."""

from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from gap_rig import names_of, runs_with

from campaign.gap import diagnose
from campaign.gap_cases import Case
from campaign.rig import DRAWN
from winch_friction.discrepancy import ties as module
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
from winch_friction.physics.friction.symbols import GROUP_SIGNALS, WINCH_SIGNALS
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


@pytest.mark.long
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


@pytest.mark.parametrize(
    ("which", "spoken", "column"),
    [
        (0.0, (True, True), 3 * 2e-5 * 1e7 + 2 * 4e-5 * 5e6 - (7e6 * 2e-5 - 4e-6 * 1e7) - 9e6 * 4e-5),
        (1.0, (True, False), 3 * 2e-5 * 1e7 - (7e6 * 2e-5 - 4e-6 * 1e7)),
        (2.0, (False, True), 2 * 4e-5 * 5e6 - 9e6 * 4e-5),
    ],
)
def test_a_displacement_that_is_read_too_large_is_more_torque_less_the_friction_predicted_by_it(
    monkeypatch, which, spoken, column
):
    """Of a friction of 7 MPa times the stroke and 4 cm^3 times the pressure of the driving motors, and 9 MPa times that
    of the passive ones. The driving group's pressure is predicted from its torque: at a larger stroke a smaller one."""
    names = [signal.name for signal in GROUP_SIGNALS]

    def torque(point, states):
        at = lambda k, name: point[len(WINCH_SIGNALS) + k * len(names) + names.index(name)]
        return 7e6 * at(0, "displacement") + 4e-6 * at(0, "pressure") + 9e6 * at(1, "displacement")

    groups = [
        SimpleNamespace(name="active", balances=True, count=3, displacement=2e-5, pressure=1e7),
        SimpleNamespace(name="passive", balances=False, count=2, displacement=4e-5, pressure=5e6),
    ]
    point = [np.zeros(2)] * len(WINCH_SIGNALS)
    for group in groups:
        own = {"displacement": group.displacement, "pressure": group.pressure}
        point += [np.full(2, own.get(name, 0.0)) for name in names]
    run = SimpleNamespace(groups=groups, point=tuple(point), time=np.zeros(2), dt=0.02)
    monkeypatch.setattr(module, "model_states", lambda *_: ())
    found = module._displacement_columns(SimpleNamespace(torque=torque), run, {"groups": which})
    assert found == pytest.approx(np.full((2, 1), column), rel=2e-3)
    assert module.spoken_of(run, {"groups": which}) == list(spoken)


def test_a_load_that_is_read_too_large_is_as_much_more_of_what_hangs(monkeypatch):
    monkeypatch.setattr(module, "hanging", lambda run, mass: 9.81 * mass)
    run = SimpleNamespace(load=np.array([1e3, 2e3]))
    assert module._load_columns(run, {}) == pytest.approx(np.array([[9810.0], [19620.0]]))


@pytest.mark.parametrize(
    ("names", "losses", "found"),
    [
        # the finding's own partner, and that of its second rival
        (("gear_load_loss", "x", "pressure_scale"), (30.0, 20.0, 25.0), [("displacement_scale", 2)]),
        (("pressure_scale", "x"), (20.0, 25.0), [("displacement_scale", 0)]),
        (("x", "layer_radius"), (20.0, 25.0), [("load_scale", 1)]),
        (("x", "y"), (20.0, 25.0), []),
    ],
)
def test_what_is_tied_to_a_finding_or_to_a_rival_has_its_size_beside_that_of_the_one_it_is_tied_to(
    monkeypatch, names, losses, found
):
    """Names that do as well: those that leave least stay, what shows as a product alone comes last."""
    labels = {"pressure_scale": "all groups, both ports", "layer_radius": "all layers"}
    slots = [Slot(name, labels.get(name, ""), (k,), origin=(f"of {name}", "shape")) for k, name in enumerate(names)]
    own, *rivals = slots
    asked = []

    def laid_out(base, fixed, runs, model):
        asked.append((fixed, [run.name for run in runs]))
        return SimpleNamespace(slots=tuple(f"slot {k}" for k in range(len(fixed))))

    def explain(slots):
        k = int(slots[-1].removeprefix("slot ")) if slots else None
        loss = 100.0 if k is None else losses[k] if k < len(losses) else 22.0
        return SimpleNamespace(loss=loss, at=k, slots=slots)

    unsought_ones = [SimpleNamespace(name=name, shapes=lambda _: [SimpleNamespace(label="all groups")])
                     for name in module.UNSOUGHT]  # fmt: skip
    partners = lambda tie, cross, of, trial: SimpleNamespace(
        name=tie.second.name, of=of.at, own=trial.at, size=SimpleNamespace(value=1.0)
    )
    monkeypatch.setattr(module, "layout_of", laid_out)
    monkeypatch.setattr(module, "build_problem", lambda runs, layout, known: known)
    monkeypatch.setattr(module, "CrossFit", lambda problem: SimpleNamespace(explain=explain))
    monkeypatch.setattr(module, "_fixed", lambda candidate, shape: candidate)
    monkeypatch.setattr(module, "unsought", lambda model: unsought_ones)
    monkeypatch.setattr(module, "does_as_well", lambda *_: True)
    monkeypatch.setattr(module, "_partner", partners)
    search = SimpleNamespace(
        expansion=SimpleNamespace(
            model=None, runs=[SimpleNamespace(name=name) for name in ("a", "locked")],
            layout=SimpleNamespace(base=None),
        ),
        train=("a",), selection=SimpleNamespace(final=SimpleNamespace(slots=(own,))),
    )  # fmt: skip
    said = company(search, Finding(own, tuple(rivals), 0.0, 0.1, 1.0, no_room=("fourth",)))
    assert [(each.name, each.of, each.own) for each in said.partners] == [
        (name, k, len(names)) for name, k in found
    ]  # fmt: skip
    assert all(runs == ["a"] for _, runs in asked)
    left = dict(zip(names[1:], losses[1:], strict=True))
    left |= {name: np.inf if name == "load_scale" else 22.0 for name, _ in found}
    best = sorted(left, key=left.get)
    assert said.rivals == (tuple(best[:2]) if found else names[1:])
    assert said.no_room == (*best[2:], "fourth")


def test_estimates_of_which_only_one_is_new_go_together_as_in_the_search():
    """The file's own covariance is of what the search did not have; the other's is that of the seed."""
    names = ["a", "b"]
    slot = SimpleNamespace(columns=(4, 5), origin=(SimpleNamespace(linear=[SimpleNamespace(name=n) for n in names]),))
    cross = SimpleNamespace(
        problem=SimpleNamespace(columns=lambda _: (0, 4, 5)),
        covariance=lambda _: np.array([[1.0, 0.0, 0.0], [0.0, 4.0, 3.0], [0.0, 3.0, 9.0]]),
    )
    file = SimpleNamespace(parameter_names=("b", "x", "a"), covariance=np.arange(9.0).reshape(3, 3))
    final = SimpleNamespace(final=SimpleNamespace(slots=(slot,)))
    estimates = {name: ParameterEstimate(1.0, std, "1") for name, std in (("a", 0.2), ("b", 6.0))}
    for had, wanted in ((("b",), [[0.04, 0.6], [0.6, 36.0]]), ((), [[8.0, 6.0], [2.0, 0.0]])):
        given = SimpleNamespace(model=SimpleNamespace(parameter_names=had))
        search = SimpleNamespace(cross=cross, given=given, selection=final)
        np.testing.assert_allclose(_covariance(search, SimpleNamespace(slot=slot), estimates, names, file), wanted)


@pytest.mark.parametrize(
    ("first", "second", "tied", "combined"),
    [
        (10.0, 10.0, 0.7, False),  # both are known alone
        (10.0, 1.0, 0.7, True),  # one is not
        (1.0, 10.0, 0.7, True),
        (-10.0, -10.0, -0.95, True),
        (10.0, 10.0, -0.85, False),
        (1.0, 1.0, -0.45, False),
        (1.0, 1.0, -0.55, True),
    ],
)
def test_estimates_are_combined_where_they_are_tied_and_sooner_where_either_is_unknown(first, second, tied, combined):
    estimates = {"a": ParameterEstimate(first, 1.0, "1"), "b": ParameterEstimate(second, 1.0, "1")}
    found = _best_pair(np.array([[1.0, tied], [tied, 1.0]]), estimates, ["a", "b"])
    assert (found is not None) is combined
    if found is not None:
        assert (found.value, found.std) == pytest.approx((first - tied * second, np.sqrt(1.0 - tied**2)))
