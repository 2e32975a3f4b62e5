#!/usr/bin/env python3
"""Makes the mannequin head that the package ships: src/mane/data/mannequin.obj.

The surface is the zero set of a signed distance: ellipsoids, capsules and spheres, joined by a
smooth minimum or cut out by a smooth maximum, all listed below in metres in the head frame (Y up,
face toward +Z, origin at the pivot; see mane.mesh). Marching cubes at `GRID_M` turns it into
triangles, quadric decimation leaves `TRIANGLES`, spread where the curvature is, and a relaxation
along the surface evens them out. The distance uses only + - * / sqrt min max, which IEEE
754 rounds exactly, so that the same package versions give the same file on every machine.

Usage: make_mannequin.py [--out FILE.obj]. Needs scikit-image, fast-simplification and trimesh.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import fast_simplification
import numpy as np
import trimesh
from skimage.measure import marching_cubes

from mane.mesh import Mesh, place_head, save_obj, with_hair_region

GRID_M = 0.002
TRIANGLES = 15600
LOW = np.array([0.0, -0.2613, -0.1357])  # Corners of the right half of the sampled box [m].
HIGH = np.array([0.216, 0.1507, 0.1403])
SHIPPED = Path(__file__).resolve().parents[1] / "src" / "mane" / "data" / "mannequin.obj"


def smooth_min(a, b, k):
    """Quadratic smooth minimum: equals min(a, b) where they differ by more than k [m]."""
    h = np.maximum(k - np.abs(a - b), 0.0) / k
    return np.minimum(a, b) - h * h * k * 0.25


def smooth_max(a, b, k):
    return -smooth_min(-a, -b, k)


def ellipsoid(p, center, radii):
    """Bound of the distance to an ellipsoid: f (f - 1) / |grad f| with f = |(p - c) / r|."""
    q = [(p[i] - center[i]) / radii[i] for i in range(3)]
    f = np.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2])
    g = [q[i] / radii[i] for i in range(3)]
    slope = np.sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2])
    return f * (f - 1.0) / np.maximum(slope, 1e-9)


def capsule(p, start, end, radius_start, radius_end):
    """Distance to a segment less a radius that goes linearly from start to end."""
    axis = [end[i] - start[i] for i in range(3)]
    length2 = axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]
    d = [p[i] - start[i] for i in range(3)]
    t = np.clip((d[0] * axis[0] + d[1] * axis[1] + d[2] * axis[2]) / length2, 0.0, 1.0)
    e = [d[i] - t * axis[i] for i in range(3)]
    return np.sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]) - (
        radius_start + t * (radius_end - radius_start)
    )


def skull_and_face(p):
    """Cranium, face, jaw, chin, cheekbones and brow. p[0] is |x|."""
    f = ellipsoid(p, (0, 0.064, 0.0180), (0.0740, 0.079, 0.0950))
    f = smooth_min(f, ellipsoid(p, (0, -0.004, 0.0460), (0.0610, 0.084, 0.0600)), 0.040)
    f = smooth_min(
        f, capsule(p, (0.046, -0.034, 0.020), (0.012, -0.077, 0.078), 0.010, 0.010), 0.040
    )
    f = smooth_min(f, ellipsoid(p, (0, -0.078, 0.0930), (0.0150, 0.014, 0.0140)), 0.022)
    f = smooth_min(f, ellipsoid(p, (0.040, 0.002, 0.0780), (0.0180, 0.016, 0.0180)), 0.030)
    return smooth_min(f, ellipsoid(p, (0.018, 0.0460, 0.0960), (0.0280, 0.009, 0.0110)), 0.026)


def eyes(p, f):
    """Sockets cut out, closed lids put in, the line between the lids as a fine groove."""
    f = smooth_max(f, -ellipsoid(p, (0.0310, 0.0270, 0.1200), (0.0170, 0.0110, 0.0160)), 0.018)
    f = smooth_min(f, ellipsoid(p, (0.0315, 0.0250, 0.0935), (0.0155, 0.0115, 0.0135)), 0.005)
    return smooth_max(
        f, -capsule(p, (0.0190, 0.0195, 0.1065), (0.0440, 0.0195, 0.1020), 0.0020, 0.0020), 0.003
    )


def nose(p, f):
    """Bridge, tip, wings and nostrils."""
    f = smooth_min(f, capsule(p, (0, 0.0400, 0.1060), (0, -0.0100, 0.1220), 0.0055, 0.0085), 0.014)
    f = smooth_min(f, ellipsoid(p, (0.0105, -0.0140, 0.1120), (0.0070, 0.0065, 0.0100)), 0.007)
    return smooth_max(f, -ellipsoid(p, (0.0060, -0.0215, 0.1160), (0.0030, 0.0035, 0.0055)), 0.003)


def mouth(p, f):
    """The rounding over the teeth and two lips that meet in a crease."""
    f = smooth_min(f, ellipsoid(p, (0, -0.0420, 0.0900), (0.0290, 0.0220, 0.0190)), 0.020)
    upper = ellipsoid(p, (0, -0.0366, 0.1052), (0.0245, 0.0068, 0.0105))
    lower = ellipsoid(p, (0, -0.0498, 0.1040), (0.0210, 0.0076, 0.0110))
    return smooth_min(smooth_min(f, upper, 0.003), lower, 0.0025)


def ears(p, f):
    """A disc, flared and leaning back, with a rim, hollowed from outside."""
    # Axes of the ear: out (its normal), along (toward the face), up.
    x, y, z = p[0] - 0.0755, p[1] - 0.0130, p[2] + 0.0010
    out, along = 0.94 * x + 0.34 * z, 0.94 * z - 0.34 * x  # Flared 20 degrees.
    up, along = 0.97 * y - 0.24 * along, 0.24 * y + 0.97 * along  # Leaning back 14 degrees.
    q = (out, up, along)
    ear = ellipsoid(q, (0, 0.004, 0), (0.0060, 0.0270, 0.0175))
    ear = smooth_min(ear, ellipsoid(q, (0, -0.020, 0.005), (0.0048, 0.0110, 0.0085)), 0.008)
    ear = smooth_max(ear, -ellipsoid(q, (0.0085, 0.0040, 0.0010), (0.0080, 0.0210, 0.0120)), 0.004)
    ear = smooth_min(ear, ellipsoid(q, (0.0005, 0.0010, -0.0030), (0.0045, 0.0130, 0.0040)), 0.006)
    ear = smooth_min(ear, ellipsoid(q, (0.0010, -0.0020, 0.0135), (0.0045, 0.0060, 0.0035)), 0.004)
    return smooth_min(f, ear, 0.006)


def neck_and_shoulders(p, f):
    """A neck behind the jaw, sloping shoulders and chest, cut flat below."""
    neck = capsule(p, (0, -0.010, -0.004), (0, -0.180, -0.024), 0.0450, 0.0530)
    trapezius = capsule(p, (0.020, -0.080, -0.032), (0.130, -0.180, -0.032), 0.0120, 0.0200)
    shoulder = capsule(p, (0.040, -0.245, -0.020), (0.158, -0.205, -0.028), 0.0700, 0.0460)
    chest = ellipsoid(p, (0, -0.280, -0.010), (0.1450, 0.1150, 0.0850))
    torso = smooth_min(smooth_min(chest, shoulder, 0.05), trapezius, 0.06)
    f = smooth_min(smooth_min(f, neck, 0.020), torso, 0.040)
    return smooth_max(f, -(p[1] + 0.250), 0.006)


def distance(points):
    """Approximate signed distance [m] of points (..., 3); negative inside, symmetric in x."""
    p = (np.abs(points[..., 0]), points[..., 1], points[..., 2])
    f = ears(p, mouth(p, nose(p, eyes(p, skull_and_face(p)))))
    return neck_and_shoulders(p, f)


def gradient(points, h=1e-5):
    steps = h * np.eye(3)
    return np.stack([(distance(points + s) - distance(points - s)) / (2 * h) for s in steps], -1)


def make_mannequin() -> Mesh:
    axes = [LOW[i] + GRID_M * np.arange(round((HIGH[i] - LOW[i]) / GRID_M) + 1) for i in range(3)]
    half = np.stack(
        [distance(np.stack(np.meshgrid(x, *axes[1:], indexing="ij"), -1))[0] for x in axes[0]]
    )
    field = np.concatenate([half[:0:-1], half])
    # The default direction of the gradient winds triangles counter-clockwise seen from outside.
    points, triangles, _, _ = marching_cubes(field, 0.0, spacing=(GRID_M,) * 3)
    points = points + np.array([-HIGH[0], LOW[1], LOW[2]])
    points, triangles = fast_simplification.simplify(
        points.astype(np.float32), triangles.astype(np.int32), target_count=TRIANGLES, agg=5
    )
    points = relax(points.astype(np.float64), triangles)
    solid = trimesh.Trimesh(points, triangles, process=False)
    if not (solid.is_watertight and solid.is_winding_consistent and solid.volume > 0):
        raise RuntimeError(
            "the decimated surface is not closed: change TRIANGLES or GRID_M a little"
        )
    return with_hair_region(place_head(Mesh(points, triangles)))


def relax(points, triangles, rounds=4):
    """Evens out the triangles: vertices go toward their neighbours' mean, along the surface."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    degree = np.bincount(edges[:, 0], minlength=len(points))[:, None]
    for _ in range(rounds):
        total = np.zeros_like(points)
        np.add.at(total, edges[:, 0], points[edges[:, 1]])
        move = 0.5 * (total / degree - points)
        slope = gradient(points)
        norm2 = np.maximum((slope * slope).sum(axis=1, keepdims=True), 0.25)
        move -= (move * slope).sum(axis=1, keepdims=True) * slope / norm2
        points = points + move
        slope = gradient(points)
        norm2 = np.maximum((slope * slope).sum(axis=1, keepdims=True), 0.25)
        points -= np.clip(distance(points)[:, None] * slope / norm2, -0.001, 0.001)
    return points


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=SHIPPED, help="where to write (%(default)s)")
    out = parser.parse_args().out
    mesh = make_mannequin()
    save_obj(
        out,
        mesh,
        "Mannequin head of the Mane project, made by tools/make_mannequin.py.\n"
        "Metres, Y up, face toward +Z, origin at the pivot of the head on the neck.",
    )
    print(
        f"{out}: {len(mesh.vertices)} vertices, {len(mesh.triangles)} triangles, "
        f"{len(mesh.hair_triangles)} of them grow hair"
    )


if __name__ == "__main__":
    main()
