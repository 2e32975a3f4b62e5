"""A z-buffer in numpy: triangles and polylines become pixels, nearest wins.

Pictures of hair are tens of thousands of thin segments between and behind a few thousand triangles.
`ZBuffer` draws both in one depth order without a graphics card, window system or driver. It samples
on a grid `SUPERSAMPLING` times finer than the image and averages, which smooths edges and makes a
line of one fine pixel a hair of half a pixel.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

SUPERSAMPLING = 2
_NEAR_M = 0.02  # Nothing closer to the eye is drawn [m].
_POINTS_AT_A_TIME = 1 << 15  # So that what is between fits into caches.


@dataclass(frozen=True)
class Camera:
    """A perspective camera. eye, target: (3,) world [m]; Y is up in the picture.

    view_height_m: height of what is seen at the target's distance [m].
    """

    eye: np.ndarray
    target: np.ndarray
    view_height_m: float

    def axes(self) -> np.ndarray:
        """Rows right, up, backward, as (3, 3)."""
        back = np.asarray(self.eye, float) - self.target
        back /= np.linalg.norm(back)
        right = np.cross((0.0, 1.0, 0.0), back)
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(back, right), back])

    def project(self, points: np.ndarray, width: int, height: int) -> np.ndarray:
        """(..., 3) world [m] to (..., 3): x right, y down [pixels], depth from the eye [m]."""
        seen = (points - np.asarray(self.eye)) @ self.axes().T
        depth = np.maximum(-seen[..., 2], 1e-6)
        scale = (
            height / self.view_height_m * np.linalg.norm(np.asarray(self.eye) - self.target) / depth
        )
        return np.stack(
            [width / 2 + scale * seen[..., 0], height / 2 - scale * seen[..., 1], -seen[..., 2]], -1
        )


class ZBuffer:
    """A picture being drawn: `width` x `height` pixels, colours linear in [0, 1]."""

    def __init__(self, width: int, height: int, camera: Camera, background: np.ndarray) -> None:
        """background: (height, width, 3) or anything that broadcasts to it."""
        self._shape = (height * SUPERSAMPLING, width * SUPERSAMPLING)
        self._camera = camera
        fine = np.broadcast_to(np.asarray(background, np.float32), (height, width, 3))
        fine = fine.repeat(SUPERSAMPLING, 0).repeat(SUPERSAMPLING, 1)
        self._color = np.ascontiguousarray(fine).reshape(-1, 3)
        self._depth = np.full(self._shape[0] * self._shape[1], np.inf, np.float32)

    def triangles(
        self, points: np.ndarray, triangles: np.ndarray, colors: np.ndarray, back: float = 0.0
    ) -> None:
        """Draws triangles. points, colors: (n, 3); triangles: (m, 3) indices.

        Counter-clockwise ones face the eye. The others show their inside: their colours times
        `back`, or nothing where that is 0.
        """
        corners = self._project(points)[triangles]
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = corners.transpose(1, 2, 0)
        aw, bw, cw = (_order(z) for z in (az, bz, cz))
        area = (bx - ax) * (cy - ay) - (by - ay) * (
            cx - ax
        )  # Negative: facing the eye, as y is down.
        keep = (area < -1e-6) | ((area > 1e-6) & (back > 0))
        keep &= np.minimum(np.minimum(az, bz), cz) > _NEAR_M
        kept = np.flatnonzero(keep)
        which, x, y = self._pixels_in_boxes(
            np.minimum(np.minimum(ax, bx), cx)[kept],
            np.maximum(np.maximum(ax, bx), cx)[kept],
            np.minimum(np.minimum(ay, by), cy)[kept],
            np.maximum(np.maximum(ay, by), cy)[kept],
        )
        # The barycentric weights of b and c are linear in the pixel: k + kx x + ky y.
        inverse = 1 / area[kept]
        to_b = _plane(cx - ax, cy - ay, ax, ay, kept, -inverse)
        to_c = _plane(bx - ax, by - ay, ax, ay, kept, inverse)
        fx, fy = x.astype(np.float32), y.astype(np.float32)
        weight_b = to_b[0][which] + to_b[1][which] * fx + to_b[2][which] * fy
        weight_c = to_c[0][which] + to_c[1][which] * fx + to_c[2][which] * fy
        inside = np.flatnonzero((weight_b >= 0) & (weight_c >= 0) & (weight_b + weight_c <= 1))
        which, weight_b, weight_c = kept[which[inside]], weight_b[inside], weight_c[inside]
        depth = aw[which] + weight_b * (bw - aw)[which] + weight_c * (cw - aw)[which]
        pixel, won = self._nearest(x[inside], y[inside], depth)
        which, wb, wc = which[won], weight_b[won, None], weight_c[won, None]
        a, b, c = (colors.astype(np.float32)[triangles[which, k]] for k in range(3))
        shown = np.where(area[which] < 0, 1, back).astype(np.float32)[:, None]
        self._color[pixel] = shown * ((1 - wb - wc) * a + wb * b + wc * c)

    def lines(self, points: np.ndarray, colors: np.ndarray) -> None:
        """Draws polylines one fine pixel wide. points, colors: (lines, points on each, 3)."""
        some = max(1, _POINTS_AT_A_TIME // points.shape[1])
        for first in range(0, len(points), some):
            self._lines(points[first : first + some], colors[first : first + some])

    def image(self) -> np.ndarray:
        """The picture as uint8 (height, width, 3), sRGB."""
        height, width = self._shape[0] // SUPERSAMPLING, self._shape[1] // SUPERSAMPLING
        fine = self._color.reshape(height, SUPERSAMPLING, width, SUPERSAMPLING, 3)
        cells = [fine[:, i, :, j] for i in range(SUPERSAMPLING) for j in range(SUPERSAMPLING)]
        mean = np.clip(sum(cells) / len(cells), 0, 1)
        return (255 * mean ** np.float32(1 / 2.2) + np.float32(0.5)).astype(np.uint8)

    def _lines(self, points: np.ndarray, colors: np.ndarray) -> None:
        x, y, z = np.ascontiguousarray(self._project(points).transpose(2, 0, 1))
        start = np.arange(x.size).reshape(x.shape)[:, :-1].ravel()
        x, y, z, colors = x.ravel(), y.ravel(), z.ravel(), colors.reshape(-1, 3).astype(np.float32)
        start = start[self._may_show(x, y, z, start, start + 1)]
        w = _order(z)
        dx, dy, dw = (v[start + 1] - v[start] for v in (x, y, w))
        counts = np.maximum(np.abs(dx), np.abs(dy)).astype(np.int32) + 1
        which, step = _spread(counts)
        t = (step.astype(np.float32) + np.float32(0.5)) / counts[which].astype(np.float32)
        at = start[which]
        px, py = x[at] + t * dx[which], y[at] + t * dy[which]
        on = np.flatnonzero((px >= 0) & (px < self._shape[1]) & (py >= 0) & (py < self._shape[0]))
        at, t = at[on], t[on]
        pixel, won = self._nearest(
            px[on].astype(np.int32), py[on].astype(np.int32), w[at] + t * dw[which[on]]
        )
        at, t = at[won], t[won, None]
        self._color[pixel] = (1 - t) * colors[at] + t * colors[at + 1]

    def _project(self, points: np.ndarray) -> np.ndarray:
        return self._camera.project(points, self._shape[1], self._shape[0]).astype(np.float32)

    def _may_show(self, x, y, z, a, b) -> np.ndarray:
        """Whether the segments from points a to points b can reach the picture."""
        return (
            (np.minimum(z[a], z[b]) > _NEAR_M)
            & (np.maximum(x[a], x[b]) >= 0)
            & (np.minimum(x[a], x[b]) < self._shape[1])
            & (np.maximum(y[a], y[b]) >= 0)
            & (np.minimum(y[a], y[b]) < self._shape[0])
        )

    def _pixels_in_boxes(self, x0, x1, y0, y1) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The pixels whose centres are in boxes: index of the box, x and y of the pixel."""
        left, right = (
            np.clip(np.ceil(v - 0.5), 0, self._shape[1]).astype(np.int32) for v in (x0, x1)
        )
        top, bottom = (
            np.clip(np.ceil(v - 0.5), 0, self._shape[0]).astype(np.int32) for v in (y0, y1)
        )
        width = right - left
        which, offset = _spread(width * (bottom - top))
        row = offset // width[which]
        return which, left[which] + offset - row * width[which], top[which] + row

    def _nearest(self, x, y, depth) -> tuple[np.ndarray, np.ndarray]:
        """Enters samples: the pixels that change, and the index of the sample that each shows."""
        pixel, depth = y * np.int32(self._shape[1]) + x, depth.astype(np.float32, copy=False)
        near = np.flatnonzero(depth < self._depth[pixel])
        pixel, depth = pixel[near], depth[near]
        np.minimum.at(self._depth, pixel, depth)
        won = np.flatnonzero(depth == self._depth[pixel])
        return pixel[won], near[won]


def _order(z: np.ndarray) -> np.ndarray:
    """What is compared in place of the depth z: grows with it, and is linear in the picture."""
    return -1 / np.maximum(z, np.float32(_NEAR_M))


def _plane(ux, uy, ax, ay, kept, scale) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Coefficients (k, kx, ky) of scale (u x (p - a)) at the pixel centre p = (x, y) + 1/2."""
    kx, ky = -uy[kept] * scale, ux[kept] * scale
    return kx * (0.5 - ax[kept]) + ky * (0.5 - ay[kept]), kx, ky


def _spread(counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Each index i repeated counts[i] times, and the position 0 .. counts[i]-1 in its run."""
    which = np.repeat(np.arange(len(counts), dtype=np.int32), counts)
    starts = (np.cumsum(counts) - counts).astype(np.int32)
    return which, np.arange(len(which), dtype=np.int32) - starts[which]
