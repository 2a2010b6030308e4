"""A law for what has no name: the search on arrays, the file of terms, and the way back in through the verbs."""

import json
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from campaign.rig import make_dataset, write_csv
from winch_friction.cli.main import run as winch_friction
from winch_friction.discrepancy import proposals, vocabulary
from winch_friction.discrepancy.engine.grammar import Factor, Law
from winch_friction.discrepancy.law_as_term import amount_in_words, declare, in_words
from winch_friction.discrepancy.proposals import explained
from winch_friction.discrepancy.vocabulary import BY_NAME, TEXTS, WORDS, factors, shape
from winch_friction.physics.channels import dimension_of, product
from winch_friction.physics.friction import FrictionModel, symbols
from winch_friction.physics.friction.compiled import layout
from winch_friction.physics.friction.term import known_for_now, load_file


def _laws():
    for word in WORDS:
        covered = np.linspace(0.3, 50.0, 200)
        seen = set()
        for factor in factors(word, covered):
            if factor.kind not in seen:
                seen.add(factor.kind)
                yield Law((factor,), opposing=True, each=bool(word.of_group))
    constants = (("c", 20.0), ("h", 5.0))
    for closer in (Factor("hump", "wire_out", constants), Factor("hump", "oil_temperature", constants),
                   Factor("wave", "drum_angle", constants), Factor("grow", "run_time", constants[:1])):  # fmt: skip
        yield Law((closer,), opposing=True)
    two = (Factor("linear", "drum_torque"), Factor("above", "motor_speed", (("c", 90.0),)))
    yield Law(two, opposing=False)


@pytest.mark.parametrize("law", list(_laws()), ids=lambda law: "-".join(f"{f.kind}.{f.signal}" for f in law.factors))
def test_every_law_of_the_grammar_is_a_declared_term_with_units(law):
    declared = declare(law, 2.5)
    term = declared.term
    units = {p.name: p.unit for p in term.parameters}
    for unit in units.values():
        dimension_of(unit)
    powers = {
        "root": 0.5,
        "square": 2.0,
        "step": 0.0,
        "hump": 0.0,
        "fade": 0.0,
        "grow": 0.0,
        "wave": 0.0,
        "sector": 0.0,
    }
    signals = [(BY_NAME[f.signal].unit, powers.get(f.kind, 1.0)) for f in law.factors]
    assert product((term.parameters[0].unit, 1.0), *signals) == dimension_of("N*m")
    assert "what it is the data do not say" in term.source
    model = FrictionModel("m", (term,), tuple(p.typical for p in term.parameters), constants={"gear_ratio": 250.0})
    assert np.isfinite(
        model.compile(2).scalar_torque([1.0] * len(layout(2)), model.values, model.compile(2).initial_states)
    )


def test_a_law_about_a_value_is_tried_at_both_ends_and_in_the_middle():
    about = vocabulary._constants("about", BY_NAME["wire_out"], [10.0, 20.0, 30.0, 40.0, 50.0], 40.0)
    assert [each["c"] for each in about] == [10.0, 30.0, 50.0]


def test_a_proposal_s_name_tells_laws_and_amounts_apart_in_four_signs():
    """Whoever finds the same law of the same amount again, to three figures, finds the same name."""
    law = Law((Factor("linear", "wire_out"),), opposing=True)
    names = [declare(law, amount).term.name for amount in (2.5, 2.5001, 2.51)]
    assert all(re.fullmatch(r"proposal_wire_out_[0-9a-f]{4}", name) for name in names)
    assert names[0] == names[1] != names[2]


def test_the_sentence_has_the_constants_of_the_last_fit():
    """Every 16.9 m was said of a term whose file said 17.4."""
    factors_of = (Factor("above", "motor_speed", (("c", 90.0),)), Factor("wave", "wire_out", (("c", 16.9), ("h", 3.0))))
    law = Law(factors_of, opposing=True)
    assert in_words(law, [90.0, 16.9, 3.0]) == declare(law, 1.0).sentence
    said = in_words(law, [90.0, 17.4, 3.0])
    assert "17.4 m" in said
    assert said == declare(law, 1.0).sentence.replace("16.9", "17.4")


@pytest.mark.parametrize("kind", ["fade", "grow"])
def test_what_goes_with_a_runs_own_time_is_the_same_as_a_memory_that_fades(kind):
    time, own = np.linspace(0.0, 90.0, 10), (("c", 23.0),)
    term = declare(Law((Factor(kind, "run_time", own),), opposing=False), 2.0).term
    functions = FrictionModel("m", (term,), tuple(p.typical for p in term.parameters)).compile(1)
    point, values = [1.0] * len(layout(1)), (2.0, 23.0)
    assert tuple(functions.initial_states) == (1.0,)
    scalar = [functions.scalar_torque(point, values, (float(np.exp(-t / 23.0)),)) for t in time]
    assert scalar == pytest.approx(2.0 * shape(kind, time, dict(own), 0.02))


def test_text_and_arrays_say_the_same():
    """The function over arrays and the equation in the file of terms are two writings of one law."""
    x = np.linspace(0.5, 60.0, 40)
    for kind in TEXTS:
        if kind in ("lag", "sector", "grow"):
            continue
        own = (("c", 23.0),) if kind in ("about", "step", "above", "below", "fade") else ()
        own = (("c", 23.0), ("h", 7.0)) if kind in ("hump", "wave") else own
        term = declare(Law((Factor(kind, "wire_out", own),), opposing=False), 1.0).term
        values = tuple(p.typical for p in term.parameters)
        functions = FrictionModel("m", (term,), values).compile(1)
        at = [str(s) for s in functions._arguments[0]].index("L")
        points = [[1.0] * at + [float(v)] + [1.0] * (len(layout(1)) - 1 - at) for v in x]
        scalar = [functions.scalar_torque(point, values, ()) for point in points]
        assert scalar == pytest.approx(shape(kind, x, dict(own), 0.02)), kind


@pytest.mark.parametrize(
    ("factor", "words"),
    [
        (Factor("above", "pressure", (("c", 1.79e7),)), "with pressure above 179 bar"),
        (Factor("below", "displacement", (("c", 1.4006e-5),)), "with displacement below 88 cm^3/rev"),
        (Factor("step", "motor_speed", (("c", 104.72),)), "as soon as motor speed exceeds 1000 rpm"),
        (Factor("about", "wire_layer", (("c", 3.0),)), "linearly with wire layer, none at 3"),
        (Factor("lag", "pressure", (("c", 10.0),)), "with the pressure of the last 10 s"),
        (Factor("grow", "run_time", (("c", 25.0),)), "rising with run time by 25 s"),
        (Factor("hump", "oil_temperature", (("c", 40.0), ("h", 5.0))), "around 40 degC of oil temperature"),
    ],
)
def test_a_law_is_said_in_the_units_that_people_read_and_declared_in_si(factor, words):
    declared = declare(Law((factor,), opposing=True), 1.0)
    assert declared.sentence == f"friction that opposes motion and acts {words}"
    fitted = () if factor.signal == "wire_layer" else factor.constants
    assert list(declared.constants.values()) == [value for _, value in fitted]


@pytest.mark.parametrize(
    ("value", "unit", "words"),
    [
        (9.28e-6, "N*m/Pa", "0.928 N*m/bar"), (2e-3, "N*m/Pa^0.5", "0.632 N*m/bar^0.5"), (3.0, "N*m", "3 N*m"),
        (0.5, "1", "0.5"), (3e-6, "s/Pa^2", "30000 s/bar^2"), (2.0, "N*m*s/rad", "2 N*m*s/rad"),
    ],
)  # fmt: skip
def test_an_amount_per_pascal_is_said_per_bar(value, unit, words):
    assert amount_in_words(value, unit) == words


def test_the_file_of_terms_declares_the_very_term(tmp_path):
    declared = declare(Law((Factor("lag", "drum_torque", (("c", 12.0),)),), opposing=True), 3e-4)
    path = tmp_path / "proposal.py"
    path.write_text(declared.text)
    with known_for_now(declare(Law((Factor("linear", "wire_out"),), opposing=True), 1.0).term):
        (loaded,) = load_file(path)
    assert loaded == declared.term


def test_a_count_has_whole_constants_that_no_fit_moves():
    """A proposal acted linearly with the wire layer beyond 0.573: there is no such layer."""
    word = BY_NAME["wire_layer"]
    seen = np.repeat([3.0, 4.0, 4.0, 6.0], 50)
    found = list(factors(word, seen))
    assert [(f.kind, dict(f.constants).get("c")) for f in found] == [
        ("linear", None), ("about", 1.0), ("about", 3.0), ("about", 4.0), ("about", 6.0)
    ]  # fmt: skip
    law = Law((Factor("above", "motor_speed", (("c", 90.0),)), found[2]), opposing=True)
    declared = declare(law, 1.0)
    assert list(declared.constants.values()) == [90.0]
    assert "(wire_layer - 3)" in declared.text
    assert "(l - 3)" in str(declared.term.equation)
    assert in_words(law, [95.0]).endswith("above 907 rpm and linearly with wire layer, none at 3")


@pytest.fixture(scope="module")
def drag(tmp_path_factory) -> Path:
    """The verdict on runs with a drag that grows with the wire paid out, as files."""
    folder = tmp_path_factory.mktemp("drag")
    paths = write_csv(folder, make_dataset(77, "si_files", [("wire_out_drag", 1.0)], length=0.4))
    out = folder / "gap"
    assert winch_friction(["gap", *map(str, paths), "--out", str(out), "--no-report"]) == 0
    return out


def test_a_drag_without_a_name_gets_a_law(drag):
    content = json.loads((drag / "gap.json").read_text())
    assert content["verdict"] == "unexplained"
    assert content["effects"] == []
    assert content["unexplained"]["depends_on"][0] == "wire_out"
    assert content["unexplained"]["share_of_gap"] > 0.3
    assert 1 <= len(content["proposals"]) <= 3
    first = content["proposals"][0]
    assert first["reads"] == ["wire_out"]
    amount = next(iter(first["parameters"].values()))
    assert amount["unit"] == "N*m/m"
    assert amount["value"] == pytest.approx(0.12, abs=max(5 * amount["std"], 0.02))  # 12 N m per 100 m
    assert first["holdout"]["closed"] > 0.8
    assert "the data do not say" in first["sentence"]


@pytest.mark.parametrize(
    ("left_of_locked", "beside_a_refit", "said"),
    [(1.0, 0.0, True), (2.0, 0.4, True), (3.0, 0.0, False), (2.0, 0.6, False)],
)
def test_a_law_for_its_own_runs_alone_or_that_a_refit_nearly_replaces_is_not_proposed(
    monkeypatch, left_of_locked, beside_a_refit, said
):
    """All leave the training runs at their floor, and the locked gap falls surely."""
    sides = [SimpleNamespace(size_after=SimpleNamespace(value=left), floor=1.0) for left in (1.0, left_of_locked)]
    law = next(_laws())
    declared = declare(law, 0.1)
    found = {declared.term.name: {name: SimpleNamespace(value=1.0) for name in declared.constants}}
    locked = SimpleNamespace(size_before=SimpleNamespace(value=9.0), noise_floor=1.0, **vars(sides[1]))
    trial = SimpleNamespace(train=sides[0], holdout=locked, repaired=SimpleNamespace(parameters=found, model=None))
    taken = SimpleNamespace(slots=[None])
    cross = SimpleNamespace(explain=lambda slots: taken, gain=lambda *_: 0.5)
    expansion = SimpleNamespace(layout=SimpleNamespace(slots=()), cross=lambda *_: cross)
    monkeypatch.setattr(proposals, "unproven", lambda *_: "")
    monkeypatch.setattr(proposals, "left_beside_a_refit", lambda *_: beside_a_refit)
    monkeypatch.setattr(proposals, "declare", lambda *_: declared)
    monkeypatch.setattr(proposals, "in_words", lambda *_: "a law")
    monkeypatch.setattr(proposals, "replace", lambda of, **_: of)
    monkeypatch.setattr(proposals, "expand_around", lambda *_: expansion)
    crane = SimpleNamespace(drive=SimpleNamespace(unit="bar"))
    search = SimpleNamespace(given=SimpleNamespace(crane=crane), expansion=None, cross=cross)
    refit, scored = SimpleNamespace(search=search, holdout=None), SimpleNamespace(law=law, amount=0.1)
    rng = np.random.default_rng(0)
    proposal = proposals._proven(refit, ("run",), scored, 0.0, lambda _: trial, rng)
    assert (proposal is not None) is said


def test_the_proposals_files_go_back_in(drag, tmp_path):
    """The model with the law, and its file of terms, are what replay takes."""
    run = sorted(drag.parent.glob("run_*.csv"))[-1]
    files = [
        "--crane",
        "crane_150t",
        "--model",
        str(drag / "proposal_1.yaml"),
        "--terms-file",
        str(drag / "proposal_1.py"),
    ]
    assert winch_friction(["replay", str(run), "--out", str(tmp_path / "replayed.csv"), *files]) == 0


@pytest.mark.parametrize(("each", "share"), [(True, 1.0), (False, 0.5)])
def test_a_law_that_acts_once_in_all_is_divided_by_the_motors_that_its_term_is_taken_times(each, share):
    equation = declare(Law((Factor("linear", "pressure"),), opposing=True, each=each), 2.0).term.equation
    assert float(equation.subs(symbols.n, 2) / equation.subs(symbols.n, 1)) == share


@pytest.mark.parametrize(("verdict", "closed", "says"), [
    ("missing_effect", (), True), ("ambiguous", (), True), ("nothing_missing", (), False),
    ("unexplained", (), False), ("unexplained", (0.4, 0.8), False), ("unexplained", (0.4, 0.96), True),
])  # fmt: skip
def test_what_a_name_or_an_equation_says_is_no_fault_of_the_seed(verdict, closed, says):
    assert explained(verdict, [SimpleNamespace(closed=each) for each in closed]) == says


@pytest.mark.parametrize("span", [1.0, 12.0, 55.0, 300.0])
def test_what_comes_once_is_no_period(span):
    """A friction that grew while it ran came "periodically, every 54.3 m", of a wire of which 55 m came and went."""
    periods = {each["c"] for each in vocabulary._constants("wave", vocabulary.WORDS[0], (1.0,), span)}
    assert periods == {each for each in vocabulary.PERIODS if each <= 0.5 * span}


def test_a_signal_is_read_as_its_symbol_says():
    """Speed, acceleration and pressure by their size; the drum turns once in so many turns of the motor."""
    one = np.array([-3.0, 4.0])
    run = SimpleNamespace(speed=one, drum_torque=one, acceleration=one, time=one, angle=250.0 * one, gear_ratio=250.0,
                          channels=dict.fromkeys(("oil_temperature", "wire_out", "wire_layer"), one))  # fmt: skip
    group = SimpleNamespace(displacement=one, pressure=one)
    read = {word.name: (word.of_run(run) if word.of_run else word.of_group(group)).tolist() for word in WORDS}
    by_size = {name for name, values in read.items() if values == [3.0, 4.0]}
    assert by_size == {"motor_speed", "acceleration", "pressure"}
    assert all(values == [-3.0, 4.0] for name, values in read.items() if name not in by_size)


def test_a_count_is_asked_at_whole_numbers_and_a_size_at_tenths_of_the_samples():
    layers = np.repeat([1.0, 2.0, 4.0], 50)
    knots = {c for each in factors(vocabulary.BY_NAME["wire_layer"], layers) for _, c in each.constants}
    assert knots == {1.0, 2.0, 4.0}
    speeds = {c for each in factors(vocabulary.BY_NAME["motor_speed"], np.linspace(0.0, 100.0, 1001))
              if each.kind == "above" for _, c in each.constants}  # fmt: skip
    assert speeds == {10.0 * k for k in range(1, 10)}
