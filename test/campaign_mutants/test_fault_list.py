"""The list of faults must fit the code it is about: a fault that no longer applies would silently test nothing."""

import ast
import re

import pytest

from campaign.mutants.__main__ import Outcome, noticed_before, page, stands
from campaign.mutants.fault import LIST, ROOT, Fault, all_faults

FEWEST = 60
# by their lines: every worker looks at the tests, and one of them reads the list
FILES = sorted({f"winch_friction/{file}" for file in re.findall(r"^  file: (\S+)$", LIST.read_text(), re.MULTILINE)})


@pytest.fixture(scope="module")
def faults():
    return all_faults()


def test_there_are_enough_faults(faults):
    assert len(faults) >= FEWEST
    assert {fault.file for fault in faults} == set(FILES)


def statements(source):
    """The first and the last line, from 1, of each statement of a file."""
    own = [(each, getattr(each, "decorator_list", [])) for each in ast.parse(source).body]
    return [(min(part.lineno for part in (each, *before)), each.end_lineno) for each, before in own]


def changed_part(source, spans, fault):
    """The statements of a file that a fault changes, as it leaves them: all others parse as before."""
    fault.changed(source)
    first = source.count("\n", 0, source.index(fault.old)) + 1
    last = first + fault.old.count("\n")
    touched = [(first, last), *(span for span in spans if span[0] <= last and span[1] >= first)]
    begin, end = min(span[0] for span in touched), max(span[1] for span in touched)
    return "".join(source.splitlines(keepends=True)[begin - 1 : end]).replace(fault.old, fault.new)


@pytest.mark.parametrize("file", FILES)
def test_every_fault_applies(file, faults):
    source, wrong = (ROOT / file).read_text(), []
    spans = statements(source)
    for fault in (each for each in faults if each.file == file):
        try:
            ast.parse(changed_part(source, spans, fault))
        except (ValueError, SyntaxError) as error:
            wrong.append(f"{fault.name}: {error}")
        if not fault.tests or not all((ROOT / test.split("::")[0]).exists() for test in fault.tests):
            wrong.append(f"{fault.name}: its tests are not there")
    assert not wrong


def test_no_two_faults_have_one_name(faults):
    assert len({fault.name for fault in faults}) == len(faults)


@pytest.mark.parametrize(("new", "parses"), [("return 2", True), ("return (", False)])
def test_a_fault_that_does_not_parse_is_told_by_the_statements_that_it_changes(new, parses):
    source = "A = 1\n\n\n@cache\ndef first():\n    return 1\n\n\ndef other():\n    return 3\n"
    part = changed_part(source, statements(source), Fault("any", "any.py", "return 1", new, ()))
    assert part == f"@cache\ndef first():\n    {new}\n"
    if parses:
        ast.parse(part)
    else:
        with pytest.raises(SyntaxError):
            ast.parse(part)


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
