"""The camera's basis, and the rule for surfaces that the eye lies on."""

from __future__ import annotations

import numpy as np
import pytest

from crosstrace.translators.mitsuba.camera import (
    basis,
    eye_on_plane,
    eye_on_sphere,
    foot,
    unit,
)


def one(*numbers: float) -> np.ndarray:
    return np.array([numbers])


def test_the_basis_is_the_specifications() -> None:
    """w points from L to E, u to the right of the picture, v up."""
    eye, target = np.array([0.0, -5.0, 0.0]), np.zeros(3)
    u, v, w = basis(eye, target, np.array([0.0, 0.0, 7.0]))
    assert np.array_equal(w, [0, -1, 0])
    assert np.array_equal(u, [1, 0, 0])
    assert np.array_equal(v, [0, 0, 1])


def test_the_basis_is_orthonormal_for_any_up() -> None:
    """`up` need be neither of length 1 nor perpendicular to the view."""
    axes = np.array(basis(np.array([3.0, 4, 5]), np.array([1.0, -2, 9]), np.array([0.1, 200, -3])))
    assert np.abs(axes @ axes.T - np.eye(3)).max() <= 4e-16


@pytest.mark.parametrize("scale", [1e-160, 1.0, 1e160])
def test_unit_vectors_survive_extreme_lengths(scale: float) -> None:
    """The squares of the components neither overflow nor vanish."""
    assert np.abs(unit(np.array([3.0, 0.0, 4.0]) * scale) - [0.6, 0.0, 0.8]).max() <= 2e-16


def test_the_foot_is_on_the_plane_below_the_eye() -> None:
    """It differs from the eye by a multiple of the normal alone."""
    eye, point, normal = np.array([1.0, 2, 3]), np.array([0.0, 0, -1]), np.array([0.0, 0, 9])
    assert np.allclose(foot(eye, point, normal), [1, 2, -1], rtol=0, atol=1e-15)


@pytest.mark.parametrize(("ulps", "on"), [(0, True), (1, True), (100, False)])
def test_the_eye_lies_on_planes_within_four_ulps(ulps: int, on: bool) -> None:
    """The distance is measured in units of the coordinates that it is the difference of."""
    eye = np.array([5.0, 200.0 * (1 + ulps * 2.0**-52), -3.0])
    assert eye_on_plane(eye, one(0, 200, 0), one(0, -1, 0))[0] == on


@pytest.mark.parametrize(("ulps", "on"), [(0, True), (1, True), (100, False)])
def test_the_eye_lies_on_spheres_within_four_ulps(ulps: int, on: bool) -> None:
    """A radius is compared with the distance from the centre."""
    eye = np.array([0.0, -5.0, 0.0])
    radius = np.array([5.0 * (1 + ulps * 2.0**-52)])
    assert eye_on_sphere(eye, one(0, 0, 0), radius)[0] == on


def test_the_centre_is_not_on_the_sphere() -> None:
    """Not even of a tiny one."""
    assert not eye_on_sphere(np.zeros(3), one(0, 0, 0), np.array([1e-3]))[0]


def test_no_objects_are_no_trouble() -> None:
    """Empty tables give empty answers."""
    nothing = np.zeros((0, 3))
    assert eye_on_sphere(np.zeros(3), nothing, np.zeros(0)).shape == (0,)
    assert eye_on_plane(np.zeros(3), nothing, nothing).shape == (0,)
