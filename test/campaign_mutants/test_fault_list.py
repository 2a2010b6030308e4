"""The list of faults must fit the code it is about: a fault that no longer applies would silently test nothing."""

import ast

import pytest

from campaign.mutants.fault import ROOT, Fault, all_faults

FAULTS = all_faults()
FEWEST = 60


def test_there_are_enough_faults():
    assert len(FAULTS) >= FEWEST


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_every_fault_applies(fault):
    changed = fault.changed((ROOT / fault.file).read_text())
    ast.parse(changed)
    assert fault.tests
    assert all((ROOT / test.split("::")[0]).exists() for test in fault.tests)


def test_a_text_that_stands_twice_is_refused():
    with pytest.raises(ValueError, match="stands 2 times"):
        Fault("twice", "any.py", "a", "b", ()).changed("a a")
