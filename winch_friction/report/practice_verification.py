"""Report sections of the practice: verification as paper 2 section 4."""

from typing import Any

import numpy as np

from winch_friction.identification.practice import Practice
from winch_friction.identification.verification import STANDSTILL, PressureCheck
from winch_friction.physics.units import BAR, RPM
from winch_friction.report.base import TextSection
from winch_friction.report.figures import figure_html, new_figure
from winch_friction.report.practice_look import below_legend, colour, name
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
    columns = ["test", "use", "nominal N·m"]
    columns += [f"{_SHORT.get(model, model)} {where}250" for model in names for where in ("≥", "<")]
    fitted = len(practice.system.tests)
    rows: list[list[Any]] = []
    for k, error in enumerate(practice.errors[names[0]]):
        cells = [practice.errors[model][k].worst(above) for model in names for above in (True, False)]
        rows.append([name(error.test), "fit" if k < fitted else "kept", error.nominal, *cells])
    return (
        paragraph(
            "Largest |modelled − measured| T_ft in % of nominal torque, at 250 rpm and above, and below; by first "
            "loop, second loop and joint fit; kept: held-out tests. Nominal: "
            "the test's load torque per motor (the heaviest "
            "test's where only the hook hung)."
        )
        + table_html(columns, rows, digits=3)
        + figure_html(compared_figure(practice), "Measured (dots) and modelled friction; paper 2 Fig 16.")
        + figure_html(percent_figure(practice), "Error in % of nominal torque; paper 2 Fig 17.")
    )


def compared_figure(practice: Practice) -> Any:
    """Paper 2 Fig 16: all motors' friction, measured and modelled (joint fit)."""
    figure, axes = new_figure(height=3.8)
    curves = [test.curve for test in (*practice.system.tests, *practice.system.held_out)]
    for k, (error, curve) in enumerate(zip(practice.errors["joint fit"], curves, strict=True)):
        axes.plot(error.speed / RPM, error.modelled * curve.motors, color=colour(k), lw=1.0)
        axes.plot(
            error.speed[::2] / RPM,
            error.measured[::2] * curve.motors,
            "o",
            ms=2.5,
            color=colour(k),
            label=name(error.test),
        )
    axes.set(xlabel="motor speed [rpm]", ylabel="T_ft, all motors [N·m]")
    below_legend(axes, 6)
    return figure


def percent_figure(practice: Practice) -> Any:
    """Paper 2 Fig 17: error over speed for each winch model."""
    names = list(practice.errors)
    figure, axes = new_figure(1, len(names), height=3.2, sharey=True)
    fitted = len(practice.system.tests)
    for axis, model in zip(np.atleast_1d(axes), names, strict=True):
        for k, error in enumerate(practice.errors[model]):
            axis.plot(
                error.speed / RPM, error.percent, lw=0.9, color=colour(1) if k >= fitted else colour(0), alpha=0.8
            )
        axis.axvline(250, lw=0.7, color="gray")
        axis.set(xlabel="motor speed [rpm]", title=model)
    np.atleast_1d(axes)[0].set(ylabel="error [% of nominal]")
    figure.suptitle("blue: fitted tests; orange: held out", fontsize=9, x=0.01, ha="left")
    return figure


def _check_rows(checks: dict[str, list[PressureCheck]]) -> list[list[Any]]:
    return [
        [name(check.run), model, check.moving_rms / BAR, check.rms / BAR, check.mean_error(+1) / BAR,
         check.mean_error(-1) / BAR]
        for model, group in checks.items()
        for check in group
    ]  # fmt: skip


_COLUMNS = ("run", "model", "RMS turning, bar", "RMS all, bar", "mean hoisting, bar", "mean lowering, bar")  # fmt: skip


def _normal_html(practice: Practice) -> str:
    checks = {model: [check] for model, check in practice.normal_mode.items()}
    return table_html(_COLUMNS, _check_rows(checks), digits=3) + figure_html(
        pressure_figure(practice.normal_mode),
        "Speed, and measured and predicted pressure drop in normal mode; paper 2 Fig 18 and 19.",
    )


def _ahc_html(practice: Practice) -> str:
    figures = "".join(
        figure_html(
            pressure_figure({model: checks[k] for model, checks in practice.ahc.items()}),
            f"{name(run.name)}: speed, and measured and predicted active pressure drop by each winch model; paper 2 "
            "Fig 15, 20-23.",
        )
        for k, run in enumerate(practice.folder.ahc)
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


def pressure_figure(checks: dict[str, PressureCheck]) -> Any:
    """Speed above, measured and predicted pressure drop in the middle, the errors below."""
    figure, (above, middle, below) = new_figure(3, 1, height=1.9, sharex=True)
    first = next(iter(checks.values()))
    above.plot(first.time, first.speed / RPM, lw=0.8)
    middle.plot(first.time, first.measured / BAR, lw=1.4, color=colour(0), label="measured")
    for k, (model, check) in enumerate(checks.items(), start=1):
        middle.plot(check.time, check.predicted / BAR, lw=0.8, color=colour(k), label=model)
        below.plot(check.time, (check.predicted - check.measured) / BAR, lw=0.7, color=colour(k))
    above.set(ylabel="motor speed [rpm]", title=name(first.run))
    middle.set(ylabel="Δp [bar]")
    below.set(ylabel="error [bar]", xlabel="time [s]")
    middle.legend(ncols=4, loc="upper right", fontsize=8)
    return figure
