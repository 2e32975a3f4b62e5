"""Head meshes: reading, cutting, the head frame, and where hair grows.

All lengths are metres. The head frame is right-handed with Y up and the face toward +Z; its origin
is the pivot of the head on the neck, on the mid plane, `PIVOT_BELOW_EARS_M` below the widest points
of the ears. `load_head` goes from a file of a whole body to a bust in that frame; `mannequin` reads
the head that this package ships, which is in that frame already.
"""

from __future__ import annotations

import io
import os
import warnings
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from mane.errors import InvalidArgument

PIVOT_BELOW_EARS_M = 0.02
"""Height of the ears' widest points above the origin of the head frame [m]."""

HAIR_GROUP = "hair"
"""OBJ group whose triangles grow hair."""

_EAR_DEPTH_M = 0.005

# The hairline as (azimuth [deg], height). Azimuth turns about the vertical axis through the middle
# between the ears, 0 in front, 180 at the nape, the same on both sides. Height is measured from the
# ears' widest points, in units of the distance from there to the top of the head (about 0.125 m):
# level across the forehead, falling at the temples, passing above the ears, falling behind them to
# the nape.
_HAIRLINE = np.array(
    [
        (0, 0.68),
        (25, 0.68),
        (38, 0.62),
        (50, 0.46),
        (62, 0.30),
        (72, 0.25),
        (96, 0.25),
        (106, 0.12),
        (116, -0.12),
        (130, -0.32),
        (150, -0.40),
        (180, -0.42),
    ]
)


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles in the head frame.

    vertices: float32 (n, 3) [m]. triangles: uint32 (m, 3), vertex indices, counter-clockwise seen
    from outside. hair_triangles: uint32 (k,), indices of the triangles that grow hair; empty when
    no region has been chosen.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    hair_triangles: np.ndarray = field(default_factory=lambda: np.zeros(0, np.uint32))

    def __post_init__(self) -> None:
        vertices = np.ascontiguousarray(self.vertices, np.float32).reshape(-1, 3)
        triangles = np.ascontiguousarray(self.triangles, np.int64).reshape(-1, 3)
        hair = np.ascontiguousarray(self.hair_triangles, np.int64).reshape(-1)
        if not np.isfinite(vertices).all():
            bad = int(np.argmin(np.isfinite(vertices).all(axis=1)))
            raise InvalidArgument.of(
                f"vertices[{bad}]", f"is {vertices[bad].tolist()}, must be finite numbers"
            )
        _check_indices("triangles", triangles, len(vertices))
        _check_indices("hair_triangles", hair, len(triangles))
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "triangles", triangles.astype(np.uint32))
        object.__setattr__(self, "hair_triangles", hair.astype(np.uint32))

    def vertex_normals(self) -> np.ndarray:
        """Outward unit normals, float64 (n, 3): area-weighted means over the adjacent triangles."""
        corners = self.vertices.astype(np.float64)[self.triangles]
        face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals = np.zeros((len(self.vertices), 3))
        for corner in range(3):
            np.add.at(normals, self.triangles[:, corner], face)
        return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)

    def is_closed(self) -> bool:
        """Whether every edge joins two triangles that are wound alike, so that nothing is open."""
        t = self.triangles.astype(np.int64)
        start, end = t.ravel(), np.roll(t, -1, axis=1).ravel()
        count = len(self.vertices)
        forth, back = np.sort(start * count + end), np.sort(end * count + start)
        return np.array_equal(forth, back) and len(np.unique(forth)) == len(forth)


def load_obj(
    path: str | os.PathLike, group: str | Sequence[str] | None = None, unit_m: float = 1.0
) -> Mesh:
    """Reads a Wavefront OBJ file, as it lies in the file.

    group: the name, or names, of the `g` groups to take; None takes the whole file. unit_m: length
    of the file's unit [m], in (0, 1000]. Polygons are cut into triangles; vertices at exactly the
    same place become one. Triangles of a group named `hair` become `hair_triangles`.

    Raises FileNotFoundError; InvalidArgument for an unreadable file, an unknown group, bad numbers.
    """
    if not 0 < unit_m <= 1000:
        raise InvalidArgument.of("unit_m", f"is {unit_m}, must be a length in (0, 1000] m")
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such file")
    parts = _read_groups(path)
    if group is not None:
        wanted = [group] if isinstance(group, str) else list(group)
        for name in wanted:
            if name not in parts:
                known = ", ".join(sorted(parts)[:12])
                raise InvalidArgument.of("group", f"is {name!r}, must be one of {known} in {path}")
        parts = {name: parts[name] for name in wanted}
    points = np.concatenate([part.vertices for part in parts.values()])
    offsets = np.cumsum([0] + [len(part.vertices) for part in parts.values()])
    triangles = np.concatenate(
        [p.faces + o for p, o in zip(parts.values(), offsets[:-1], strict=True)]
    )
    is_hair = np.repeat(
        [name == HAIR_GROUP for name in parts], [len(p.faces) for p in parts.values()]
    )
    points, triangles = _weld(np.asarray(points, np.float64) * unit_m, triangles)
    try:
        return Mesh(points, triangles, np.flatnonzero(is_hair))
    except InvalidArgument as error:
        raise InvalidArgument(f"{path}: {error}", error.field_violations) from None


def save_obj(path: str | os.PathLike, mesh: Mesh, comment: str = "") -> None:
    """Writes an OBJ file with the groups `hair` and `skin`, in metres, to the micrometre."""
    lines = [f"# {line}" for line in comment.splitlines()]
    lines += [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in mesh.vertices]
    hair = np.zeros(len(mesh.triangles), bool)
    hair[mesh.hair_triangles] = True
    for name, chosen in ((HAIR_GROUP, hair), ("skin", ~hair)):
        lines.append(f"g {name}")
        lines += [f"f {a} {b} {c}" for a, b, c in mesh.triangles[chosen].astype(np.int64) + 1]
    Path(path).write_text("\n".join(lines) + "\n", encoding="ascii")


def load_head(
    path: str | os.PathLike, group: str | Sequence[str] | None = None, unit_m: float = 1.0
) -> Mesh:
    """Reads a head or a whole body (Y up, face toward +Z) and makes a bust of it, ready for hair.

    Places the head frame, cuts head, neck and shoulders out, and chooses the hair region, unless
    the file has a group `hair`. Raises what `load_obj` and `place_head` raise.
    """
    mesh = cut_bust(place_head(load_obj(path, group, unit_m)))
    return mesh if len(mesh.hair_triangles) else with_hair_region(mesh)


def mannequin() -> Mesh:
    """The head that this package ships: head, neck and shoulders, with its hair region."""
    with resources.as_file(resources.files("mane") / "data" / "mannequin.obj") as path:
        return load_obj(path)


def place_head(mesh: Mesh) -> Mesh:
    """Moves a mesh (Y up, face toward +Z, any origin) so that its origin is the head's pivot.

    The pivot follows from the ears: what is within 5 mm of the widest points between 0.08 and
    0.20 m below the top.
    Raises InvalidArgument when there is nothing there, or its width is not that of a head.
    """
    y = mesh.vertices[:, 1]
    depth = y.max() - y
    band = mesh.vertices[(depth > 0.08) & (depth < 0.20)].astype(np.float64)
    width = np.ptp(band[:, 0]) if len(band) else 0.0
    if not 0.10 <= width <= 0.30:
        raise InvalidArgument.of(
            "mesh",
            f"is {width:.3g} m wide between 0.08 and 0.20 m below its top, must be a head, "
            "0.10 to 0.30 m wide (check the unit, that Y is up, and that the group is the skin)",
        )
    left = band[band[:, 0] > band[:, 0].max() - _EAR_DEPTH_M].mean(axis=0)
    right = band[band[:, 0] < band[:, 0].min() + _EAR_DEPTH_M].mean(axis=0)
    pivot = (left + right) / 2 - (0, PIVOT_BELOW_EARS_M, 0)
    return Mesh(mesh.vertices - pivot, mesh.triangles, mesh.hair_triangles)


def cut_bust(mesh: Mesh, height_m: float = 0.37, half_width_m: float = 0.195) -> Mesh:
    """Keeps what is at most `height_m` below the top and within `half_width_m` of the mid plane.

    As `cut` does it. A mesh that is small enough comes back as it is.
    """
    bottom = float(mesh.vertices[:, 1].max()) - height_m
    if mesh.vertices[:, 1].min() >= bottom and np.abs(mesh.vertices[:, 0]).max() <= half_width_m:
        return mesh
    left, right = (half_width_m, 0, 0), (-half_width_m, 0, 0)
    planes = ((0, 1, 0), (0, bottom, 0)), ((-1, 0, 0), left), ((1, 0, 0), right)
    return cut(mesh, planes)


def cut(mesh: Mesh, planes: Iterable[tuple[ArrayLike, ArrayLike]]) -> Mesh:
    """Keeps what lies on the side of the normal of every plane: (normal, a point of it), each (3,).

    Triangles across a plane are cut, and every opening is closed by a fan about its middle, so that
    a closed mesh stays closed. Triangles that grow hair are kept whole. Raises InvalidArgument when
    nothing is left.
    """
    grows = np.zeros(len(mesh.triangles), bool)
    grows[mesh.hair_triangles] = True
    hair, rest = mesh.triangles[grows].astype(np.int64), mesh.triangles[~grows].astype(np.int64)
    points = mesh.vertices
    for normal, origin in planes:
        points, hair, rest = _cut(
            points, hair, rest, np.array(normal, float), np.array(origin, float)
        )
    used, triangles = np.unique(np.concatenate([hair, rest]), return_inverse=True)
    return Mesh(points[used], triangles.reshape(-1, 3), np.arange(len(hair)))


def hair_region(mesh: Mesh) -> np.ndarray:
    """Triangles that grow hair on a head in the head frame: uint32 (k,), ascending.

    A triangle grows hair when its centre is above the hairline (forehead, temples, above and behind
    the ears, nape; never face, ears or neck) and is not on an ear: ears stand out by more than 2 %
    from the skull's half width, measured 0.3 to 0.5 of the way from the ears to the top.
    """
    vertices = mesh.vertices.astype(np.float64)
    height_unit = vertices[:, 1].max() - PIVOT_BELOW_EARS_M
    level = (vertices[:, 1] - PIVOT_BELOW_EARS_M) / height_unit
    skull = vertices[(level > 0.3) & (level < 0.5)]
    if height_unit <= 0 or len(skull) == 0:
        raise InvalidArgument.of("mesh", "has no skull above the ears, must be a head in its frame")
    centers = vertices[mesh.triangles].mean(axis=1)
    azimuth = np.degrees(np.arctan2(np.abs(centers[:, 0]), centers[:, 2]))
    hairline = np.interp(azimuth, _HAIRLINE[:, 0], _HAIRLINE[:, 1])
    above = (centers[:, 1] - PIVOT_BELOW_EARS_M) / height_unit > hairline
    on_ear = np.abs(centers[:, 0]) > 1.02 * np.abs(skull[:, 0]).max()
    return np.flatnonzero(above & ~on_ear).astype(np.uint32)


def with_hair_region(mesh: Mesh) -> Mesh:
    """The mesh with `hair_triangles` chosen by `hair_region`."""
    return Mesh(mesh.vertices, mesh.triangles, hair_region(mesh))


def _check_indices(name: str, indices: np.ndarray, count: int) -> None:
    wrong = (indices < 0) | (indices >= count)
    if wrong.any():
        bad = int(np.argwhere(wrong)[0, 0])
        raise InvalidArgument.of(
            f"{name}[{bad}]", f"is {indices[bad].tolist()}, must be indices below {count}"
        )


def _read_groups(path: Path) -> dict:
    import trimesh  # Slow to import, and only who reads or cuts meshes needs it.

    text = _read_text(path)
    try:
        with warnings.catch_warnings():
            # The parser averages texture coordinates, which may be missing and are not used here.
            warnings.simplefilter("ignore", RuntimeWarning)
            loaded = trimesh.load_scene(
                io.BytesIO(text.encode()),
                file_type="obj",
                process=False,
                maintain_order=True,
                skip_materials=True,
                split_groups=True,
            )
    except Exception as error:  # The parser raises whatever its arrays raise.
        raise InvalidArgument.of(
            str(path), f"is not a readable OBJ file: {_first_fault(text) or repr(error)}"
        ) from error
    if any(np.shape(part.vertices)[1:] != (3,) for part in loaded.geometry.values()):
        fault = _first_fault(text) or "vertices need three coordinates"
        raise InvalidArgument.of(str(path), f"is not a readable OBJ file: {fault}")
    parts = {
        name: part
        for name, part in loaded.geometry.items()
        if isinstance(part, trimesh.Trimesh) and len(part.faces)
    }
    if not parts:
        raise InvalidArgument.of(str(path), "has no triangles, must have some")
    return parts


def _read_text(path: Path) -> str:
    content = path.read_bytes()
    if b"\0" in content:
        raise InvalidArgument.of(str(path), "is not an OBJ file: it is binary, not text")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("latin-1")  # Names and comments of older programs.


def _first_fault(text: str) -> str | None:
    """What is wrong with the first line of an OBJ file that cannot be right, if any is."""
    vertices = [line for line in text.splitlines() if line.startswith(("v ", "v\t"))]
    before = 0
    for number, line in enumerate(text.splitlines(), 1):
        kind, *values = line.split("#")[0].split() or ("",)
        before += kind == "v"
        try:
            if kind == "v":
                if len([float(value) for value in values]) < 3:
                    return f"line {number} has {len(values)} coordinates, must have 3"
            elif kind == "f":
                for index in (int(value.split("/")[0]) for value in values):
                    if not (1 <= index <= len(vertices) or -before <= index <= -1):
                        return f"line {number} names vertex {index}; there are {len(vertices)}"
        except ValueError:
            return f"line {number} is {line[:60]!r}, must hold numbers"
    return None


def _weld(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Makes vertices at the same place one, in the order of their first appearance."""
    _, first, inverse = np.unique(points, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    return points[first[order]], rank[inverse.reshape(-1)][triangles]


def _cut(points, hair, rest, normal, origin) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cuts the triangles `rest` at a plane, keeps the side of the normal, closes the openings."""
    from trimesh.intersections import slice_faces_plane

    cut_points, cut, _ = slice_faces_plane(points.astype(np.float64), rest, normal, origin)
    if len(cut) == 0:
        raise InvalidArgument.of(
            "mesh", f"has nothing on the side {normal} of {origin}, must reach there"
        )
    points, triangles = _weld(
        np.concatenate([points, cut_points.astype(np.float32)]),
        np.concatenate([hair, cut + len(points)]),
    )
    points, caps = _caps(points, triangles, np.abs((points - origin) @ normal) < 1e-5)
    return points, triangles[: len(hair)], np.concatenate([triangles[len(hair) :], caps])


def _caps(points, triangles, on_cut) -> tuple[np.ndarray, np.ndarray]:
    """Closes the loops of open edges between vertices `on_cut`: points with a new one in the middle
    of each loop, and the triangles of the fans about them."""
    count = len(points)
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    edges = edges[on_cut[edges].all(axis=1)]
    is_open = ~np.isin(edges[:, 0] * count + edges[:, 1], edges[:, 1] * count + edges[:, 0])
    start, end = edges[is_open].T
    links = coo_matrix((np.ones(len(start)), (start, end)), (count, count))
    _, label = connected_components(links, directed=False)
    loops, loop = np.unique(label[start], return_inverse=True)
    middles = [points[start[loop == i]].mean(axis=0) for i in range(len(loops))]
    points = np.concatenate([points, np.array(middles, np.float32).reshape(-1, 3)])
    return points, np.stack([end, start, count + loop], axis=1)
