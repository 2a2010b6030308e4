"""Names for spoilt logs: in three languages as crane makers write them, and words held out from the importer's table.

`HELD_OUT` must stay out of winch_friction/importing/words.yaml (a test looks): they show what the importer makes of
words that nobody taught it.
"""

# channel (without group) -> names; {g} the motor group's word, {p} the port's
NAMES: dict[str, dict[str, tuple[str, ...]]] = {
    "en": {
        "time": ("Time", "Timestamp", "t"),
        "motor_speed": ("Motor speed", "n_motor", "WinchSpeed", "motor_rpm_act", "Shaft Velocity"),
        "pressure": ("Pressure {p} {g}", "p_{p}_{g}", "{g} motor press {p}", "P{p} {g}"),
        "displacement": ("Displacement {g}", "Vg_{g}", "{g} swash", "disp_{g}"),
        "hook_load": ("Hook load", "load", "LoadCell", "crane_weight"),
        "wire_out": ("Wire out", "payout_length", "Rope length"),
        "wire_layer": ("Wire layer", "layer", "drum_layer"),
        "rope_force": ("Rope force", "tether_tension", "line pull"),
        "mechanical_power": ("Mechanical power", "motor_power", "pwr"),
        "motor_torque": ("Motor torque", "torque_act", "trq"),
    },
    "de": {
        "time": ("Zeit", "Zeitstempel", "Datum"),
        "motor_speed": ("Windendrehzahl", "n_Motor", "Motordrehzahl Ist", "Drehzahl Winde", "DrehzahlHydromotor"),
        "pressure": ("Druck {p} {g}", "p_{p}_{g}", "Druck{p}_{g}", "Arbeitsdruck Anschluss {p} {g}"),
        "displacement": ("Schluckvolumen {g}", "Vg {g}", "Verdrängungsvolumen {g}", "Schwenkwinkel_{g}"),
        "hook_load": ("Hakenlast", "Last", "Kranlast", "Masse am Haken"),
        "wire_out": ("Seillänge", "Seil ausgelegt", "Seillaenge"),
        "wire_layer": ("Lage", "Seillage", "Wickellage"),
        "rope_force": ("Seilkraft", "Seilzug", "Zugkraft Seil"),
        "mechanical_power": ("Leistung", "Wellenleistung", "mech. Leistung"),
        "motor_torque": ("Motordrehmoment", "Drehmoment", "Md_Motor"),
    },
    "no": {
        "time": ("Tid", "Tidsstempel", "Klokkeslett"),
        "motor_speed": ("vinsj_hastighet", "Motorturtall", "Turtall motor", "vinsjturtall"),
        "pressure": ("Trykk {p} {g}", "trykk_{p}_{g}", "Oljetrykk {p} {g}", "p{p}_{g}"),
        "displacement": ("Slagvolum {g}", "fortrengning_{g}", "Deplasement {g}"),
        "hook_load": ("Kroklast", "Last i krok", "vekt", "hengende last"),
        "wire_out": ("Wire ute", "Utlagt wire", "wirelengde"),
        "wire_layer": ("Wirelag", "Lag", "Trommellag"),
        "rope_force": ("Wirekraft", "strekk i wire", "taukraft"),
        "mechanical_power": ("Effekt", "mekanisk effekt", "motoreffekt"),
        "motor_torque": ("Motormoment", "dreiemoment", "moment motor"),
    },
}
HELD_OUT: dict[str, tuple[str, ...]] = {
    "time": ("Zeitachse", "loggtid", "sample_time", "Messzeitpkt"),
    "motor_speed": (
        "Umlaufzahl Winde",
        "rotasjonshastighet",
        "Hydromotordrehz.",
        "WnchSpd",
        "angular_velocity",
        "spillhastighed",
    ),
    "pressure": ("Betriebsdruck {p} {g}", "Fluiddr. {p} {g}", "tryk_{p}_{g}", "Prssr {p} {g}", "Leitungsdruck_{p}_{g}"),
    "displacement": ("Hubvol. {g}", "slagvolym {g}", "deplacement_{g}", "Motorvolumen {g}"),
    "hook_load": ("Anhängelast", "payload", "krokvekt", "Tragelast", "lyftlast"),
    "wire_out": ("Trossenlänge", "wire_paid_out_m", "uttatt wire", "Leinenlänge"),
    "wire_layer": ("Windungslage", "wrap_layer", "viklingslag"),
    "rope_force": ("Trossenzug", "tethertension_N", "linjespenning"),
    "mechanical_power": ("Wirkleistung", "shaftpowr", "ytelse"),
    "motor_torque": ("Wellenmoment", "momentti", "torqe"),
}
GROUPS = {
    "en": {"active": ("active", "Active", "act"), "passive": ("passive", "Passive", "pass"), "main": ("", "main")},
    "de": {"active": ("Aktiv", "aktiv", "akt"), "passive": ("Passiv", "passiv", "pas"), "main": ("", "Haupt")},
    "no": {"active": ("aktiv", "Aktiv", "akt"), "passive": ("passiv", "Passiv", "pas"), "main": ("", "hoved")},
}
# channel -> (spelling, factor from SI, digits) as logs write it
UNITS: dict[str, tuple[tuple[str, float, int], ...]] = {
    "motor_speed": (("rpm", 9.549296585513721, 1), ("1/min", 9.549296585513721, 1), ("U/min", 9.549296585513721, 1),
                    ("min-1", 9.549296585513721, 1), ("rad/s", 1.0, 3), ("o/min", 9.549296585513721, 1)),
    "pressure": (("bar", 1e-5, 2), ("barg", 1e-5, 2), ("MPa", 1e-6, 3), ("Pa", 1.0, 0), ("psi", 1.450377e-4, 1)),
    "displacement": (("cm3/rev", 6283185.307179586, 2), ("ccm", 6283185.307179586, 2), ("ccm/U", 6283185.307179586, 2),
                     ("cm³/U", 6283185.307179586, 2), ("cm^3/rev", 6283185.307179586, 2)),
    "hook_load": (("t", 1e-3, 3), ("te", 1e-3, 3), ("kg", 1.0, 0), ("tonnes", 1e-3, 3), ("kN", 9.81e-3, 2)),
    "wire_out": (("m", 1.0, 3),),
    "wire_layer": (("", 1.0, 0),),
    "rope_force": (("kN", 1e-3, 4), ("N", 1.0, 1), ("kgf", 1 / 9.80665, 3)),
    "mechanical_power": (("kW", 1e-3, 4), ("W", 1.0, 1)),
    "motor_torque": (("Nm", 1.0, 7), ("mNm", 1e3, 4)),
}  # fmt: skip
