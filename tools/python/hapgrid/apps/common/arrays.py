"""Types of arrays, and of what is in them."""

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy.typing as npt

Array: TypeAlias = npt.NDArray[Any]  # of numbers
Shapes: TypeAlias = Sequence[Array]  # each (atoms, 3)
Neighbours: TypeAlias = list[list[int]]  # of each atom, ascending
