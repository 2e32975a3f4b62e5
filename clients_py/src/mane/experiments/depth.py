"""How deep points lie in a solid of triangles, measured on the triangles themselves."""

from __future__ import annotations

import numpy as np
import trimesh
from scipy.ndimage import binary_dilation
from scipy.spatial import cKDTree

from mane.mesh import Mesh

REACH_M = 0.01
"""What lies farther from the surface, on either side, is not told: a strand that goes deeper shows
where it enters."""

_APART_M = 0.006  # Of the samples of the surface that find the triangles in question.
_CANDIDATES = 10
_CELL_M = 5e-3
_FACE = 7  # All three corners, see _normals().
_CLEAR_M = 3e-3  # What is so far outside of the nearest sample's plane is told by that plane.


class Solid:
    """A closed mesh. Depths are negative outside, and those beyond `_CLEAR_M` of it estimates.

    lowest_m: least y of its points.
    """

    def __init__(self, mesh: Mesh) -> None:
        points, faces = mesh.vertices.astype(np.float64), mesh.triangles.astype(np.int64)
        fine, fine_faces, self._owners = trimesh.remesh.subdivide_to_size(
            points, faces, _APART_M, return_index=True
        )
        self._middles = fine[fine_faces].mean(axis=1)
        self._samples = cKDTree(self._middles)
        self.lowest_m = float(points[:, 1].min())
        self._corners = points[faces]
        self._low = points.min(axis=0) - 4 * _CELL_M
        cells = np.zeros(((np.ptp(points, axis=0) / _CELL_M).astype(int) + 9).tolist(), bool)
        cells[tuple(((self._middles - self._low) / _CELL_M).astype(int).T)] = True
        self._near_cells = binary_dilation(cells, np.ones((3, 3, 3)), iterations=3)
        self._normals = _normals(points, faces)

    def depths(self, points: np.ndarray) -> np.ndarray:
        """Of points (..., 3) in the mesh's frame: (...) [m]; -REACH_M for what is beyond reach."""
        flat = points.reshape(-1, 3)
        found = np.full(len(flat), -REACH_M)
        cell = ((flat - self._low) / _CELL_M).clip(-1e3, 1e3).astype(int)
        near = np.flatnonzero(((cell >= 0) & (cell < self._near_cells.shape)).all(axis=1))
        near = near[self._near_cells[tuple(cell[near].T)]]
        for some in np.array_split(near, len(near) // 50000 + 1):
            away, nearest = self._samples.query(flat[some], distance_upper_bound=REACH_M + _APART_M)
            reached = np.isfinite(away)
            some, away, nearest = some[reached], away[reached], nearest[reached]
            outward = self._normals[self._owners[nearest], _FACE]
            above = np.einsum("ij,ij->i", flat[some] - self._middles[nearest], outward)
            clear = (above > _CLEAR_M) & (above > 0.3 * away)
            found[some[clear]] = -above[clear]
            if not clear.all():
                found[some[~clear]] = self._near(flat[some[~clear]])
        return np.maximum(found, -REACH_M).reshape(points.shape[:-1])

    def _near(self, points: np.ndarray) -> np.ndarray:
        count = min(_CANDIDATES, len(self._owners))
        _, which = self._samples.query(points, k=count)
        which = self._owners[which.reshape(-1)]
        repeated = np.repeat(points, count, axis=0)
        closest = trimesh.triangles.closest_point(self._corners[which], repeated)
        distance = np.linalg.norm(closest - repeated, axis=1).reshape(-1, count)
        best = np.arange(len(points)) * count + distance.argmin(axis=1)
        which, closest = which[best], closest[best]
        weights = trimesh.triangles.points_to_barycentric(self._corners[which], closest)
        # The corner, side or face on which it lies, as bits: whose weight is not 0.
        feature = (weights > 1e-6) @ np.array([1, 2, 4])
        outward = self._normals[which, feature]
        inside = np.einsum("ij,ij->i", points - closest, outward) < 0
        return np.where(inside, 1, -1) * distance.min(axis=1)


def _normals(points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Outward normals of every feature of every triangle, (triangle, bits of its corners, 3).

    Those of sides and corners are means over their triangles, by angle, which tell inside from
    outside rightly (Baerentzen and Aanaes, 2005).
    """
    mesh = trimesh.Trimesh(points, faces, process=False)
    face = mesh.face_normals
    corner = np.zeros_like(points)
    for k in range(3):
        np.add.at(corner, faces[:, k], mesh.face_angles[:, k, None] * face)
    normals = np.zeros((len(faces), 8, 3))
    normals[:, _FACE] = face
    for k in range(3):
        normals[:, 1 << k] = corner[faces[:, k]]
    side_of = {}
    for a, b in ((0, 1), (1, 2), (2, 0)):
        keys = np.sort(faces[:, [a, b]], axis=1) @ np.array([len(points), 1])
        side_of[(1 << a) | (1 << b)] = keys
    unique, where = np.unique(np.stack(list(side_of.values())), return_inverse=True)
    side = np.zeros((len(unique), 3))
    for row in where.reshape(3, -1):
        np.add.at(side, row, face)
    for bits, row in zip(side_of, where.reshape(3, -1), strict=True):
        normals[:, bits] = side[row]
    return normals
