"""Recorded or computed head motion, and the files it comes from.

A `Motion` is a track of head poses in Mane's axes: metres, right-handed, Y up, an upright head that
looks toward +Z has the identity orientation. `mane.convert` brings other conventions here.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation, Slerp

from mane import bvh, convert
from mane.errors import InvalidArgument
from mane.pose import IDENTITY, Pose

CSV_COLUMNS = ("time_s", "x", "y", "z", "qx", "qy", "qz", "qw")


@dataclass(frozen=True, eq=False)
class Motion:
    """Timed head poses, at least one.

    Attributes:
      times_s: increasing, (k,) float64 [s].
      positions: origin of the head frame in the world, (k, 3) float64 [m]; the world's origin
        where not given.
      orientations: rotations head -> world, quaternions (x, y, z, w), (k, 4) float64, of norm one;
        the identity where not given. Given norms within 1 % of one are normalised.
      bodies: motions of the groom's moving bodies by name, body -> world, at the same times. Files
        do not hold them.

    Raises InvalidArgument for shapes that do not fit, non-finite numbers, times that do not
    increase and quaternions that are not of norm one.
    """

    times_s: ArrayLike
    positions: ArrayLike | None = None
    orientations: ArrayLike | None = None
    bodies: Mapping[str, Motion] = field(default_factory=dict)

    def __post_init__(self):
        times = np.array(self.times_s, dtype=np.float64)
        if times.ndim != 1 or times.size == 0:
            raise InvalidArgument.of("times_s", f"has shape {times.shape}, must be (k,), k >= 1")
        positions = _rows("positions", self.positions, times.size, (0.0, 0.0, 0.0))
        orientations = _rows("orientations", self.orientations, times.size, IDENTITY)
        _require_finite("times_s", times)
        steps = np.diff(times)
        if np.any(steps <= 0):
            k = int(np.argmax(steps <= 0)) + 1
            raise InvalidArgument.of(
                f"times_s[{k}]", f"is {times[k]}, must be greater than {times[k - 1]} before it"
            )
        for name, motion in self.bodies.items():
            if not np.array_equal(motion.times_s, times):
                raise InvalidArgument.of(
                    f"bodies[{name!r}].times_s", "must hold the same times as the head's"
                )
        object.__setattr__(self, "bodies", dict(self.bodies))
        object.__setattr__(self, "times_s", times)
        object.__setattr__(self, "positions", positions)
        object.__setattr__(self, "orientations", _normalised("orientations", orientations))

    def __len__(self) -> int:
        return self.times_s.size

    @property
    def duration_s(self) -> float:
        """Time from the first pose to the last [s]."""
        return float(self.times_s[-1] - self.times_s[0])

    def poses(self) -> Iterator[Pose]:
        """The poses in order."""
        for k, row in enumerate(zip(self.times_s, self.positions, self.orientations, strict=True)):
            yield Pose(*row, bodies={name: body._pose(k) for name, body in self.bodies.items()})

    def _pose(self, k: int) -> Pose:
        return Pose(self.times_s[k], self.positions[k], self.orientations[k])

    def resampled(self, rate_hz: float) -> Motion:
        """The same motion at `rate_hz` poses a second (> 0), from the first pose on.

        Positions are interpolated linearly, orientations along great arcs. The last pose is kept
        only where it falls on the new rate.
        """
        if not rate_hz > 0:
            raise InvalidArgument.of("rate_hz", f"is {rate_hz}, must be greater than 0")
        if len(self) == 1:
            return self
        # The tiny allowance keeps the last pose in spite of round-off.
        count = int(np.floor(self.duration_s * rate_hz * (1 + 1e-9) + 1e-9)) + 1
        since_start = np.minimum(np.arange(count) / rate_hz, self.duration_s)
        times = self.times_s[0] + since_start
        inside = np.clip(times, self.times_s[0], self.times_s[-1])
        positions = [np.interp(inside, self.times_s, axis) for axis in self.positions.T]
        slerp = Slerp(self.times_s, Rotation.from_quat(self.orientations))
        bodies = {name: body.resampled(rate_hz) for name, body in self.bodies.items()}
        return Motion(times, np.stack(positions, axis=1), slerp(inside).as_quat(), bodies)

    def shifted(
        self, time_s: float = 0.0, world: ArrayLike = (0, 0, 0), head: ArrayLike = (0, 0, 0)
    ) -> Motion:
        """The same motion, displaced.

        Args:
          time_s: added to every time [s].
          world: added to every position, in world axes [m]; to those of bodies, too.
          head: where the new head frame's origin lies in the old head frame [m]; for a track of
            the neck joint and a groom whose origin is the middle of the skull, say, (0, 0.1, 0).
        """
        rotated = Rotation.from_quat(self.orientations).apply(np.asarray(head, dtype=np.float64))
        positions = self.positions + np.asarray(world, dtype=np.float64) + rotated
        bodies = {name: body.shifted(time_s, world) for name, body in self.bodies.items()}
        return Motion(self.times_s + time_s, positions, self.orientations, bodies)

    @staticmethod
    def load(path: str | os.PathLike) -> Motion:
        """Reads a `.bvh` file (`read_bvh`, with its defaults) or a `.csv` file (`read_csv`)."""
        suffix = Path(path).suffix.lower()
        if suffix == ".bvh":
            return read_bvh(path)
        if suffix == ".csv":
            return read_csv(path)
        raise InvalidArgument.of("path", f"{path} ends in {suffix!r}, must end in .bvh or .csv")


def read_bvh(
    path: str | os.PathLike,
    joint: str = "Head",
    height_m: float = 1.7,
    unit_m: float | None = None,
    t_pose: bool | None = None,
    axes: str = "mane",
) -> Motion:
    """Head motion of a figure in a Biovision (BVH) file; the first pose is at time 0.

    The position is that of the joint. The orientation is the joint's rotation away from the rest
    pose, in which the figure stands upright: frame 0 where that is a T-pose, else all angles zero.

    Args:
      path: the file.
      joint: the joint that carries the head, case-insensitive.
      height_m: BVH has no unit of length: the file is scaled so that the figure, standing, is this
        tall [m]. Standing height is the greatest height of the head's top over the lowest joint,
        in the rest pose or any frame.
      unit_m: length of the file's unit [m], instead of `height_m`.
      t_pose: whether frame 0 is a rest pose put before the recording, as in conversions of the CMU
        database; it is then left out of the motion. None finds out: the joint's step from frame 0
        to frame 1 is more than four times the longest step after it.
      axes: convention of the file's axes, a name in `mane.convert.CONVENTIONS`; its unit is not
        used. The figure must face that convention's forward axis in the rest pose.

    Raises InvalidArgument for a file that is not BVH, and for an unknown joint.
    """
    clip = bvh.read(path)
    index = clip.find(joint)
    to_mane = convert.axes_matrix(axes)
    if unit_m is None:
        if not height_m > 0:
            raise InvalidArgument.of("height_m", f"is {height_m}, must be greater than 0")
        unit_m = height_m / clip.standing_height(index, up=to_mane[1])
    elif not unit_m > 0:
        raise InvalidArgument.of("unit_m", f"is {unit_m}, must be greater than 0")
    positions, rotations = clip.world_frames(index)
    rest = np.eye(3)
    if _begins_with_jump(positions) if t_pose is None else t_pose:
        if clip.frame_count < 2:
            raise InvalidArgument.of("t_pose", f"is true, but {path} has no frame after frame 0")
        rest, positions, rotations = rotations[0], positions[1:], rotations[1:]
    away = to_mane @ rotations @ rest.T @ to_mane.T
    times = np.arange(len(positions)) * clip.frame_time_s
    return Motion(times, positions @ to_mane.T * unit_m, Rotation.from_matrix(away).as_quat())


def read_csv(path: str | os.PathLike) -> Motion:
    """Head motion in a CSV file with a header line that names `CSV_COLUMNS`, in any order.

    Raises InvalidArgument that names the line for missing columns and for what is not a number.
    """
    with open(path, newline="", encoding="utf-8") as file:
        reader = csv.DictReader(file, skipinitialspace=True)
        missing = [c for c in CSV_COLUMNS if c not in (reader.fieldnames or ())]
        if missing:
            raise InvalidArgument.of(
                str(path), f"lacks columns {', '.join(missing)}; needs {','.join(CSV_COLUMNS)}"
            )
        rows = [_csv_row(path, reader.line_num, row) for row in reader]
    if not rows:
        raise InvalidArgument.of(str(path), "holds no poses, must hold at least one")
    table = np.array(rows)
    return Motion(table[:, 0], table[:, 1:4], table[:, 4:])


def write_csv(path: str | os.PathLike, motion: Motion) -> None:
    """Writes `motion` so that `read_csv` gives back the same numbers, bit for bit."""
    table = np.column_stack([motion.times_s, motion.positions, motion.orientations])
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(CSV_COLUMNS)
        writer.writerows([repr(float(value)) for value in row] for row in table)


def _begins_with_jump(positions: np.ndarray) -> bool:
    steps = np.linalg.norm(np.diff(positions, axis=0), axis=1)
    return steps.size > 1 and steps[0] > 4 * steps[1:].max()


def _csv_row(path, line: int, row: dict) -> list[float]:
    try:
        return [float(row[column]) for column in CSV_COLUMNS]
    except (TypeError, ValueError) as error:
        raise InvalidArgument.of(f"{path}:{line}", f"is not eight numbers ({error})") from error


def _rows(name: str, values: ArrayLike | None, count: int, default: tuple) -> np.ndarray:
    """`values` as (count, len(default)) float64, or `default` in every row."""
    if values is None:
        return np.tile(np.array(default), (count, 1))
    rows = np.array(values, dtype=np.float64)
    if rows.shape != (count, len(default)):
        raise InvalidArgument.of(
            name, f"has shape {rows.shape}, must be ({count}, {len(default)}) as times_s says"
        )
    _require_finite(name, rows)
    return rows


def _require_finite(name: str, values: np.ndarray) -> None:
    bad = np.argwhere(~np.isfinite(values))
    if bad.size:
        where = ", ".join(str(i) for i in bad[0])
        raise InvalidArgument.of(f"{name}[{where}]", f"is {values[tuple(bad[0])]}, must be finite")


def _normalised(name: str, quaternions: np.ndarray) -> np.ndarray:
    """Unit quaternions; exact ones stay as they are, bit for bit."""
    norms = np.linalg.norm(quaternions, axis=1)
    off = np.abs(norms - 1)
    if np.any(off > 0.01):
        k = int(np.argmax(off))
        raise InvalidArgument.of(
            f"{name}[{k}]", f"has norm {norms[k]:.6g}, must be a unit quaternion within 1 %"
        )
    # Below round-off a division would only change the last bits.
    return np.where((off > 1e-15)[:, None], quaternions / norms[:, None], quaternions)
