"""The tables of the two papers, recalculated, to the printed digits."""

import pytest

from winch_friction.physics.channels import BAR, CM3_PER_REV, GRAVITY, RPM
from winch_friction.physics.winch import operating_point
from winch_friction.records.model_file import load_model

MOTOR_TABLE = [
    (400, 215, 100, "19.63"),
    (1000, 215, 200, "38.70"),
    (2000, 215, 200, "87.76"),
    (2500, 215, 350, "136.59"),
    (1000, 145, 200, "26.35"),
    (1000, 70, 275, "25.29"),
    (2000, 70, 275, "27.39"),
]
SPEEDS = (0, 50, 229, 1000, 2000)
# drum torque of 100 t: the tables print T_d rounded, so the exact m g R is used
SYSTEM_TABLE = [
    (1.136, 1, ("53.19", "42.40", "22.92", "14.44", "15.27")),
    (1.136, 2, ("35.89", "32.44", "24.84", "19.27", "20.03")),
    (1.000, 1, ("47.20", "37.61", "20.29", "12.82", "13.65")),
    (1.000, 2, ("31.66", "28.62", "21.92", "17.08", "17.87")),
]


@pytest.mark.parametrize(("speed", "displacement", "pressure", "printed"), MOTOR_TABLE)
def test_motor_torque_loss_mj4(speed, displacement, pressure, printed):
    group = (1, pressure * BAR, 0.0, displacement * CM3_PER_REV)
    x = operating_point(direction=1.0, speed=speed * RPM, drum_torque=0.0, groups=[group], motor_total=1)
    assert f"{float(load_model('a6vm215').torque(x)):.2f}" == printed


@pytest.mark.parametrize(("radius", "crane", "printed"), SYSTEM_TABLE)
def test_system_friction_of_both_cranes(radius, crane, printed):
    model = load_model(f"a6vm215_crane{crane}").only("gear and drum")
    for speed, expected in zip(SPEEDS, printed, strict=True):
        torque = model.torque(
            operating_point(direction=1.0, speed=speed * RPM, drum_torque=100e3 * GRAVITY * radius, motor_total=1)
        )
        assert f"{float(torque):.2f}" == expected


def test_erratum_displacement_is_per_radian():
    """At 215 cm^3/rev and 2000 rpm the K2 term is 64.9 N m; per revolution it would be 16 kN m."""
    model = load_model("a6vm215").subset(["motor_turbulence"])
    group = (1, 0.0, 0.0, 215 * CM3_PER_REV)
    x = operating_point(direction=1.0, speed=2000 * RPM, drum_torque=0.0, groups=[group], motor_total=1)
    assert float(model.torque(x)) == pytest.approx(64.9, abs=0.05)


def test_erratum_closure_of_the_passive_side(crane_150t):
    """8 x 70 cm^3/rev at 275 bar balance 55 t on the outer layer."""
    passive = 8 * 70 * CM3_PER_REV * 275 * BAR
    assert passive == pytest.approx(2451, abs=1)
    assert crane_150t.drum_torque(55e3) / crane_150t.gear_ratio == pytest.approx(passive, rel=2e-3)
