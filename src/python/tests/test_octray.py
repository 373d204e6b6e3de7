"""Tests of the package octray, beside a few lines of NumPy that test every face."""

import copy
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from multiprocessing import get_context

import numpy as np
import pytest

import octray

PRECISIONS = ["exact", "single"]


def soup(count=300, seed=1):
    random = np.random.default_rng(seed)
    corners = random.random((count, 1, 3)) + random.normal(0, 0.1, (count, 3, 3))
    return corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)


def rays(count=2000, seed=2):
    random = np.random.default_rng(seed)
    return random.random((count, 3)), random.normal(size=(count, 3))


def brute(vertices, faces, origins, directions):
    """Returns t, u and v of every ray and face; t is infinite where there is no hit."""
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    p = np.cross(directions[:, None], c - a)
    determinant = ((b - a) * p).sum(-1)
    s = origins[:, None] - a
    q = np.cross(s, b - a)
    u = (s * p).sum(-1) / determinant
    v = (directions[:, None] * q).sum(-1) / determinant
    t = ((c - a) * q).sum(-1) / determinant
    return np.where((u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0), t, np.inf), u, v


@pytest.mark.parametrize("precision", PRECISIONS)
def test_queries_agree_with_every_face(precision):
    vertices, faces = soup()
    mesh = octray.Mesh(vertices, faces, precision)
    origins, directions = rays()
    t, u, v = brute(vertices, faces, origins, directions)
    hits = mesh.closest(origins, directions)
    assert [column.dtype for column in hits] == [np.float64, np.int32, np.float64, np.float64]
    hit, at = np.isfinite(t).any(1), t.argmin(1)
    same = hits.primitive == np.where(hit, at, -1)
    assert same.all() if precision == "exact" else same.mean() > 0.99
    assert 100 < hit.sum() < len(hit) - 100
    tolerance = 1e-12 if precision == "exact" else 1e-3
    rows = np.flatnonzero(hit & same)
    np.testing.assert_allclose(hits.t[rows], t[rows, at[rows]], rtol=tolerance)
    np.testing.assert_allclose(hits.u[rows], u[rows, at[rows]], atol=tolerance)
    np.testing.assert_allclose(hits.v[rows], v[rows, at[rows]], atol=tolerance)
    assert np.isinf(hits.t[~hit & same]).all()
    assert (mesh.occluded(origins, directions) == (hits.primitive >= 0)).all()
    between = mesh.closest(origins, directions, 0.2, np.full(len(origins), 0.4))
    expected = np.where((t > 0.2) & (t < 0.4), t, np.inf).min(1)
    same = np.isclose(between.t, expected, rtol=tolerance)
    assert same.mean() > 0.99 and np.isfinite(expected).any()
    offsets, *columns = mesh.all_hits(origins, directions)
    counts = np.isfinite(t).sum(1)
    assert (np.diff(offsets) == counts).mean() > 0.99
    assert (mesh.count(origins, directions) == np.diff(offsets)).all()
    ray = np.repeat(np.arange(len(origins)), np.diff(offsets))
    ordered = np.lexsort((columns[0], ray))
    assert (np.sort(columns[0][ordered]) == np.sort(columns[0])).all() and (ordered == np.arange(len(ray))).all()
    np.testing.assert_allclose(columns[0], t[ray, columns[1]], rtol=tolerance)
    few, t_of_few, *_ = mesh.all_hits(origins, directions, max_hits=2)
    assert (np.diff(few) == np.minimum(np.diff(offsets), 2)).all()
    first = np.arange(len(ray)) - offsets[ray] < 2
    assert (t_of_few == columns[0][first]).all()


def test_layouts_and_types_give_the_same_answers():
    vertices, faces = soup()
    vertices = vertices.astype(np.float32)
    origins, directions = (array.astype(np.float32) for array in rays())
    expected = octray.Mesh(vertices, faces).closest(origins, directions)
    shifted = np.frombuffer(b"x" + origins.tobytes(), np.uint8)[1:].view(np.float32).reshape(-1, 3)
    for change in [
        lambda array: array.astype(np.float64),
        np.asfortranarray,
        lambda array: np.repeat(array, 2, axis=0)[::2],
        lambda array: array.astype(">f8"),
        lambda array: shifted if array is origins else array.tolist(),
    ]:
        hits = octray.Mesh(change(vertices), faces.astype(np.uint16)).closest(change(origins), change(directions))
        assert all((a == b).all() for a, b in zip(hits, expected))
    mesh = octray.Mesh(vertices, faces)
    for one in [origins[0], origins[0].tolist()]:
        hits, same = mesh.closest(one, directions), mesh.closest(np.tile(origins[0], (2000, 1)), directions)
        assert all((a == b).all() for a, b in zip(hits, same)) and (hits.primitive >= 0).any()
    upwards = np.tile([0.0, 0.0, 2.0], (2000, 1))
    assert (mesh.count(origins, (0, 0, 2)) == mesh.count(origins, upwards)).all()


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_threads_and_long_calls_change_no_answer(threads):
    vertices, faces = soup(40)
    origins, directions = rays(150_000)
    t, *_ = brute(vertices, faces, origins[-500:], directions[-500:])
    mesh = octray.Mesh(vertices, faces, threads=threads)
    hits = mesh.closest(origins, directions)
    assert (hits.primitive[-500:] == np.where(np.isfinite(t).any(1), t.argmin(1), -1)).all()
    assert (mesh.all_hits(origins, directions).offsets[-501:] - np.append(0, np.isfinite(t).sum(1).cumsum())).std() == 0


def test_edges_and_origins_are_exact():
    # Two triangles of a square, with the diagonal under the ray, and an origin on it.
    vertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    mesh = octray.Mesh(vertices, [[0, 1, 2], [0, 2, 3]])
    ray = [[1 / 3, 1 / 3, 1.0]], [[0.0, 0.0, -1.0]]
    assert mesh.all_hits(*ray).primitive.tolist() == [0, 1] and mesh.count(*ray)[0] == 1
    there = [[0.25, 0.5, 0.0]], [[0.0, 0.0, 1.0]]
    assert mesh.closest(*there).primitive[0] == -1
    hits = mesh.closest(*there, t_min=-1.0)
    assert (hits.primitive[0], hits.t[0]) == (1, 0.0)


def test_errors_name_shapes_and_rays():
    vertices, faces = soup(4)
    mesh = octray.Mesh(vertices, faces)
    origins, directions = rays(40_000)
    for part, call in [
        (r"origins: the shape is \(40000, 2\)", lambda: mesh.closest(origins[:, :2], directions)),
        (r"origins \(3,\) and directions \(3,\): use", lambda: mesh.closest(origins[0], directions[0])),
        (r"\(40000, 3\) and directions \(2, 3\)", lambda: mesh.occluded(origins, directions[:2])),
        (r"t_max: the shape is \(2,\) instead of \(\) or \(40000,\)", lambda: mesh.count(origins, directions, 0, [1, 2])),
        (r"vertex 12; the vertices are \(12, 3\)", lambda: octray.Mesh(vertices, [[0, 1, 12]])),
        (r"vertex -1", lambda: octray.Mesh(vertices, [[0, 1, -1]])),
        (r"float64 of the shape \(1, 3\) instead of integers", lambda: octray.Mesh(vertices, [[0.0, 1.0, 2.0]])),
        ("neither", lambda: octray.Mesh(vertices, faces, "double")),
        ("max_hits: -1", lambda: mesh.all_hits(origins, directions, max_hits=-1)),
        ("threads: 0", lambda: octray.Mesh(vertices, faces, threads=0)),
        ("nan", lambda: octray.Mesh(vertices * np.nan, faces)),
    ]:
        with pytest.raises(ValueError, match="(?i)" + part):
            call()
    directions[39_999, 0] = 1e-50
    with pytest.raises(ValueError, match="ray or point 39999: 1e-50"):
        mesh.closest(origins, directions)


def test_pickle_and_copy():
    mesh = octray.Mesh(*soup(), precision="single", threads=2)
    for other in [pickle.loads(pickle.dumps(mesh)), copy.copy(mesh), copy.deepcopy(mesh)]:
        assert (other.precision, other.threads) == ("single", 2)
        assert all((a == b).all() for a, b in zip(other.closest(*rays()), mesh.closest(*rays())))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="without fork")
def test_forked_processes_answer():
    mesh = octray.Mesh(*soup(), threads=2)
    query = rays(50_000)
    expected = mesh.occluded(*query).sum()
    with get_context("fork").Pool(1) as pool:
        assert pool.apply_async(hits_of, (mesh, query)).get(timeout=30) == expected


def hits_of(mesh, query):
    return mesh.occluded(*query).sum()


def test_gil_is_released():
    mesh = octray.Mesh(*soup(3000), threads=1)
    thread = threading.Thread(target=mesh.all_hits, args=rays(200_000))
    thread.start()
    longest, last = 0.0, time.perf_counter()
    while thread.is_alive():
        now = time.perf_counter()
        longest, last = max(longest, now - last), now
        time.sleep(0)
    assert longest < 0.5


LONG = {
    "query": "octray.Mesh(*soup(20_000), threads=1).all_hits(*rays(2_000_000))",
    "render": "octray.render('builtin:three', samples=1_000_000)",
}


@pytest.mark.parametrize("call", LONG)
def test_ctrl_c_ends_a_long_call(call):
    # Where the tests run in the background, Ctrl-C is ignored until it has a handler.
    handler = "signal.signal(signal.SIGINT, signal.default_int_handler)"
    code = f"from test_octray import *; {handler}; print('begun', flush=True); {LONG[call]}"
    process = subprocess.Popen(
        [sys.executable, "-c", code], cwd=os.path.dirname(__file__), stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    process.stdout.readline()
    time.sleep(3)
    assert process.poll() is None
    start = time.time()
    process.send_signal(signal.SIGINT)
    assert b"KeyboardInterrupt" in process.communicate(timeout=60)[1]
    assert time.time() - start < 10


SCENE = {
    "format": "octray-1",
    "camera": {"position": [0, 0, 5], "look_at": [0, 0, 0]},
    "resolution": [24, 16],
    "materials": {"light": {"type": "diffuse", "color": [0, 0, 0], "emission": [1, 0.5, 0.25]}},
    "sky": {"color": [0, 0, 0]},
    "spheres": [{"center": [0, 0, 0], "radius": 1, "material": "light"}],
}


def test_render_returns_what_the_scene_holds(tmp_path):
    picture = octray.render(SCENE, samples=4, threads=1)
    assert picture.shape == (16, 24, 3) and picture.dtype == np.float32
    assert picture[8, 12].tolist() == [1, 0.5, 0.25] and (picture[0, 0] == 0).all()
    assert (octray.render(SCENE, samples=4, threads=3) == picture).all()
    (tmp_path / "one.obj").write_text("v -9 -9 0\nv 9 -9 0\nv 0 9 0\nf 1 2 3\n")
    scene = {**SCENE, "spheres": [], "meshes": [{"obj": "one.obj", "material": "light"}]}
    assert (octray.render(scene, (8, 6), 1, folder=tmp_path)[3, 4] == [1, 0.5, 0.25]).all()
    png = picture._repr_png_()
    assert png[:8] == b"\x89PNG\r\n\x1a\n" and int.from_bytes(png[16:20], "big") == 24
    assert octray.render("builtin:three", (16, 9), 2, denoise=True).std() > 0
    with pytest.raises(ValueError, match="spheress"):
        octray.render({**SCENE, "spheress": []})
    with pytest.raises(ValueError, match="size"):
        octray.render(SCENE, (0, 5))
