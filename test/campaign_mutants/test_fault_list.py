"""The list of faults must fit the code it is about: a fault that no longer applies would silently test nothing."""

import ast

import pytest

from campaign.mutants.__main__ import Outcome, noticed_before, page, stands
from campaign.mutants.fault import ROOT, Fault, all_faults

FAULTS = all_faults()
FEWEST = 60


def test_there_are_enough_faults():
    assert len(FAULTS) >= FEWEST


@pytest.mark.parametrize("file", sorted({fault.file for fault in FAULTS}))
def test_every_fault_applies(file):
    source, wrong = (ROOT / file).read_text(), []
    for fault in (each for each in FAULTS if each.file == file):
        try:
            ast.parse(fault.changed(source))
        except (ValueError, SyntaxError) as error:
            wrong.append(f"{fault.name}: {error}")
        if not fault.tests or not all((ROOT / test.split("::")[0]).exists() for test in fault.tests):
            wrong.append(f"{fault.name}: its tests are not there")
    assert not wrong


def test_no_two_faults_have_one_name():
    assert len({fault.name for fault in FAULTS}) == len(FAULTS)


def test_a_text_that_stands_twice_is_refused():
    with pytest.raises(ValueError, match="stands 2 times"):
        Fault("twice", "any.py", "a", "b", ()).changed("a a")


def test_what_noticed_a_fault_is_read_from_the_page(tmp_path):
    fault = [Fault(name, "winch_friction/any.py", "a", "b", ("test/any.py",)) for name in ("first", "second", "third")]
    by = "FAILED test/campaign_mutants/test_fault_list.py::test_there_are_enough_faults[1 of 2]"
    outcomes = [Outcome(fault[0], True, by, 1.0), Outcome(fault[1], False, "", 1.0)]
    file = tmp_path / "page.md"
    assert noticed_before(file) == {}
    file.write_text(page([*outcomes, Outcome(fault[2], True, "no answer in time", 1.0)], "1234567"))
    noticed = {"first": "test/campaign_mutants/test_fault_list.py::test_there_are_enough_faults"}
    assert noticed_before(file) == noticed
    assert stands(ROOT, noticed["first"])
    # those that are not drawn the next time keep theirs
    file.write_text(page(outcomes[1:], "7654321", 3, {"fourth": noticed["first"], "second": noticed["first"]}))
    assert noticed_before(file) == {"fourth": noticed["first"]}
    assert "0 of 1 (0 %; bar 85 %), drawn of 3 that are listed" in file.read_text()


@pytest.mark.parametrize("test", ["", "test/conftest.py", "test/conftest.py::test_gone", "test/gone.py::test_gone"])
def test_a_test_that_is_gone_notices_nothing(test):
    assert not stands(ROOT, test)
