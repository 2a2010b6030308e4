"""What the doctor finds, what lists hold, what is shown of a name, and how words of the command line are taken."""

import json
import subprocess
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest
import typer

from winch_friction.cli import doctor, import_, init, main, names, show
from winch_friction.importing.mapping import Entry, LogMap
from winch_friction.importing.time_base import TimeBase
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import registered_terms
from winch_friction.records.strict_yaml import config_directory

GOOD, NOTE, BAD = "ok", "note", "problem"


def found(check):
    """What a check finds: name -> (state, what was found, whether it says what to do)."""
    return {each.what: (each.state, each.found, bool(each.do)) for each in check()}


# -- the doctor
@pytest.mark.parametrize(
    ("version", "state"), [((3, 10, 9), NOTE), ((3, 11, 0), GOOD), ((3, 12, 4), GOOD), ((3, 13, 0), NOTE)]
)
def test_nodes_need_a_python_that_ros_has_wheels_for(version, state, monkeypatch):
    monkeypatch.setattr(doctor, "sys", SimpleNamespace(version_info=version))
    assert found(doctor._python) == {"Python": (state, ".".join(map(str, version)), state == NOTE)}


@pytest.mark.parametrize(
    ("absent", "nodes", "desk"),
    [((), GOOD, GOOD), (("numpy",), BAD, GOOD), (("pint",), GOOD, NOTE), (("scipy", "arch"), BAD, NOTE)],
)
def test_what_the_nodes_lack_is_a_problem_and_what_a_desk_lacks_a_note(absent, nodes, desk, monkeypatch):
    monkeypatch.setattr(doctor, "_version", lambda name: None if name in absent else "1.0")
    findings = {each.what: each for each in doctor._libraries()}
    assert {what: each.state for what, each in findings.items()} == {"nodes": nodes, "desk": desk}
    for what, install in (("nodes", "pip install 'winch_friction'"), ("desk", "pip install 'winch_friction[desk]'")):
        each = findings[what]
        assert each.do == ("" if each.state == GOOD else install)
        assert each.found == ("all there" if each.state == GOOD else f"missing: {absent[-1 if what == 'desk' else 0]}")


def test_a_library_that_is_not_there_has_no_version():
    assert doctor._version("no-such-library-of-anybody") is None
    assert doctor._version("numpy") == np.__version__


def test_a_file_that_cannot_be_read_is_a_problem_of_its_kind(monkeypatch):
    def broken():
        raise InputError("crane.yaml: gear_ratio: must be above 0")

    whole = {"models": SimpleNamespace(rows=lambda: [1, 2, 3]), "cranes": SimpleNamespace(rows=broken)}
    monkeypatch.setattr(names, "KINDS", whole)
    assert found(doctor._configuration) == {
        "models": (GOOD, "3 can be read", False), "cranes": (BAD, "crane.yaml: gear_ratio: must be above 0", True),
    }  # fmt: skip


@pytest.mark.parametrize("error", [None, ImportError("no numba"), OSError("read-only"), RuntimeError("nowhere")])
def test_code_that_cannot_be_kept_is_a_note(error, monkeypatch):
    def warmed():
        yield "the plant", 1.25
        if error:
            raise error

    monkeypatch.setattr("winch_friction.cli.warming.warmed", warmed)
    kept = {"the plant": (GOOD, "ready after 1.2 s; it is kept for the next start", False)}
    lost = {"cache": (NOTE, f"works without, slower: {error}", True)} if error else {}
    assert found(doctor._compiled_code) == kept | lost


@pytest.mark.parametrize(("writable", "free", "shared"), [(True, 64e6, GOOD), (True, 15e6, BAD), (False, 64e6, BAD)])
def test_folders_are_written_to_and_shared_memory_has_room(writable, free, shared, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path / "made by the first node"))
    asked = []
    monkeypatch.setattr(doctor.os, "access", lambda path, mode: asked.append((Path(path), mode)) or writable)
    monkeypatch.setattr(doctor.shutil, "disk_usage", lambda path: SimpleNamespace(free=free, total=1e12, used=0))
    state = GOOD if writable else BAD
    findings = found(doctor._permissions)
    if Path("/dev/shm").is_dir():
        assert findings.pop("shared memory") == (shared, f"{free / 1e6:.0f} MB free in /dev/shm", shared == BAD)
    can = "can" if writable else "cannot"
    assert findings == {
        "this folder": (state, f"{tmp_path} {can} be written", not writable),
        "ROS logs": (state, f"{tmp_path / 'made by the first node'} {can} be written", not writable),
    }
    assert asked[:2] == [(tmp_path, doctor.os.W_OK), (tmp_path, doctor.os.W_OK)]  # of one that is not there: its parent


@pytest.mark.parametrize(
    ("now", "late", "said", "states"),
    [
        (1.75e9, 0.001, "yes\n", (GOOD, GOOD, GOOD)), (1.70e9, 0.001, "no\n", (BAD, GOOD, NOTE)),
        (1.75e9, 0.006, "", (GOOD, NOTE, None)),
    ],
)  # fmt: skip
def test_a_clock_is_dated_on_time_and_synchronised(now, late, said, states, monkeypatch):
    ticks = iter([50.0, 50.01 + late])
    clock = SimpleNamespace(time=lambda: now, perf_counter=lambda: next(ticks), sleep=lambda seconds: None,
                            strftime=doctor.time.strftime, gmtime=doctor.time.gmtime)  # fmt: skip
    monkeypatch.setattr(doctor, "time", clock)
    monkeypatch.setattr(doctor.shutil, "which", lambda name: f"/usr/bin/{name}")
    monkeypatch.setattr(doctor.subprocess, "run", lambda *_, **__: SimpleNamespace(stdout=said))
    findings = found(doctor._clock)
    assert tuple(findings[name][0] if name in findings else None for name in
                 ("date", "sleep of 10 ms", "synchronised")) == states  # fmt: skip
    assert findings["date"][1] == {1.75e9: "2025-06-15 15:06 UTC", 1.70e9: "2023-11-14 22:13 UTC"}[now]
    assert findings["sleep of 10 ms"][1] == f"{1e3 * late:.2f} ms late"
    for state, _, do in findings.values():
        assert do == (state != GOOD)


@pytest.mark.parametrize(
    ("domain", "scope", "states"),
    [("0", "LOCALHOST", (GOOD, GOOD)), ("101", "SUBNET", (GOOD, NOTE)), ("102", "LOCALHOST", (BAD, GOOD)),
     ("-1", "LOCALHOST", (BAD, GOOD)), (None, None, (GOOD, NOTE))],
)  # fmt: skip
def test_a_domain_and_a_range_of_discovery_are_judged(domain, scope, states, monkeypatch):
    monkeypatch.setitem(sys.modules, "rclpy", ModuleType("rclpy"))
    for name, value in (("ROS_DOMAIN_ID", domain), ("ROS_AUTOMATIC_DISCOVERY_RANGE", scope)):
        monkeypatch.delenv(name, raising=False)
        if value is not None:
            monkeypatch.setenv(name, value)
    findings = found(doctor._ros)
    assert findings["ROS_DOMAIN_ID"] == (states[0], domain or "0", states[0] == BAD)
    assert findings["discovery range"] == (states[1], scope or "SUBNET (default)", states[1] == NOTE)
    assert findings["rclpy"][0] == findings["middleware"][0] == GOOD


def test_without_ros_there_is_a_note_and_nothing_more(monkeypatch):
    monkeypatch.setitem(sys.modules, "rclpy", None)
    ((what, (state, said, do)),) = found(doctor._ros).items()
    assert (what, state, do) == ("rclpy", NOTE, True)
    assert said.startswith("ModuleNotFoundError: ")


@pytest.mark.parametrize(
    ("status", "said", "expected"),
    [(0, "warm 0.0123\n", (GOOD, "after 12.3 ms", False)), (1, "warm 0.0123", (BAD, "nothing", True)),
     (0, "", (BAD, "nothing", True)), (0, "soon", (BAD, "nothing", True)), (None, "", (BAD, "nothing", True))],
)  # fmt: skip
def test_a_node_that_hears_itself_says_after_how_long(status, said, expected, monkeypatch):
    def answer(command, timeout, **_):
        assert command[1:] == ["-m", "winch_friction.nodes.doctor"]
        if status is None:
            raise subprocess.TimeoutExpired(command, timeout)
        return SimpleNamespace(returncode=status, stdout=said)

    monkeypatch.setattr(doctor.importlib.util, "find_spec", lambda name: object())
    monkeypatch.setattr(doctor.subprocess, "run", answer)
    assert found(doctor._talk) == {"a node hears itself": expected}
    monkeypatch.setattr(doctor.importlib.util, "find_spec", lambda name: None)
    assert found(doctor._talk) == {}


@pytest.mark.parametrize(
    ("states", "said", "status"),
    [((GOOD, NOTE), "nothing is wrong", 0), ((BAD, NOTE), "1 problem, see above", 2),
     ((BAD, GOOD, BAD), "2 problems, see above", 2)],
)  # fmt: skip
def test_the_doctors_status_is_that_of_its_problems(states, said, status, monkeypatch, capsys):
    findings = [doctor.Finding("area", f"part {k}", state, "as found", "do this") for k, state in enumerate(states)]
    monkeypatch.setattr(doctor, "_checks", lambda dds: [lambda: iter(findings[:1]), lambda: iter(findings[1:])])
    assert main.run(["doctor", "--plain"]) == status
    lines = capsys.readouterr().out.splitlines()
    assert lines[1].split("\t") == ["area", "what", "state", "found", "what to do"]
    assert lines[2].split("\t") == ["area", "part 0", states[0], "as found", "do this"]
    assert lines[-1] == said
    assert main.run(["doctor", "--json"]) == status
    assert [each["state"] for each in json.loads(capsys.readouterr().out)] == list(states)


def test_nothing_is_started_without_dds():
    assert doctor._talk in doctor._checks(True)
    assert doctor._talk not in doctor._checks(False)
    assert len(doctor._checks(True)) == 8


# -- lists
def test_a_list_tells_models_and_cranes_by_what_their_files_say():
    models = {row["name"]: row for row in names.KINDS["models"].rows()}
    own = models["a6vm215_crane2"]
    assert own["terms"].startswith("motor_viscous, motor_turbulence, ")
    assert (own["parameters"], own["covariance"], own["crane"]) == (10, "yes", "crane_150t")
    cranes = {row["name"]: row for row in names.KINDS["cranes"].rows()}
    assert cranes["crane_150t"] == {
        "name": "crane_150t", "drive": "hydraulic", "gear ratio [-]": 250.0, "motors": "main 11, active 3, passive 8",
        "rope radius [m]": "0.8 ... 1.136", "inertia [kg*m^2]": 1.54,
    }  # fmt: skip
    of_crane = names.models_of("crane_150t")
    assert "a6vm215_crane2" in of_crane
    assert {name for name, row in models.items() if row["crane"] == "crane_150t"} == set(of_crane) < set(models)


def test_a_list_tells_terms_units_and_scenarios_by_their_own():
    terms = {row["name"]: row for row in names.KINDS["terms"].rows()}
    assert list(terms) == sorted(terms) == list(names.KINDS["terms"].names())
    declared = registered_terms()["stribeck"]
    first = declared.parameters[0]
    assert terms["stribeck"]["parameters"].startswith(f"{first.name} [{first.unit}]")
    assert (terms["stribeck"]["place"], terms["stribeck"]["source"]) == (declared.place, declared.source)
    units = {row["name"]: row for row in names.KINDS["units"].rows()}
    assert (units["<group>.pressure_a"]["SI"], units["<group>.pressure_a"]["read as"]) == ("Pa", "bar")
    for row in units.values():
        assert not {row["SI"], row["read as"]} & set(row["also accepted"].split(", "))
    assert units["motor_torque"]["also accepted"] == "kN*m"
    scenarios = {row["name"]: row for row in names.KINDS["scenarios"].rows()}
    assert scenarios["test_05"]["duration [s]"] == 175.0
    assert scenarios["test_05"]["about"].startswith("Paper 2 Table 2, test 5: constant speeds")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("# one\n# two\nx: 1\n", "one"),
        ("# one:\n# two\n# three\n", "one: two"),
        ("x: 1\n# one\n", ""),
        ("#one\n", "one"),
    ],
)
def test_a_file_is_told_by_its_first_comment(text, said, tmp_path):
    (tmp_path / "a.yaml").write_text(text)
    assert names._comment(tmp_path / "a.yaml") == said


@pytest.mark.parametrize(
    ("name", "kind"),
    [("a6vm215_crane2", "model"), ("crane_150t", "crane"), ("test_05", "scenario"), ("stribeck", "term"),
     ("slip_leakage", "effect"), ("bar", None)],
)  # fmt: skip
def test_a_name_is_known_by_its_kind(name, kind):
    assert names.kind_of(name) == kind
    if kind:
        assert name in names.names_of(kind)


def test_completion_offers_what_begins_so():
    assert names.complete_crane("crane_150") == ["crane_150t"]
    assert names.complete_scenario("test_0") == [f"test_0{k}" for k in range(1, 10)]
    assert names.complete_term("stribeck_g") == ["stribeck_gauss"]
    assert "motor_coulomb" not in names.complete_term("coulomb")


# -- one name shown
def test_a_model_is_shown_with_its_largest_terms_and_its_parameters_for_people(monkeypatch, capsys):
    rows = {}
    monkeypatch.setattr(show, "show_table", lambda title, columns, body: rows.update({"title": title, "body": body}))
    parameter = [
        SimpleNamespace(name=name, unit=unit, doc=f"of {name}") for name, unit in (("p", "Pa"), ("w", "rad/s"))
    ]
    model = SimpleNamespace(name="ours", parameters=parameter, values=(3e5, np.pi), std=np.array([2e4, np.pi / 10]),
                            covariance=np.eye(2), term_names=("a", "b"), corrections=())  # fmt: skip
    parts = {
        "a": np.array([1.0, 2.0]),
        "b": np.array([-9.0, 1.0]),
        "c": np.array([3.0, 0.0]),
        "d": np.array([4.0, 4.0]),
    }
    curve = SimpleNamespace(parts=parts, torque=np.array([5.0, 7.0]), load=55e3)
    show._draw_model(model, SimpleNamespace(name="crane_x"), curve, [0.0, 100.0])
    shown = capsys.readouterr().out
    assert shown.startswith("ours on crane_x, 55 t: friction torque at the motor shaft [N*m]")
    assert "* total   o b   + d   x c" in shown
    assert rows["body"] == [["p", "3", "0.2", "bar", "of p"], ["w", "30", "3", "rpm", "of w"]]
    model.covariance = None
    show._draw_model(model, SimpleNamespace(name="crane_x"), curve, [0.0, 100.0])
    assert [row[2] for row in rows["body"]] == ["-", "-"]


def test_a_model_as_json_has_each_parameter_by_name(capsys):
    assert main.run(["show", "a6vm215_crane2", "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    from winch_friction.records.model_file import load_model

    model = load_model("a6vm215_crane2")
    assert (content["name"], content["crane"], content["load_t"]) == ("a6vm215_crane2", "crane_150t", 55.0)
    for p, value, std in zip(model.parameters, model.values, model.std, strict=True):
        assert content["parameters"][p.name] == {
            "value": pytest.approx(value), "std": pytest.approx(std), "unit": p.unit, "meaning": p.doc,
        }  # fmt: skip
    curve = content["curve"]
    assert set(curve["terms_Nm"]) == set(model.term_names)
    assert 1000.0 < max(curve["speed_rpm"]) < 5000.0
    assert min(curve["std_Nm"]) > 0.0
    assert curve["std_Nm"] != curve["torque_Nm"]


def test_a_term_as_json_has_its_bounds(capsys):
    show.show_physics("stribeck", None, True)
    content = json.loads(capsys.readouterr().out)
    term = registered_terms()["stribeck"]
    assert content["latex"] == term.latex
    assert [(p["name"], p["unit"], p["typical"], p["lower"], p["meaning"]) for p in content["parameters"]] == [
        (p.name, p.unit, p.typical, p.lower, p.doc) for p in term.parameters
    ]
    show.show_physics("tare_load", None, True)
    content = json.loads(capsys.readouterr().out)
    assert (content["latex"], content["parameters"]) == (None, [])
    assert content["next"].startswith("Hang the empty hook")


@pytest.mark.parametrize(
    ("value", "said"),
    [({"value": 77, "unit": "t"}, "77 t"), ({"value": 2.50, "unit": "bar"}, "2.5 bar"), ([0.8, 0.9], "0.8, 0.9"),
     ({"a": {"value": 1, "unit": "m"}, "b": 2}, "a: 1 m, b: 2"), ("x", "x"), (True, "True")],
)  # fmt: skip
def test_what_stands_in_a_file_is_told_plainly(value, said):
    assert show._plain(value) == said


@pytest.mark.parametrize(("load", "beyond"), [(599.0, False), (601.0, True)])
def test_a_load_beyond_what_a_crane_holds_is_told(load, beyond, crane_150t, monkeypatch, capsys):
    monkeypatch.setattr("winch_friction.importing.expectations.most_held", lambda crane: 600e3)
    show.say_beyond("--load", [10.0, load], crane_150t)
    said = " ".join(capsys.readouterr().err.split())
    assert (
        "--load 601: beyond what crane 'crane_150t' holds by its file (0 to 600 t: all motors at 450 bar" in said
    ) == (beyond)
    assert bool(said) == beyond


def test_a_model_is_drawn_on_the_crane_that_is_given_else_on_its_own(capsys):
    hydraulic, torque = SimpleNamespace(reads=("speed", "pressure")), SimpleNamespace(reads=("speed",))
    own = SimpleNamespace(name="ours", crane="crane_150t", terms=(hydraulic,))
    assert show.curve_crane(own, "").name == "crane_150t"
    assert capsys.readouterr().err == ""
    for name, term, taken in (("x", hydraulic, "crane_150t"), ("x", torque, "crane_150t"), ("emps_x", torque, "emps"),
                              ("emps_x", hydraulic, "crane_150t")):  # fmt: skip
        model = SimpleNamespace(name=name, crane="", terms=(term,))
        assert show.curve_crane(model, "").name == taken
        assert f"drawn on '{taken}'" in " ".join(capsys.readouterr().err.split())


def test_a_crane_is_shown_with_the_radii_of_its_layers(capsys):
    assert main.run(["show", "crane_150t", "--plain"]) == 0
    rows = dict(line.split("\t") for line in capsys.readouterr().out.splitlines()[1:])
    assert rows["drum"] == "layer_radii: 0.8, 0.867, 0.934, 1.002, 1.069, 1.136 m"
    assert main.run(["show", "test_05", "--plain"]) == 0
    rows = dict(line.split("\t") for line in capsys.readouterr().out.splitlines()[1:])
    assert (rows["load"], rows["mode"], rows["duration"]) == ("77 t", "normal", "175")


# -- words and errors
@pytest.fixture
def modes():
    before = main.Modes.quiet, main.Modes.plain
    yield main.Modes
    main.Modes.quiet, main.Modes.plain = before


@pytest.mark.parametrize(
    ("words", "left", "quiet", "plain"),
    [("-q list", "list", True, False), ("list --plain", "list", False, True),
     ("a --quiet b --plain", "a b", True, True), ("a -- --plain -q", "a -- --plain -q", False, False),
     ("--plain a -- -q", "a -- -q", False, True)],
)  # fmt: skip
def test_modes_are_taken_wherever_they_stand_before_the_end_of_options(words, left, quiet, plain, modes):
    assert main.without_modes(words.split()) == left.split()
    assert (modes.quiet, modes.plain) == (quiet, plain)


def test_every_problem_is_a_line_and_a_library_of_our_own_that_lacks_is_a_defect(capsys):
    assert main._bad_input("one\n two", "three") == 2
    assert capsys.readouterr().err.splitlines() == ["winch-friction: one two", "winch-friction: three"]
    assert main._missing_library(ModuleNotFoundError("no dask", name="dask.bag")) == 2
    assert "the library 'dask.bag' is not installed: pip install 'winch_friction[desk]'" in capsys.readouterr().err
    assert main._missing_library(ModuleNotFoundError("gone", name="winch_friction.physics")) == 1
    assert "defect: ModuleNotFoundError: gone" in capsys.readouterr().err
    context = SimpleNamespace(command_path="winch-friction show")
    assert main._usage_hint(SimpleNamespace(ctx=context)) == " (see 'winch-friction show --help')"
    assert main._usage_hint(ValueError()) == main._usage_hint(SimpleNamespace(ctx=None)) == ""


# -- import and init
@pytest.mark.parametrize(
    ("name", "stem"),
    [("log.csv", "log"), ("log.csv.gz", "log"), ("a.b.xlsx", "a.b"), ("log.txt.zip", "log"), ("bag", "bag"),
     ("log.zip", "log")],
)  # fmt: skip
def test_a_run_is_called_as_its_log(name, stem):
    assert import_._stem(Path("logs") / name) == stem


def test_two_logs_of_one_name_are_refused():
    import_._refuse_doubled([Path("a/x.csv"), Path("b/y.csv")])
    with pytest.raises(InputError, match=r"^x: two logs have this name"):
        import_._refuse_doubled([Path("a/x.csv"), Path("b/y.csv"), Path("b/x.csv.gz")])


def test_a_proposed_map_is_told_a_line_per_channel(capsys):
    entries = {
        "motor_speed": Entry("n", "rpm", sign=-1, confidence=0.91, because="its name"), "wire_layer": Entry("L"),
        "hook_load": Entry("", constant="3 t"),
    }  # fmt: skip
    import_._show(LogMap(entries, ("d", "t"), TimeBase("unix", unit="ms"), time_confidence=0.5, time_because="rises"))
    assert capsys.readouterr().out.splitlines() == [
        "time <- d + t (unix ms), 0.50: rises", "motor_speed <- n (-1 * rpm), 0.91: its name",
        "wire_layer <- L (-), 1.00: ", "hook_load <- 3 t, a constant",
    ]  # fmt: skip
    import_._show(LogMap({}, ("d",), TimeBase("datetime"), time_because="dates"))
    assert capsys.readouterr().out == "time <- d (datetime), 1.00: dates\n"
    import_._show(LogMap({}))
    assert capsys.readouterr().out == "time <- no column found\n"
    own = import_._as_content(LogMap(entries, crane="ours"), ["p"], ("n",), Path("m.yaml"))
    assert (own["map"], own["problems"], own["notes"]) == ("m.yaml", ["p"], ("n",))
    assert own["proposal"]["columns"]["motor_speed"]["sign"] == -1


def test_a_run_never_replaces_its_log(tmp_path):
    log, other = tmp_path / "a.csv", tmp_path / "b.csv"
    log.write_text("")
    other.write_text("")
    (tmp_path / "x").mkdir()
    with pytest.raises(InputError, match="is the log itself"):
        import_._refuse_existing([log], [tmp_path / "x" / ".." / "a.csv"], True)
    with pytest.raises(InputError, match="b.csv: exists; give another --out"):
        import_._refuse_existing([log], [other], False)
    import_._refuse_existing([log], [other], True)
    import_._refuse_existing([log], [tmp_path / "c.csv"], False)


def test_what_is_asked_at_a_terminal_is_only_what_was_not_given(monkeypatch):
    asked = {"load": (None, float, "rated load, t"), "motors": (5, int, "motors"), "gear_ratio": (None, float, "ratio")}
    monkeypatch.setattr(init.sys, "stdin", SimpleNamespace(isatty=lambda: True))
    monkeypatch.setattr(typer, "prompt", lambda words, type: (words, type))
    assert init._answered(asked) == {"load": ("rated load, t", float), "motors": 5, "gear_ratio": ("ratio", float)}
    monkeypatch.setattr(init.sys, "stdin", SimpleNamespace(isatty=lambda: False))
    with pytest.raises(InputError, match=r"^init crane needs --load \(rated load, t\), --gear-ratio \(ratio\)$"):
        init._answered(asked)
    assert init._answered({"motors": asked["motors"]}) == {"motors": 5}


def test_of_several_files_all_are_written_or_none(tmp_path, capsys):
    first, second = tmp_path / "a.yaml", tmp_path / "b.yaml"
    second.write_text("kept")
    with pytest.raises(InputError, match=r"b.yaml: exists already"):
        init._write_all({first: "1", second: "2"}, False, False)
    assert (first.exists(), second.read_text()) == (False, "kept")
    init._write_all({first: "1", second: "2"}, True, False)
    assert (first.read_text(), second.read_text()) == ("1", "2")
    assert capsys.readouterr().out.splitlines() == [f"written: {first}", f"written: {second}"]
    init._write_all({first: "3"}, True, True)
    assert json.loads(capsys.readouterr().out) == {"written": [str(first)]}


def test_names_of_files_are_what_init_calls_them(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    crane = str(config_directory() / "cranes" / "crane_150t.yaml")
    called = {"plant": "plant_crane_150t", "model": "seed_crane_150t", "scenario": "ahc_crane_150t",
              "scenario --mode normal": "normal_crane_150t"}  # fmt: skip
    for words, name in called.items():
        assert main.run(["init", *words.split(), "--crane", crane, "--json"]) == 0
        assert f"name: {name}\n" in (tmp_path / f"{name}.yaml").read_text()
    assert "plant: plant_crane_150t.yaml" in (tmp_path / "ahc_crane_150t.yaml").read_text()
    assert main.run(["init", "scenario", "--crane", crane, "--mode", "both"]) == 2
    assert main.run(["init", "scenario", "--crane", crane, "--plant", "ours", "--load", "20", "--name", "x"]) == 0
    text = (tmp_path / "x.yaml").read_text()
    assert "plant: ours" in text
    assert "value: 20" in text
