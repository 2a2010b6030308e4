"""An independent generator of winch data: it shares no equation, no simulator and no constant with the package.

`make_dataset(seed, flavour, [(effect, size), ...])` gives twelve runs as SI columns; `write_csv` writes them as files.
"""

from campaign.rig.dataset import DRAWN, make_dataset, suitable_flavours, world_of
from campaign.rig.effects import CATALOGUE, OUTSIDE, OUTSIDE_SIGNAL
from campaign.rig.files import write_csv
from campaign.rig.flavour import FLAVOURS
from campaign.rig.laws import DRAWN_LAW, LAWS, cause_of
from campaign.rig.package_files import write_world

__all__ = [
    "CATALOGUE", "DRAWN", "DRAWN_LAW", "FLAVOURS", "LAWS", "OUTSIDE", "OUTSIDE_SIGNAL", "cause_of", "make_dataset",
    "suitable_flavours", "world_of", "write_csv", "write_world",
]  # fmt: skip
