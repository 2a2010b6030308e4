"""A small seeded draw of the import campaign: a log comes back as it was, or is answered with what was done to it."""

import pytest

from campaign.import_logs import BASES, trial
from campaign.import_variants import draw
from campaign.import_words import HELD_OUT
from winch_friction.importing.names import tokens, vocabulary

SEED = 11


@pytest.mark.parametrize("number", range(14))
def test_a_spoilt_log_is_imported_or_answered(tmp_path, number):
    outcome = trial(draw(number, BASES, SEED), tmp_path, SEED)
    assert outcome.kind != "crashed", outcome.said
    assert outcome.kind != "wrong", outcome.variant
    assert outcome.good, f"{outcome.variant}: {outcome.said}"


def test_words_that_are_held_out_are_in_no_list():
    known = vocabulary()
    for names in HELD_OUT.values():
        for name in names:
            words = [t for t in tokens(name.format(g="", p="")) if len(t) > 2]
            assert any(t not in known.words and t not in known.short for t in words), name
