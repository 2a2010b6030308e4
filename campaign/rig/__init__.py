"""An independent generator of winch data: it shares no equation, no simulator and no constant with the package.

`make_dataset(seed, flavour, [(effect, size), ...])` gives twelve runs as SI columns; `write_csv` writes them as files.
"""

from campaign.rig.dataset import make_dataset, suitable_flavours
from campaign.rig.effects import CATALOGUE, OUTSIDE, OUTSIDE_SIGNAL
from campaign.rig.files import write_csv
from campaign.rig.flavour import FLAVOURS

__all__ = ["CATALOGUE", "FLAVOURS", "OUTSIDE", "OUTSIDE_SIGNAL", "make_dataset", "suitable_flavours", "write_csv"]
