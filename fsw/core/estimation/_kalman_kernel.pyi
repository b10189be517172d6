import numpy as np
from numpy.typing import NDArray

SOURCE_SHA256: str

def predict(
    P: NDArray[np.float64], F: NDArray[np.float64], Q: NDArray[np.float64], /
) -> NDArray[np.float64]: ...
def update(
    P: NDArray[np.float64],
    y: tuple[float, ...],
    R: NDArray[np.float64],
    H: NDArray[np.float64],
    first: int,
    last: int,
    /,
) -> (
    tuple[
        NDArray[np.float64],
        NDArray[np.float64],
        NDArray[np.float64],
        NDArray[np.float64],
        NDArray[np.float64],
    ]
    | None
): ...
def product(A: NDArray[np.float64], B: NDArray[np.float64], /) -> NDArray[np.float64]: ...
def inverse(M: NDArray[np.float64], /) -> NDArray[np.float64] | None: ...
def combine(numbers: tuple[float, ...], rows: NDArray[np.float64], /) -> NDArray[np.float64]: ...
