"""Report sections of the practice: verification as paper 2 section 4."""

from typing import Any

from winch_friction.identification.practice import Practice
from winch_friction.identification.verification import STANDSTILL, PressureCheck
from winch_friction.physics.channels import BAR, RPM
from winch_friction.report.base import TextSection
from winch_friction.report.practice_look import SPEED, Curve, curves_html, name
from winch_friction.report.tables import paragraph, table_html

_SHORT = {"first loop": "1st", "second loop": "2nd", "joint fit": "joint"}


def verification_sections(practice: Practice) -> list[TextSection]:
    """Friction per test, normal mode, heave compensation."""
    sections = [
        TextSection("Verification: friction per test", _friction_html(practice)),
        TextSection("Verification: pressure in normal mode", _normal_html(practice)),
    ]
    if practice.folder.ahc:
        sections.append(TextSection("Verification: heave compensation", _ahc_html(practice)))
    return sections


def _friction_html(practice: Practice) -> str:
    names = list(practice.errors)
    columns = ["test", "use", "nominal [N·m]"]
    columns += [f"{_SHORT.get(model, model)} {where}250" for model in names for where in ("≥", "<")]
    fitted = len(practice.system.tests)
    rows: list[list[Any]] = []
    for k, error in enumerate(practice.errors[names[0]]):
        cells = [practice.errors[model][k].worst(above) for model in names for above in (True, False)]
        rows.append([name(error.test), "fit" if k < fitted else "kept", error.nominal, *cells])
    return (
        paragraph(
            "Largest |modelled − measured| T_ft in % of nominal torque, at 250 rpm and above, and below; by first "
            "loop, second loop and joint fit; kept: held-out tests. Nominal: the test's load torque per motor (the "
            "heaviest test's where only the hook hung)."
        )
        + table_html(columns, rows, digits=3)
        + compared_html(practice)
        + percent_html(practice)
    )


def compared_html(practice: Practice) -> str:
    """Paper 2 Fig 16: all motors' friction, measured and modelled (joint fit)."""
    curves = []
    tests = [test.curve for test in (*practice.system.tests, *practice.system.held_out)]
    for k, (error, test) in enumerate(zip(practice.errors["joint fit"], tests, strict=True)):
        speed, label = error.speed / RPM, name(error.test)
        curves.append(Curve(label, speed, error.modelled * test.motors))
        curves.append(Curve(f"{label}, measured", speed, error.measured * test.motors, kind="dots", like=k))
    said = "Measured (dots) and modelled friction (joint fit); paper 2 Fig 16."
    return curves_html("Friction per test", SPEED, ["T_ft, all motors [N·m]"], curves, said, 400)


def percent_html(practice: Practice) -> str:
    """Paper 2 Fig 17: error over speed for each winch model."""
    fitted = len(practice.system.tests)
    rows = [f"{model}, error [%]" for model in practice.errors]
    curves = [
        Curve("held out" if k >= fitted else "fitted", error.speed / RPM, error.percent, row,
              "before" if k >= fitted else "after")
        for row, errors in enumerate(practice.errors.values())
        for k, error in enumerate(errors)
    ]  # fmt: skip
    said = "Error in % of nominal torque, a line per test; below 250 rpm apart in the table; paper 2 Fig 17."
    return curves_html("Error by speed", SPEED, rows, curves, said, 190)


def _check_rows(checks: dict[str, list[PressureCheck]]) -> list[list[Any]]:
    return [
        [name(check.run), model, check.moving_rms / BAR, check.rms / BAR, check.mean_error(+1) / BAR,
         check.mean_error(-1) / BAR]
        for model, group in checks.items()
        for check in group
    ]  # fmt: skip


_COLUMNS = ("run", "model", "RMS turning [bar]", "RMS all [bar]", "mean hoisting [bar]", "mean lowering [bar]")


def _normal_html(practice: Practice) -> str:
    checks = {model: [check] for model, check in practice.normal_mode.items()}
    said = "speed, and measured and predicted pressure drop in normal mode; paper 2 Fig 18 and 19."
    return table_html(_COLUMNS, _check_rows(checks), digits=3) + pressure_html(practice.normal_mode, said)


def _ahc_html(practice: Practice) -> str:
    figures = "".join(
        pressure_html(
            {model: checks[k] for model, checks in practice.ahc.items()},
            "speed, and measured and predicted active pressure drop by each winch model; paper 2 Fig 15, 20-23.",
        )
        for k in range(len(practice.folder.ahc))
    )
    return (
        paragraph(
            "The active group's pressure drop from load, motion and the measured passive side; it carries the "
            f"friction of all motors. Turning: |ω| above {STANDSTILL / RPM:.0f} rpm; at standstill friction lies "
            "anywhere within the break-away level. The joint fit's displacement error is taken out of its prediction. "
            "Paper 2: within about 10 of 130 bar."
        )
        + table_html(_COLUMNS, _check_rows(practice.ahc), digits=3)
        + figures
    )


def pressure_html(checks: dict[str, PressureCheck], said: str) -> str:
    """Speed above, measured and predicted pressure drop in the middle, the errors below."""
    first = next(iter(checks.values()))
    curves = [Curve("speed", first.time, first.speed / RPM, 0, "other"),
              Curve("measured", first.time, first.measured / BAR, 1, "measured")]  # fmt: skip
    for k, (model, check) in enumerate(checks.items()):
        curves.append(Curve(model, check.time, check.predicted / BAR, 1))
        curves.append(Curve(model, check.time, (check.predicted - check.measured) / BAR, 2, like=k))
    run = name(first.run)
    return curves_html(run, "time [s]", [SPEED, "Δp [bar]", "error [bar]"], curves, f"{run}: {said}", 170)
