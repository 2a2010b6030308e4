"""What a new channel of the table needs besides its row, so that a log of somebody else's can hold it."""

from pathlib import Path

import pytest

from winch_friction.importing.guess import _ELECTRIC as SEARCHED
from winch_friction.importing.names import vocabulary
from winch_friction.importing.units import CHANNEL_UNITS, usual_units
from winch_friction.physics.channels import CHANNELS

DOCUMENT = (Path(__file__).parents[2] / "docs/interfaces.md").read_text()
LOGGED = [each for each in CHANNELS if not each.name.endswith("_simulated")]


@pytest.mark.parametrize("channel", LOGGED, ids=lambda each: each.name)
def test_every_logged_channel_is_known_to_import_and_to_the_documents(channel):
    """With its row alone it was read from run files, and from no log that `import` was given; nothing said so."""
    name = channel.name
    assert f"{name}`" in DOCUMENT, "the table of columns in docs/interfaces.md"
    assert name in vocabulary().channels, "channels in importing/words.yaml: the words that its name is known by"
    assert CHANNEL_UNITS.get(name, ("",))[0] == channel.unit, (
        "CHANNEL_UNITS in importing/units.py: SI units of its logs"
    )
    if name != "time":
        assert usual_units(name), "_USUAL in importing/units.py: units that are tried where a log says none"
        assert channel.of_group or name in SEARCHED, "_HYDRAULIC or _ELECTRIC in importing/guess.py"
