"""What a column's name says, word by word, with how surely; and how well it names a channel, by hand."""

import pytest

from winch_friction.importing import names as of_importing
from winch_friction.importing.names import name_concepts, name_score, tokens


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("vinsj_hastighet", ["vinsj", "hastighet"]),
        ("fHookLoad", ["hook", "load"]),
        ("lrDruckA", ["druck", "a"]),
        ("rSpeed", ["speed"]),
        ("refSpeed", ["ref", "speed"]),  # an f that belongs to a word is no mark of a type
        ("motor_fSpeed", ["motor", "speed"]),
        ("fSPEED", ["f", "speed"]),
        ("ÖlTemperatur", ["ol", "temperatur"]),
        ("O\u0308lTemperatur", ["ol", "temperatur"]),  # the dots as a letter of their own
        ("Oeltemperatur", ["oltemperatur"]),
        ("Hublänge-Straße", ["hublange", "strasse"]),
        ("Tromle Hørsel Målt", ["tromle", "horsel", "malt"]),
        ("Temp2 45°C", ["temp", "2", "45", "c"]),
        ("café", ["cafe"]),
        ("Maalt Trykk", ["malt", "trykk"]),
        ("", []),
    ],
)
def test_a_name_is_cut_into_folded_words(name, words):
    assert tokens(name) == words


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("hook_load", [{"load": 1.0}]),  # two words that are one of the list
        ("paid out", [{"out": 1.0}]),
        ("ground_tether 7", [{"rope": 1.0}]),
        ("couche de cable", [{"layer": 1.0}]),
        ("rp m", [{"rope": 0.9}, {"motor": 0.9}]),  # what makes a short word together does not by chance
        ("v ol", [{"speed": 0.9}, {"oil": 1.0}]),
        ("the speed of the motor", [{"speed": 1.0}, {"motor": 1.0}]),  # words without a meaning are left out
        ("load 12", [{"load": 1.0}]),
        ("mot n", [{"motor": 0.9}, {"speed": 0.9}]),  # short forms as they stand
        ("V_g", [{"displacement": 0.9}]),  # a symbol with its index
        ("n_s", [{"speed": 0.9}, {}]),
        ("p_a", [{"pressure": 0.9}, {"port_a": 0.9}]),  # an index that says something by itself is none
        ("Windendrehzahl", [{"winch": 0.95}, {"speed": 0.95}]),  # two words with and without what is put between them
        ("Motordrehzahl", [{"motor": 0.95}, {"speed": 0.95}]),
        ("Seilgeschwindigkeit", [{"rope": 0.95}, {"speed": 0.95}]),
        ("lastdruckaktiv", [{"pressure": 0.95}, {"active": 0.95}]),  # the longest head first
        ("Hydraulikölltemperatur", [{"oil": 0.95}, {"temperature": 0.95}]),
        ("Windengeschwindigkiet", [{"winch": 0.95}, {"speed": 0.95}]),  # the second word misspelt
        ("druckhakenlast", [{"pressure": 0.95}, {"load": 0.95}]),
        ("oiltemperature", [{"oil": 0.95}, {"temperature": 0.95}]),  # a head of three letters is a word
        ("Motortrommeldruck", [{"motor": 0.95}, {"drum": 0.95}, {"pressure": 0.95}]),
        ("DRUCKA", [{"pressure": 0.95}, {"port_a": 0.95}]),
        ("pressureb", [{"pressure": 0.95}, {"port_b": 0.95}]),
        ("druckp", [{"pressure": 0.85}]),
        ("drucksb", [{"pressure": 0.95}, {"port_b": 0.95}]),
        ("drucksp", [{"pressure": 0.85}]),  # a letter that is no port only follows a word
        ("dp", [{"displacement": 0.95}, {"pressure": 0.95}]),
        ("druckk", [{"pressure": 0.85}]),  # a word with something behind it
        ("xdruck", [{"pressure": 0.85}]),  # and before it
        ("drehz", [{"speed": 0.75}]),  # the beginning of a word
        ("tmprtr", [{"temperature": 0.6}]),  # its consonants
        ("xyzzy", [{}]),
        ("qx", [{}]),
        ("", []),
    ],
)
def test_each_word_says_its_concepts_with_how_surely(name, said):
    assert name_concepts(name) == [pytest.approx(each) for each in said]


def test_a_misspelt_word_says_less_the_more_letters_are_wrong():
    """`speeed` for `speed` has five of its letters in common: 2 x 5 / 11."""
    assert name_concepts("speeed") == [{"speed": pytest.approx(0.8 * 10 / 11)}]
    assert of_importing._likeness("temperatrue", "temperature") == pytest.approx(0.8 * 20 / 22)


@pytest.mark.parametrize(
    ("token", "word", "quality"),
    [
        ("pressures", "pressure", 0.85),
        ("mypressure", "pressure", 0.85),
        ("axle", "ax", 0.0),  # too short a word to begin another
        ("press", "pressure", 0.75),
        ("prssr", "pressure", 0.6),
        ("rssp", "pressure", 0.0),  # another order
        ("bressure", "pressure", 0.8 * 14 / 16),
        ("presure", "pressure", 0.8 * 14 / 15),
        ("presxxxsure", "pressure", 0.0),  # three letters more
        ("spee", "seep", 0.0),  # too short to be misspelt
        ("pr", "pressure", 0.75),
        ("prssure", "pressure", 0.8 * 14 / 15),
        ("psr", "pressure", 0.6),
        ("ps", "pressure", 0.0),  # less than a third of the word
        ("prse", "pressure", 0.0),  # a vowel that is not the first
        ("tpr", "pressure", 0.0),
        ("rss", "pressure", 0.0),  # another first letter
        ("alrm", "alarm", 0.6),
        ("loxad", "load", 0.0),
    ],
)
def test_how_alike_two_words_are(token, word, quality):
    assert of_importing._likeness(token, word) == pytest.approx(quality)


def test_of_words_that_are_alike_the_nearest_are_meant():
    assert of_importing._alike("ab") == {}
    best = of_importing._alike("drehzahlx")
    assert best["speed"] == 0.85
    assert min(best.values()) >= 0.85 - 0.05


@pytest.mark.parametrize(
    ("channel", "name", "score"),
    [
        ("motor_speed", "speed", 0.75 + 0.15),
        ("motor_speed", "motor speed", 0.75 + 0.15 + 0.1),
        ("motor_speed", "mot speed", 0.75 + 0.15 + 0.1 * 0.9),
        ("motor_speed", "actual speed", 0.75 + 0.15),  # says nothing, and speaks against nothing
        ("motor_speed", "xyzzy speed", (0.75 + 0.15) * 0.93),  # a word that is in no list
        ("motor_speed", "passive speed", 0.75 + 0.15),  # which motors
        ("motor_speed", "drum speed", (0.75 + 0.15) * 0.25),  # against it
        ("motor_speed", "valve speed", (0.75 + 0.15) * 0.25),  # beside the winch
        (
            "motor_speed",
            "/simulator/truth speed",
            (0.75 + 0.15) * 0.93 * 0.25,
        ),  # what a simulator knows, nobody measured
        ("motor_speed", "/winch/joint_states speed", 0.75 + 0.15 + 0.1),  # ROS's name of what is measured of joints
        ("motor_speed", "current speed", (0.75 + 0.15) * 0.5),  # another quantity
        ("motor_speed", "n", 0.75 * 0.9 + 0.15),
        ("motor_speed", "load", 0.0),
        ("drum_speed", "drum speed", 0.75 + 0.15),
        ("drum_speed", "winch speed", (0.75 / 2 + 0.25) * 0.5),  # what is liked helps no half of it
        ("drum_speed", "speed", (0.75 / 2 + 0.25) * 0.5),  # half of what it must say
        ("pressure_a", "pressure a", 0.75 * 1.9 / 2 + 0.15),
        ("pressure_a", "pressure b", (0.75 / 2 + 0.25) * 0.5),
        ("pressure_a", "pressure a temperature", (0.75 * 1.9 / 2 + 0.15) * 0.25),
        ("load_torque", "load torque", 0.75 + 0.15),
        ("load_torque", "drum load torque", 0.75 + 0.15 + 0.1),
        ("rope_speed", "winch speed", 0.75 + 0.15 + 0.0),
        ("oil_temperature", "oil temperature", 0.75 + 0.15 + 0.1),
        ("wire_layer", "reference layer", (0.75 + 0.15) * 0.5),
    ],
)
def test_how_well_a_name_fits_a_channel(channel, name, score):
    assert name_score(channel, name_concepts(name)) == pytest.approx(score)


def test_no_name_fits_better_for_a_word_more_that_is_not_liked():
    """A word that is unknown, against the channel or another quantity takes from the score, in this order."""
    for channel, own in (("hook_load", "load"), ("rope_force", "force"), ("motor_torque", "torque")):
        scores = [name_score(channel, name_concepts(f"{own} {more}"))
                  for more in ("", "xyzzy", "temperature", "reference")]  # fmt: skip
        assert scores == sorted(scores, reverse=True)
        assert len(set(scores)) == 4


def test_a_concept_is_meant_as_surely_as_its_nearest_word_says_and_none_that_is_further(monkeypatch):
    words = {"motor": ("a",), "motorenwerk": ("a", "b"), "motorem": ("c",)}
    known = of_importing.Vocabulary(words, {}, {}, frozenset())
    monkeypatch.setattr(of_importing, "vocabulary", lambda: known)
    assert of_importing._alike("motoren") == {"a": 0.85}
    assert of_importing._alike("motorenw") == {"a": 0.85}
    known.words.pop("motor")
    assert of_importing._alike("motorenwer") == {"a": 0.75, "b": 0.75}
