"""Image operations: what is done wrong to an image between the renderer and the comparison.

Each takes linear float (v_res, h_res, 3) and returns a new array of that shape.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def brighter(image: Array) -> Array:
    """Multiply by 1.01."""
    return 1.01 * image


def mirrored(image: Array) -> Array:
    """Swap left and right."""
    return image[:, ::-1].copy()


def half_pixel_right(image: Array) -> Array:
    """Average each pixel with its left neighbour, as resampling half a pixel to the right does."""
    left = np.concatenate([image[:, :1], image[:, :-1]], axis=1)
    return 0.5 * (left + image)


def clamped(image: Array) -> Array:
    """Cut each component to 0…1, where the course's display rule would scale the colour."""
    return np.clip(image, 0.0, 1.0)


def srgb(image: Array) -> Array:
    """Apply the transfer function of IEC 61966-2-1, its power continued beyond 1."""
    linear = np.maximum(image, 0.0)
    curve = 1.055 * linear ** (1 / 2.4) - 0.055
    return np.where(image <= 0.0031308, 12.92 * image, curve)
