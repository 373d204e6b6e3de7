"""Tests of octray.trimesh beside trimesh's own intersector."""

import copy
import pickle

import numpy as np
import pytest

trimesh = pytest.importorskip("trimesh")
pytest.importorskip("rtree")

import octray  # noqa: E402
from octray.trimesh import _DIRECTIONS, RayMeshIntersector  # noqa: E402


def meshes():
    sphere = trimesh.creation.icosphere(2)
    return sphere, RayMeshIntersector(sphere), trimesh.ray.ray_triangle.RayMeshIntersector(sphere)


def rays(count=300):
    random = np.random.default_rng(5)
    return random.normal(0, 0.7, (count, 3)), 3 * random.normal(size=(count, 3))


def test_answers_are_trimesh_s():
    _, mine, other = meshes()
    assert (mine.intersects_first(*rays()) == other.intersects_first(*rays())).all()
    assert (mine.intersects_any(*rays()) == other.intersects_any(*rays())).all()
    locations, ray, face = mine.intersects_location(*rays())
    assert [array.dtype for array in (locations, ray, face)] == [np.float64, np.int64, np.int64]
    expected = other.intersects_location(*rays())
    order, of_other = np.lexsort((face, ray)), np.lexsort((expected[2], expected[1]))
    assert (face[order] == expected[2][of_other]).all() and (ray[order] == expected[1][of_other]).all()
    np.testing.assert_allclose(locations[order], expected[0][of_other], atol=1e-12)
    # The first hits of all rays come first.
    depth = np.array([(ray[:at] == ray[at]).sum() for at in range(len(ray))])
    assert (np.lexsort((ray, depth)) == np.arange(len(ray))).all() and depth.max() == 1
    first = mine.intersects_id(*rays(), multiple_hits=False, return_locations=True)
    count = (depth == 0).sum()
    assert (first[0] == face[:count]).all() and (first[2] == locations[:count]).all()
    assert len(mine.intersects_id(*rays(), max_hits=1)[0]) == count


@pytest.mark.parametrize("closed", [True, False])
def test_contains(closed):
    sphere, mine, _ = meshes()
    if not closed:
        sphere.update_faces(np.arange(len(sphere.faces)) > 3)
    points = np.random.default_rng(6).uniform(-1.3, 1.3, (3000, 3))
    radius = np.linalg.norm(points, axis=1)
    inside = mine.contains_points(points)
    assert inside[radius < 0.9].mean() > (0.999 if closed else 0.95) and not inside[radius > 1].any()


def test_points_in_open_meshes_are_inside_if_rays_both_ways_are_odd():
    random = np.random.default_rng(7)
    soup = trimesh.Trimesh(random.uniform(-1, 1, (600, 3)), np.arange(600).reshape(-1, 3), process=False)
    points = random.uniform(-1.2, 1.2, (2000, 3))
    count = octray.Mesh(soup.vertices, soup.faces).count
    expected = np.zeros(len(points), bool)
    low, high = soup.bounds
    left = np.flatnonzero(((points > low) & (points < high)).all(axis=1))
    for direction in _DIRECTIONS:
        there, back = (count(points[left], sign * np.array(direction)) for sign in (1, -1))
        inside = (there % 2 == 1) & (back % 2 == 1)
        assert inside.sum() > 50
        expected[left] = inside
        left = left[(there % 2 != back % 2) & (there > 0) & (back > 0)]
    assert (RayMeshIntersector(soup).contains_points(points) == expected).all()
    with pytest.raises(ValueError, match="ray or point 2: 1e-40"):
        RayMeshIntersector(soup).contains_points([[9, 9, 9], [9, 9, 9], [1e-40, 0, 0]])


def test_edges_are_hit_once_and_origins_on_a_face_too():
    box = trimesh.creation.box()
    mine = RayMeshIntersector(box)
    _, ray, face = mine.intersects_location([[0.0, 0.0, 0.5], [0.0, 0.0, 3.0]], [[0.0, 0.0, -1.0]] * 2)
    assert sorted(ray) == [0, 0, 1, 1] and len(set(face[ray == 0])) == 2


def test_many_faces_at_a_point_are_one_hit():
    cone = trimesh.creation.cone(radius=1, height=1, sections=256)
    for precision in ("exact", "single"):
        hits = RayMeshIntersector(cone, precision=precision)
        for max_hits in (2, 100):
            faces, _, places = hits.intersects_id([[0, 0, 5.0]], [[0, 0, -1.0]], True, max_hits, True)
            np.testing.assert_allclose(places, [[0, 0, 1], [0, 0, 0]], atol=1e-6)


def test_changes_of_the_mesh_are_seen():
    sphere, mine, _ = meshes()
    ray = [[5.0, 0.0, 0.0]], [[-1.0, 0.0, 0.0]]
    assert np.isclose(mine.intersects_location(*ray, multiple_hits=False)[0][0, 0], 1.0, atol=0.02)
    for changed in (mine, copy.copy(mine), copy.deepcopy(mine), pickle.loads(pickle.dumps(mine))):
        changed.mesh.apply_translation([1.0, 0.0, 0.0])
        x = changed.mesh.bounds[1, 0]
        assert np.isclose(changed.intersects_location(*ray, multiple_hits=False)[0][0, 0], x, atol=0.02)


def test_nothing():
    empty = RayMeshIntersector(trimesh.Trimesh(np.zeros((0, 3)), np.zeros((0, 3), int)))
    locations, ray, face = empty.intersects_location(*rays(2))
    assert locations.shape == (0, 3) and len(ray) == len(face) == 0
    assert (empty.intersects_first(*rays(2)) == -1).all()
