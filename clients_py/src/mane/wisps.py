"""Wisps of drawn hairs about guides.

Guides are sparse, one or two hundred on a head, so a picture of them alone shows a bald head with
threads. For drawing only, every guide is thickened to a wisp: hair roots are scattered over the
hair region, each takes the nearest guide's curve, displaced by the way from the guide's root to its
own, and the displacement shrinks or grows toward the tip. Nothing of that is simulated.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from mane.mesh import Mesh


@dataclass(frozen=True, eq=False)
class Wisps:
    """Drawn hairs: each a displaced copy of a guide.

    guide: (h,) index of the guide. offset: (h, 3) displacement at the root, head frame [m].
    length: (h,) part of the guide's length that is drawn, 0.75 to 1. tint: (h,) brightness, 0.7
    to 1.25.
    """

    guide: np.ndarray
    offset: np.ndarray
    length: np.ndarray
    tint: np.ndarray

    @staticmethod
    def scatter(mesh: Mesh | None, roots: np.ndarray, hairs: int, seed: int = 1) -> Wisps:
        """About `hairs` hairs for guides with the given roots, (guides, 3) in the head frame [m].

        With a mesh that has a hair region, roots lie evenly on it, and every guide itself is drawn
        too. Without, every guide gets the same number of hairs, within 6 mm of it.
        """
        rng = np.random.default_rng(seed)
        if mesh is None or len(mesh.hair_triangles) == 0:
            guide = np.repeat(np.arange(len(roots)), max(1, round(hairs / len(roots))))
            offset = 0.003 * rng.standard_normal((len(guide), 3)).clip(-2, 2)
        else:
            points = _scatter_on(mesh, hairs, rng)
            distance2 = ((points[:, None] - roots[None]) ** 2).sum(axis=2)
            guide = np.concatenate([np.arange(len(roots)), distance2.argmin(axis=1)])
            offset = np.concatenate(
                [np.zeros((len(roots), 3)), points - roots[guide[len(roots) :]]]
            )
        return Wisps(
            guide, offset, rng.uniform(0.75, 1.0, len(guide)), rng.uniform(0.7, 1.25, len(guide))
        )

    @staticmethod
    def bare(strands: int) -> Wisps:
        """The given strands themselves, whole."""
        return Wisps(np.arange(strands), np.zeros((strands, 3)), np.ones(strands), np.ones(strands))

    def hairs(self, guides: np.ndarray, head: Rotation, tip_part: float) -> np.ndarray:
        """Curves (h, points, 3) for guides (guides, points, 3), both in the world [m].

        tip_part: the displacement at the guide's tip relative to that at the root.
        """
        count = guides.shape[1]
        at = (self.length[:, None] * np.arange(count)).astype(np.float32)  # In points.
        low = np.minimum(at.astype(np.int64), count - 2)
        part = (at - low)[..., None]
        rows = self.guide[:, None]
        curves = (1 - part) * guides[rows, low] + part * guides[rows, low + 1]
        shrink = 1 - (1 - tip_part) * at / (count - 1)
        return curves + shrink[..., None] * head.apply(self.offset)[:, None].astype(np.float32)


def _scatter_on(mesh: Mesh, count: int, rng: np.random.Generator) -> np.ndarray:
    """`count` points spread by area over the hair region, 1 mm above it, (count, 3) [m]."""
    corners = mesh.vertices.astype(np.float64)[mesh.triangles[mesh.hair_triangles]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normal, axis=1)
    which = rng.choice(len(area), count, p=area / area.sum())
    a, b = rng.random((2, count, 1))
    inside = np.where(a + b > 1, 1 - np.stack([a, b]), np.stack([a, b]))
    base, first, second = (corners[which, k] for k in range(3))
    points = base + inside[0] * (first - base) + inside[1] * (second - base)
    return points + 0.001 * normal[which] / area[which, None]
