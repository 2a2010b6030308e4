"""The statistics of the workflow: arrays in, numbers out. Nothing in here knows what a winch is."""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
