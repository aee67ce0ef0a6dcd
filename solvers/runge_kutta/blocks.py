"""Block diagonal form of a stage matrix."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
#: Eigenvectors with a larger condition number are not used.
LARGEST_CONDITION = 1e8


@dataclass(frozen=True)
class Blocks:
    """A = T M T⁻¹ with a block diagonal matrix M; real eigenvalues come first."""

    T: Array
    inverse: Array
    M: Array
    sizes: tuple[int, ...]

    @classmethod
    def of(cls, A: Array) -> "Blocks":
        """The blocks of A: A itself is the only one if its eigenvectors are (nearly) dependent."""
        values, vectors = np.linalg.eig(A)
        columns, sizes = [], []
        for j in sorted(range(len(A)), key=lambda j: (values[j].imag != 0, values[j].real)):
            if values[j].imag >= 0:  # the other one of a pair is its conjugate
                parts = [vectors[:, j].real, vectors[:, j].imag][: 1 + (values[j].imag > 0)]
                columns += parts
                sizes.append(len(parts))
        T = np.stack(columns, axis=1)
        if not np.linalg.cond(T) < LARGEST_CONDITION:
            return cls(np.eye(len(A)), np.eye(len(A)), A, (len(A),))
        inverse = np.linalg.inv(T)
        return cls(T, inverse, inverse @ A @ T, tuple(sizes))

    def slices(self) -> Iterator[slice]:
        """Rows of each block."""
        ends = accumulate(self.sizes)
        return (slice(end - size, end) for end, size in zip(ends, self.sizes, strict=True))
