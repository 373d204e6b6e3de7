"""The ray queries of trimesh: ``mesh.ray = octray.trimesh.RayMeshIntersector(mesh)``."""

from __future__ import annotations

from typing import Any, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import Mesh, _rays, _triples

# The directions of the rays of `contains_points` if the mesh is open: the first is that of trimesh, the second
# decides about points that the first leaves undecided.
_DIRECTIONS = ((0.4395064455, 0.617598629942, 0.652231566745), (0.136962, -0.230213, -0.459027))


class RayMeshIntersector:
    """Answer ray queries about a mesh as trimesh's intersectors do.

    Parameters
    ----------
    geometry : trimesh.Trimesh
        When it changes, the next query builds the hierarchy again.
    scale_to_box : bool
        Without effect: results do not depend on the size of the mesh.
    **options
        `precision` and `threads` of `octray.Mesh`.

    Notes
    -----
    Multiple hits are ordered as by trimesh with Embree: the first hits of all rays, the second ones, and so
    on. Hits of a ray at the same place, as on an edge, are one: their t differs by less than 1e-15 of itself,
    in "single" by 1e-6. In "exact", hits at the origin count.
    """

    def __init__(self, geometry: Any, scale_to_box: bool = True, **options: Any) -> None:
        self.mesh = geometry
        self._options = options
        self._built: Optional[tuple[int, Mesh]] = None

    def _mesh(self) -> Mesh:
        key = hash(self.mesh)
        if self._built is None or self._built[0] != key:
            vertices, faces = self.mesh.vertices.view(np.ndarray), self.mesh.faces.view(np.ndarray)
            self._built = key, Mesh(vertices, faces, **self._options)
        return self._built[1]

    def intersects_first(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> NDArray[np.int32]:
        """Find the first face of each ray, or -1."""
        return self._mesh()._mesh.first(_rays(ray_origins, ray_directions, -1.0))

    def intersects_any(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> NDArray[np.bool_]:
        """Test which rays hit the mesh."""
        return self._mesh().occluded(ray_origins, ray_directions, -1.0)

    def intersects_location(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike, multiple_hits: bool = True
    ) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
        """Find where rays hit: locations, rays and faces."""
        faces, rays, locations = self._hits(ray_origins, ray_directions, multiple_hits, 100)
        return locations, rays, faces

    def intersects_id(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = True,
        max_hits: int = 100,
        return_locations: bool = False,
    ) -> tuple:
        """Find which faces are hit: faces and rays, and locations if `return_locations`."""
        hits = self._hits(ray_origins, ray_directions, multiple_hits, max_hits)
        return hits if return_locations else hits[:2]

    def contains_points(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Test which points are inside.

        If the mesh is not watertight, points inside its bounds are inside if rays along a direction and back
        both cross an odd number of faces. Where only one does and both hit, a second direction decides.
        """
        points = _triples("points", points)
        mesh = self._mesh()
        if self.mesh.is_watertight:
            return mesh.contains(points)
        if len(mesh.faces) == 0:
            return np.zeros(len(points), bool)
        bounds = self.mesh.bounds.tolist()
        verdicts = mesh._mesh.sides(points, _DIRECTIONS[0], bounds)
        undecided = np.flatnonzero(verdicts == 2)
        verdicts[undecided] = mesh._mesh.sides(points[undecided], _DIRECTIONS[1], bounds)
        return verdicts == 1

    def _hits(self, origins: ArrayLike, directions: ArrayLike, multiple: bool, most: int) -> tuple:
        """Find faces, rays and locations of hits, at most so many of each ray."""
        mesh = self._mesh()
        rays = _rays(origins, directions, -1.0)
        if not multiple:
            most = min(most, 1)
        # Two faces that share an edge give its t with different roundings.
        apart = 1e-15 if mesh.precision == "exact" else 1e-6
        return mesh._mesh.hits_by_depth(rays, most, apart)

    def __getstate__(self) -> dict:
        return {**self.__dict__, "_built": None}

    def __copy__(self, *memo: Any) -> RayMeshIntersector:
        return RayMeshIntersector(self.mesh, **self._options)

    __deepcopy__ = __copy__
