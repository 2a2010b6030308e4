"""What the page of `gap` says in sentences: each is to be understood without the others, and says what to do."""

import re
from types import SimpleNamespace

import numpy as np
import pytest
from own_term_files import TERM, forgotten, own_terms

from winch_friction.physics.friction import term_named
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.term import load_file
from winch_friction.report import gap as page
from winch_friction.report.gap_words import (
    amount_in_units,
    how_sure,
    next_steps,
    shape_in_words,
    top_speed_change,
    verdict_sentence,
)

LAW = SimpleNamespace(sentence="friction in proportion to wire out, 0.12 N*m/m; closes 98 % of the gap")


def result(verdict, **more):
    base = {"effects": [], "depends_on": ("wire_out",), "refused": "why", "proposals": (),
            "next_experiment": None, "adequacy": (), "levels": "",
            "model": SimpleNamespace(corrections=(), terms=())}  # fmt: skip
    return SimpleNamespace(verdict=verdict, **(base | more))


def effect(name, *rivals):
    return SimpleNamespace(name=name, rivals=rivals, law_name=name)


def test_several_effects_stand_apart_each_with_its_title():
    found = result("ambiguous", effects=[effect("coulomb", "dwell_stiction"), effect("inertia_error")])
    assert verdict_sentence(found) == (
        "Missing: coulomb (constant friction); inertia_error (inertia differs from the crane file's). These runs "
        "cannot tell apart: coulomb or dwell_stiction."
    )


@pytest.mark.parametrize(("count", "others"), [(1, ""), (2, " (1 other law does about as well)")])
def test_a_proposed_law_is_part_of_the_decision_and_of_what_to_do(count, others):
    found = result("unexplained", proposals=(LAW,) * count)
    assert verdict_sentence(found).endswith(f"(why). A law is proposed{others}: {LAW.sentence}.")
    said = " ".join(next_steps(found))
    assert "--model proposal_1.yaml --terms-file proposal_1.py" in said
    assert "declare a term" not in said


@pytest.mark.parametrize(
    ("depends_on", "signals"), [(("wire_out", "motor_speed"), "wire_out, motor_speed"), ((), "no recorded signal")]
)
def test_what_is_left_depends_on_the_signals_of_the_answer(depends_on, signals):
    said = verdict_sentence(result("unexplained", depends_on=depends_on))
    assert f"it depends on {signals} (why)." in said


@pytest.mark.parametrize(("levels", "steps"), [
    ("", ["Nothing needs to be done: keep the model."]), ("the cell is off", ["Keep the model.", "the cell is off."]),
])  # fmt: skip
def test_where_nothing_is_missing_the_model_is_kept_and_a_load_cell_mended(levels, steps):
    assert next_steps(result("nothing_missing", levels=levels)) == steps


def test_without_a_law_the_user_looks_and_declares_one():
    found = result("unexplained")
    assert verdict_sentence(found) == (
        "Something is missing that no named effect explains; it depends on wire_out (why)."
    )
    (said,) = next_steps(found)
    assert "declare a term of your own" in said


@pytest.mark.parametrize(
    ("what", "sentence", "step"),
    [
        ("runs that tell more effects apart (a or b)", None, "Bring runs that tell more effects apart (a or b)."),
        ("moving time", "moving time: 3 s, needed 15 s", "Bring runs with more of it: moving time: 3 s, needed 15 s."),
    ],
)
def test_what_is_lacking_is_asked_for_in_words(what, sentence, step):
    check = SimpleNamespace(what=what, sentence=sentence or what, met=False)
    assert next_steps(result("insufficient", adequacy=(check,))) == [step]


@pytest.mark.parametrize(("name", "mended"), [("pressure_clock", True), ("signal_delay", True), ("tare_load", False)])
def test_what_a_running_node_refuses_is_not_to_be_loaded(name, mended):
    """The page said of a drifting clock that the compensator takes over without a bump; the compensator refuses it."""
    model = SimpleNamespace(corrections=(Correction(name, 1e-3),), terms=())
    *_, said = next_steps(result("missing_effect", effects=[effect("signal_delay")], model=model))
    assert (f"Mend {name} at the source" in said) is mended
    assert ("winch-friction load model.yaml" in said) is not mended


def test_shapes_are_said_in_the_units_that_people_read():
    assert shape_in_words("T_vh = 50, C4_h = 12.5664") == "T_vh = 50 °C, C4_h = 120 rpm"
    assert shape_in_words("T_gs = 2.1e+05 and n_gp = 0.5") == "T_gs = 210000 N·m and n_gp = 0.5"
    assert shape_in_words("t_wd = 1.76412e+09, tau_wb = 69.5") == "t_wd = 2025-11-26, tau_wb = 69.5 s"
    for plain in ("", "tau = 240 s", "all groups, both ports", "speed late, about 40 ms"):
        assert shape_in_words(plain) == plain


def test_a_shape_that_was_tried_and_not_fitted_has_no_deviation():
    """Gears that lose more in one direction had "b_g = 0 ± 5e-11" in the terminal and on the page."""
    value, std, unit = amount_in_units("b_g", -6.9e-20, 5e-11, "1")
    assert (value, np.isnan(std), unit) == (0.0, True, "–")
    assert amount_in_units("b_g", 0.5, 0.1, "1") == (0.5, 0.1, "–")
    assert amount_in_units("e_g", 0.01, 1e-12, "1") == (0.01, 1e-12, "–")  # an amount is fitted, however surely


def test_a_model_with_terms_of_ones_own_is_loaded_with_their_file(tmp_path):
    """The command on the page was refused: the term was not known."""
    with forgotten(TERM):
        (own,) = load_file(own_terms(tmp_path))
        model = SimpleNamespace(corrections=(), terms=(term_named("coulomb"), own))
        *_, said = next_steps(result("missing_effect", effects=[effect("coulomb")], model=model))
    assert "`winch-friction replay BAG --model model.yaml --terms-file own_drag.py`" in said
    assert "`winch-friction load model.yaml --terms-file own_drag.py`" in said


def test_names_that_no_scenario_tells_apart_are_said_to_be_so():
    """The terminal said it, the page did not."""
    first, *_ = next_steps(result("ambiguous", effects=[effect("gear_asymmetry", "layer_radius")]))
    assert first == "No scenario at hand tells these names apart: measure what only one of them changes."


def test_the_weakest_effect_says_how_sure_all_are():
    effects = [SimpleNamespace(p_value=p, selection_frequency=f) for p, f in ((1e-5, 0.99), (0.03, 0.61), (1e-4, 0.9))]
    assert how_sure(SimpleNamespace(effects=effects)) == "chance finding p = 0.03; named first in 61 % of redrawn data"


def side(name, speed, change, before=(2.0, (1.5, 2.5)), after=(0.5, (0.25, 0.75))):
    """Runs of one side, blocks at these speeds in rad/s of which the repair takes `change` bar off."""
    blocks = SimpleNamespace(run=np.zeros(len(speed), int), features={"motor_speed": speed}, y=speed)
    sizes = {key: SimpleNamespace(value=value, interval=interval)
             for key, (value, interval) in (("size_before", before), ("size_after", after))}  # fmt: skip
    return SimpleNamespace(runs=[SimpleNamespace(name=name, unit_torque=10.0)], blocks=blocks, before=change,
                           after=0.0 * change, noise_floor=0.2, **sizes)  # fmt: skip


def test_the_change_at_top_speed_is_that_of_the_fastest_blocks():
    speed = np.linspace(1.0, 100.0, 100)
    found = SimpleNamespace(unit="bar", train=side("a", speed, np.where(speed > 85.0, 4.0, 1.0)),
                            holdout=side("b", speed, np.where(speed > 85.0, -4.0, 1.0)))  # fmt: skip
    assert top_speed_change(found).startswith("40 N·m = 4 bar above 86")


def test_the_proof_names_the_locked_runs_and_says_what_each_file_leaves(monkeypatch):
    speed = np.ones(3)
    found = SimpleNamespace(
        unit="bar", train=side("learned.csv", speed, speed), holdout=side("locked.csv", speed, speed)
    )
    for name in ("speed_plot", "plot_html", "_runs"):
        monkeypatch.setattr(page, name, lambda *_: "")
    said = page._proof(found)
    assert "Locked before anything else was looked at: locked.csv." in said
    assert re.findall(r">([^<>]+)</t[dh]>", said)[-9:] == [
        "model as given", "2", "1.5 … 2.5",
        "model.yaml, read back", "0.5", "0.25 … 0.75",
        "independent noise", "0.2", "–",
    ]  # fmt: skip
