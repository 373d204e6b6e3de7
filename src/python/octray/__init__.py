"""Rays through triangle meshes, fast or exact, and a path tracer for CPUs.

>>> import octray
>>> mesh = octray.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
>>> mesh.closest([[0.2, 0.2, 5.0]], [[0.0, 0.0, -1.0]]).t
array([5.])

Long calls release the GIL, and Ctrl-C ends them.
"""

from __future__ import annotations

import json
import os
import warnings
from pathlib import Path
from typing import Any, NamedTuple, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._pick import core

__all__ = ["AllHits", "Hits", "Mesh", "Picture", "render"]


class Hits(NamedTuple):
    """The first hit of each ray.

    Attributes
    ----------
    t : (n,) float64
        Distances in lengths of the directions; infinity for a miss.
    primitive : (n,) int32
        Faces; -1 for a miss.
    u, v : (n,) float64
        Barycentric weights of the second and of the third vertex; 0 for a miss.
    """

    t: NDArray[np.float64]
    primitive: NDArray[np.int32]
    u: NDArray[np.float64]
    v: NDArray[np.float64]


class AllHits(NamedTuple):
    """Every hit of each ray, in order: those of ray i are ``offsets[i]`` to ``offsets[i + 1]``.

    Attributes
    ----------
    offsets : (n + 1,) int64
        The first hit of each ray, and at the end the number of hits.
    t, primitive, u, v : (m,)
        The hits, as in `Hits`.
    """

    offsets: NDArray[np.int64]
    t: NDArray[np.float64]
    primitive: NDArray[np.int32]
    u: NDArray[np.float64]
    v: NDArray[np.float64]


def _triples(name: str, values: ArrayLike) -> NDArray[Any]:
    array = np.asanyarray(values)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name}: the shape is {array.shape} instead of (n, 3)")
    return np.require(array, np.float32 if array.dtype == np.float32 else np.float64, ["C", "A"])


def _ends(name: str, values: Optional[ArrayLike], default: float, count: int) -> Any:
    array = np.asarray(default if values is None else values, np.float64)
    if array.shape == ():
        return float(array)
    if array.shape != (count,):
        raise ValueError(f"{name}: the shape is {array.shape} instead of () or ({count},)")
    return np.require(array, None, ["C", "A"])


def _rays(
    origins: ArrayLike,
    directions: ArrayLike,
    t_min: Optional[ArrayLike] = None,
    t_max: Optional[ArrayLike] = None,
) -> tuple:
    origins, directions = np.asanyarray(origins), np.asanyarray(directions)
    shapes = origins.shape, directions.shape
    # One triple for all is passed as a tuple.
    origins = tuple(map(float, origins)) if shapes[0] == (3,) else _triples("origins", origins)
    directions = tuple(map(float, directions)) if shapes[1] == (3,) else _triples("directions", directions)
    if shapes[0] != shapes[1] and (3,) not in shapes or shapes == ((3,), (3,)):
        raise ValueError(f"origins {shapes[0]} and directions {shapes[1]}: use (n, 3) twice, or once and (3,)")
    count = max(shape[0] for shape in shapes if shape != (3,))
    return origins, directions, _ends("t_min", t_min, 0.0, count), _ends("t_max", t_max, np.inf, count)


def _threads(threads: Optional[int]) -> int:
    if threads is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if not 1 <= threads <= 4096:
        raise ValueError(f"threads: {threads} is not between 1 and 4096")
    return int(threads)


class Mesh:
    """A triangle mesh that is ready for queries. It never changes.

    Parameters
    ----------
    vertices : (n, 3) float32 or float64
        Other numbers become float64. C-contiguous arrays are read in place.
    faces : (m, 3) int
        Indices into the vertices.
    precision : {"exact", "single"}
        "exact": which faces are hit, and in which order, is that of real arithmetic on the given numbers.
        "single": the fastest; t is off by some 1e-6, and hits near edges may be on the neighbour.
    threads : int, optional
        Threads of each query; by default one for each core that the process may use.

    Notes
    -----
    Hits have ``t_min < t < t_max``. In "exact", a negative `t_min` makes hits at t = 0 count. Faces contain
    their edges and vertices: `all_hits` reports a hit for each face. Rays with NaN, an infinite number or a
    direction of 0 hit nothing. "exact" refuses numbers, except 0, whose absolute value is not between 8e-37
    and 1e36; components of directions may be as small as 2e-49.
    """

    __slots__ = ("_mesh", "_precision", "_threads")

    def __init__(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        precision: str = "exact",
        threads: Optional[int] = None,
    ) -> None:
        if precision not in ("exact", "single"):
            raise ValueError(f'precision: {precision!r} is neither "exact" nor "single"')
        faces = np.asanyarray(faces)
        if faces.size == 0:
            faces = np.zeros((0, 3), np.uint32)
        if faces.ndim != 2 or faces.shape[1] != 3 or faces.dtype.kind not in "iu":
            raise ValueError(f"faces: {faces.dtype} of the shape {faces.shape} instead of integers (m, 3)")
        vertices = _triples("vertices", vertices)
        if faces.size and (faces.min() < 0 or faces.max() >= len(vertices)):
            wrong = int(faces.min() if faces.min() < 0 else faces.max())
            raise ValueError(f"faces {faces.shape} name vertex {wrong}; the vertices are {vertices.shape}")
        self._precision, self._threads = precision, _threads(threads)
        faces = np.require(faces, np.uint32, ["C", "A"])
        self._mesh = core.Mesh(vertices, faces, precision == "exact", self.threads)

    def __reduce__(self) -> tuple:
        return Mesh, (self.vertices, self.faces, self.precision, self.threads)

    def __copy__(self) -> Mesh:
        return self

    def __deepcopy__(self, memo: dict) -> Mesh:
        return self

    def __repr__(self) -> str:
        faces, size = len(self.faces), self._mesh.bytes() / 2**20
        return f"<octray.Mesh: {faces} faces, {self.precision}, {size:.1f} MiB>"

    @property
    def precision(self) -> str:
        """Either "exact" or "single"."""
        return self._precision

    @property
    def threads(self) -> int:
        """Threads of each query."""
        return self._threads

    @property
    def vertices(self) -> NDArray[np.float64]:
        """A copy of the vertices."""
        return self._mesh.vertices()

    @property
    def faces(self) -> NDArray[np.uint32]:
        """A copy of the faces."""
        return self._mesh.faces()

    def closest(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: Optional[ArrayLike] = None,
        t_max: Optional[ArrayLike] = None,
    ) -> Hits:
        """Find the first hit of each ray.

        Parameters
        ----------
        origins, directions : (n, 3) float32 or float64
            Directions have any length, which is the unit of t. C-contiguous arrays are read in place. One of
            the two may be (3,), the same for all.
        t_min, t_max : float or (n,) float, optional
            By default 0 and infinity.

        Returns
        -------
        Hits
            t, primitive, u and v; a miss has t = infinity and primitive = -1.
        """
        return Hits(*self._mesh.closest(_rays(origins, directions, t_min, t_max)))

    def occluded(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: Optional[ArrayLike] = None,
        t_max: Optional[ArrayLike] = None,
    ) -> NDArray[np.bool_]:
        """Test which rays hit anything; parameters as in `closest`."""
        return self._mesh.occluded(_rays(origins, directions, t_min, t_max))

    def all_hits(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: Optional[ArrayLike] = None,
        t_max: Optional[ArrayLike] = None,
        max_hits: Optional[int] = None,
    ) -> AllHits:
        """Find every hit of each ray, in order of t; parameters as in `closest`.

        Parameters
        ----------
        max_hits : int, optional
            The largest number of hits of a ray: further ones are left out.
        """
        most = 2**63 - 1 if max_hits is None else max_hits
        if not 0 <= most < 2**63:
            raise ValueError(f"max_hits: {max_hits} is not between 0 and {2**63 - 1}")
        offsets, hits = self._mesh.all_hits(_rays(origins, directions, t_min, t_max), most)
        return AllHits(offsets, *hits)

    def count(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: Optional[ArrayLike] = None,
        t_max: Optional[ArrayLike] = None,
    ) -> NDArray[np.uint32]:
        """Count how often each ray crosses the surface; parameters as in `closest`.

        In "exact", an edge or a vertex that faces share is crossed once, or as often as the ray passes from
        one side to the other.
        """
        return self._mesh.count(_rays(origins, directions, t_min, t_max))

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Test which points are inside; the mesh must be closed.

        Parameters
        ----------
        points : (n, 3) float32 or float64
            Points with NaN or infinite numbers are outside.
        """
        return self._mesh.contains(_triples("points", points))


class Picture(np.ndarray):
    """A (height, width, 3) array of linear radiance, float32, that notebooks show."""

    def png(self, exposure: float = 0.0) -> bytes:
        """Encode as a PNG file, after multiplication by two to the power of `exposure`."""
        if self.ndim != 3 or self.shape[2] != 3 or not self.size:
            raise ValueError(f"the shape is {self.shape} instead of (height, width, 3)")
        pixels = np.require(np.asarray(self), np.float32, ["C", "A"])
        return core.encode_png(pixels, (self.shape[1], self.shape[0]), exposure)

    def _repr_png_(self) -> Optional[bytes]:
        return self.png() if self.ndim == 3 and self.shape[2] == 3 and self.size else None


def render(
    scene: Union[str, os.PathLike, dict],
    size: Optional[tuple[int, int]] = None,
    samples: int = 16,
    *,
    max_bounces: Optional[int] = None,
    seed: int = 0,
    threads: Optional[int] = None,
    denoise: bool = False,
    folder: Union[str, os.PathLike] = ".",
) -> Picture:
    """Render a scene.

    Parameters
    ----------
    scene : path, str or dict
        A scene file or a model, "builtin:NAME", or what a scene file holds.
    size : (width, height), optional
        In pixels; by default the scene's own, as `max_bounces`.
    samples : int
        Samples of each pixel.
    folder : path
        The folder of the files that a dict names.

    Returns
    -------
    Picture
        (height, width, 3) linear radiance, float32.

    Raises
    ------
    ValueError
        If the scene has a fault. Warnings of the scene are Python's.
    """
    if not 1 <= samples < 2**31:
        raise ValueError(f"samples: {samples} is not between 1 and {2**31 - 1}")
    if size is not None and (len(size) != 2 or not all(1 <= side <= 65535 for side in size)):
        raise ValueError(f"size: {tuple(size)} is not a width and a height from 1 to 65535")
    if isinstance(scene, dict):
        source = (str(Path(folder) / "scene.json"), json.dumps(scene))
    else:
        source = (os.fspath(scene), None)
    method = (seed, _threads(threads), denoise)
    pixels, notes = core.render(source, (size and list(size), samples, max_bounces), method)
    for note in notes:
        warnings.warn(note, stacklevel=2)
    return pixels.view(Picture)
