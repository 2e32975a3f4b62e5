"""Files of strands: polylines, root first.

.npz    `points` (strand, point, 3); or `points` (all points, 3) and `counts` (strand,)
.json   a list of strands, each a list of [x, y, z]; or an object whose `strands` is one
.csv    a line `strand,x,y,z`, then one line a point; a strand is a run of equal first columns
.hair   Cem Yuksel's HAIR format (cemyuksel.com/research/hairmodels)
.data   USC-HairSalon (Hu, Ma, Luo, Li, SIGGRAPH 2015); entries of one point are no hair
"""

from __future__ import annotations

import csv
import itertools
import json
import os
import zipfile
from pathlib import Path

import numpy as np

from mane.convert import axes_matrix, metres
from mane.errors import InvalidArgument

_HAIR_HEADER = np.dtype(
    [
        ("magic", "S4"), ("strands", "<u4"), ("points", "<u4"), ("arrays", "<u4"),
        ("segments", "<u4"), ("thickness", "<f4"), ("transparency", "<f4"), ("color", "<f4", 3),
        ("info", "S88"),
    ]
)  # fmt: skip
_HAIR_HAS_SEGMENTS, _HAIR_HAS_POINTS = 1, 2  # Bits of `arrays`.


def load_strands(path: str | os.PathLike, unit: str = "m", axes: str = "mane") -> list[np.ndarray]:
    """The strands of a file, each (k, 3) [m] in Mane's axes; the file's ending tells its format.

    Args:
      unit: of the file, a name in `mane.convert.UNITS_M`.
      axes: of the file, a name in `mane.convert.CONVENTIONS`.

    Raises InvalidArgument where the file is not what its ending says.
    """
    path = Path(path)
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise InvalidArgument.of("file", f"{path.name} must end in one of {', '.join(_READERS)}")
    try:
        strands = [np.asarray(strand, np.float64) for strand in reader(path)]
        if not strands or any(s.ndim != 2 or s.shape[1] != 3 for s in strands):
            raise ValueError("it holds no strands of points (x, y, z)")
    except (ValueError, TypeError, KeyError, IndexError, EOFError, zipfile.BadZipFile) as error:
        raise InvalidArgument.of("file", f"{path.name} cannot be read: {error}") from error
    turn = axes_matrix(axes)
    return [metres(strand, unit) @ turn.T for strand in strands]


def thinned(
    strands: list[np.ndarray], most_strands: int = 0, most_points: int = 0
) -> list[np.ndarray]:
    """At most so many strands, evenly out of all, of at most so many points, ends kept; 0: all."""
    if most_strands and len(strands) > most_strands:
        chosen = np.arange(most_strands) * len(strands) // most_strands
        strands = [strands[index] for index in chosen]
    if not most_points:
        return strands
    return [strand[_even(len(strand), max(2, most_points))] for strand in strands]


def _even(count: int, most: int) -> np.ndarray:
    return np.linspace(0, count - 1, min(count, most)).round().astype(int)


def _read_npz(path: Path):
    with np.load(path) as arrays:
        points = arrays["points"]
        if "counts" not in arrays:
            if points.ndim != 3:
                raise ValueError("without `counts`, `points` must be (strand, point, 3)")
            return list(points)
        return _cut(points, arrays["counts"])


def _read_json(path: Path):
    content = json.loads(path.read_text())
    return content["strands"] if isinstance(content, dict) else content


def _read_csv(path: Path):
    with open(path, newline="") as file:
        rows = csv.reader(file)
        head = [cell.strip().lower() for cell in next(rows, [])]
        if head != ["strand", "x", "y", "z"]:
            raise ValueError("the first line must be strand,x,y,z")
        runs = itertools.groupby((row for row in rows if row), key=lambda row: row[0])
        return [[[float(cell) for cell in row[1:]] for row in run] for _, run in runs]


def _read_hair(path: Path):
    data = path.read_bytes()
    if len(data) < _HAIR_HEADER.itemsize or data[:4] != b"HAIR":
        raise ValueError("it does not begin with a HAIR header")
    header = np.frombuffer(data, _HAIR_HEADER, 1)[0]
    begin, strands = _HAIR_HEADER.itemsize, int(header["strands"])
    if not header["arrays"] & _HAIR_HAS_POINTS:
        raise ValueError("it holds no points")
    if header["arrays"] & _HAIR_HAS_SEGMENTS:
        counts = np.frombuffer(data, "<u2", strands, begin).astype(np.int64) + 1
        begin += 2 * strands
    else:
        counts = np.full(strands, int(header["segments"]) + 1)
    points = np.frombuffer(data, "<f4", 3 * int(header["points"]), begin).reshape(-1, 3)
    return _cut(points, counts)


def _read_data(path: Path):
    data, at, strands = path.read_bytes(), 4, []
    for _ in range(np.frombuffer(data, "<i4", 1)[0]):
        count = int(np.frombuffer(data, "<i4", 1, at)[0])
        if count < 0:
            raise ValueError(f"a strand has {count} points")
        points = np.frombuffer(data, "<f4", 3 * count, at + 4).reshape(-1, 3)
        at += 4 + 12 * count
        if count > 1:
            strands.append(points)
    return strands


def _cut(points: np.ndarray, counts: np.ndarray):
    """Points of all strands one after the other, strand by strand."""
    if np.any(counts < 0) or np.sum(counts, dtype=np.int64) != len(points):
        raise ValueError(f"its strands' counts add up to {np.sum(counts)}, not {len(points)}")
    return np.split(points, np.cumsum(counts)[:-1])


_READERS = {
    ".npz": _read_npz,
    ".json": _read_json,
    ".csv": _read_csv,
    ".hair": _read_hair,
    ".data": _read_data,
}
