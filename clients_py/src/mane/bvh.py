"""Biovision hierarchy (BVH) motion files: parsing and forward kinematics.

A BVH file lists a tree of joints, each with an offset from its parent and channels in an order of
its own, then one row of channel values per frame. Angles are degrees. The rotation of a joint is
the product of its channels' rotations in the declared order (`Zrotation Yrotation Xrotation`:
Rz Ry Rx). A position channel replaces that coordinate of the offset. In the rest pose all angles
are zero, so every joint's axes are parallel to the file's.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import Rotation

from mane.errors import InvalidArgument

_POSITION_CHANNELS = {"xposition": 0, "yposition": 1, "zposition": 2}
_ROTATION_CHANNELS = {"xrotation": "X", "yrotation": "Y", "zrotation": "Z"}


@dataclass
class Joint:
    """A node of the tree; parents come before children. End sites are joints without channels.

    Attributes:
      name: as in the file; `End Site` for an end site.
      parent: index of the parent, -1 for a root.
      offset: from the parent, (3,), in the file's unit.
      channels: (lower-case channel name, column in the rows of values).
    """

    name: str
    parent: int
    offset: np.ndarray = field(default_factory=lambda: np.zeros(3))
    channels: list[tuple[str, int]] = field(default_factory=list)


@dataclass
class Clip:
    """A parsed file.

    Attributes:
      joints: parents before children.
      values: channel values, (frame, channel).
      frame_time_s: time from frame to frame [s].
    """

    joints: list[Joint]
    values: np.ndarray
    frame_time_s: float

    @property
    def frame_count(self) -> int:
        return self.values.shape[0]

    def find(self, name: str) -> int:
        """Index of the joint of that name, case-insensitive. InvalidArgument if there is none."""
        for index, joint in enumerate(self.joints):
            if joint.name.lower() == name.lower():
                return index
        known = ", ".join(j.name for j in self.joints if j.name != "End Site")
        raise InvalidArgument.of("joint", f"is {name!r}, must be one of {known}")

    def world_frames(self, index: int) -> tuple[np.ndarray, np.ndarray]:
        """Positions (frame, 3), file unit, and rotations (frame, 3, 3) of a joint in the world."""
        chain = [index]
        while self.joints[chain[-1]].parent >= 0:
            chain.append(self.joints[chain[-1]].parent)
        positions = np.zeros((self.frame_count, 3))
        rotations = np.broadcast_to(np.eye(3), (self.frame_count, 3, 3))
        for joint in reversed(chain):
            positions, rotations = self._advance(joint, positions, rotations)
        return positions, rotations

    def standing_height(self, head: int, up: np.ndarray) -> float:
        """Greatest height of the head's top over the lowest joint, rest pose and all frames.

        The head's top is the highest of the joint `head` and what hangs on it. `up` is a unit
        vector in the file's axes. InvalidArgument if the figure has no height.
        """
        height = max(clip._head_heights(head, up).max() for clip in (self._rest(), self))
        if not height > 0:
            raise InvalidArgument.of("height_m", "cannot be used: the file's figure has no height")
        return float(height)

    def _rest(self) -> Clip:
        """One frame of the rest pose: all angles zero, every joint at its offset."""
        values = np.zeros((1, self.values.shape[1]))
        for joint in self.joints:
            for channel, column in joint.channels:
                if channel in _POSITION_CHANNELS:
                    values[0, column] = joint.offset[_POSITION_CHANNELS[channel]]
        return Clip(self.joints, values, self.frame_time_s)

    def _head_heights(self, head: int, up: np.ndarray) -> np.ndarray:
        """Height of the head's top over the lowest joint in every frame, (frame,)."""
        frames: list[tuple[np.ndarray, np.ndarray]] = []
        root = (np.zeros((self.frame_count, 3)), np.broadcast_to(np.eye(3), (1, 3, 3)))
        on_head = []
        for index, joint in enumerate(self.joints):
            parent = frames[joint.parent] if joint.parent >= 0 else root
            frames.append(self._advance(index, *parent))
            on_head.append(index == head or (joint.parent >= 0 and on_head[joint.parent]))
        heights = np.stack([positions @ up for positions, _ in frames])
        return heights[np.array(on_head)].max(axis=0) - heights.min(axis=0)

    def _advance(self, index: int, positions: np.ndarray, rotations: np.ndarray):
        """Frames of a joint from those of its parent."""
        joint = self.joints[index]
        local = np.tile(joint.offset, (self.frame_count, 1))
        order, columns = "", []
        for channel, column in joint.channels:
            if channel in _POSITION_CHANNELS:
                local[:, _POSITION_CHANNELS[channel]] = self.values[:, column]
            else:
                order += _ROTATION_CHANNELS[channel]
                columns.append(column)
        positions = positions + np.einsum("fij,fj->fi", rotations, local)
        if order:
            angles = self.values[:, columns]
            rotations = rotations @ _rotations(order, angles)
        return positions, rotations


def read(path: str | os.PathLike) -> Clip:
    """Parses a BVH file. InvalidArgument, with the file's name, where it is not one."""
    with open(path, encoding="utf-8", errors="replace") as file:
        words = iter(file.read().split())
    try:
        return _parse(words)
    except StopIteration:
        raise InvalidArgument.of(str(path), "ends too early for a BVH file") from None
    except ValueError as error:
        raise InvalidArgument.of(str(path), f"is not a BVH file: {error}") from error


def _parse(words: Iterator[str]) -> Clip:
    _expect(words, "HIERARCHY")
    joints: list[Joint] = []
    open_joints: list[int] = []  # Indices from a root down to the joint being read; -1 unopened.
    width = 0
    for word in words:
        match word.upper():
            case "ROOT" | "JOINT":
                joints.append(Joint(next(words), open_joints[-1] if open_joints else -1))
            case "END":
                next(words)  # "Site"
                joints.append(Joint("End Site", open_joints[-1] if open_joints else -1))
            case "{":
                open_joints.append(len(joints) - 1)
            case "}":
                if not open_joints:
                    raise ValueError("a '}' too many")
                open_joints.pop()
            case "OFFSET":
                joints[-1].offset = np.array([float(next(words)) for _ in range(3)])
            case "CHANNELS":
                names = [_channel(next(words)) for _ in range(int(next(words)))]
                joints[-1].channels = [(name, width + i) for i, name in enumerate(names)]
                width += len(names)
            case "MOTION":
                break
            case _:
                raise ValueError(f"unexpected {word!r} in the hierarchy")
    if not joints or open_joints:
        raise ValueError("the hierarchy is not complete")
    return _parse_motion(words, joints, width)


def _parse_motion(words: Iterator[str], joints: list[Joint], width: int) -> Clip:
    _expect(words, "FRAMES:")
    frame_count = int(next(words))
    _expect(words, "FRAME")
    _expect(words, "TIME:")
    frame_time_s = float(next(words))
    values = np.array([float(word) for word in words])
    if frame_count < 1 or not 0 < frame_time_s < np.inf:
        raise ValueError(f"{frame_count} frames of {frame_time_s} s")
    if values.size != frame_count * width:
        raise ValueError(
            f"{values.size} values, must be {frame_count} frames times {width} channels"
        )
    if not np.all(np.isfinite(values)):
        raise ValueError("a channel value is not finite")
    return Clip(joints, values.reshape(frame_count, width), frame_time_s)


def _expect(words: Iterator[str], keyword: str) -> None:
    word = next(words)
    if word.upper() != keyword:
        raise ValueError(f"{word!r} stands where {keyword!r} should")


def _channel(word: str) -> str:
    name = word.lower()
    if name not in _POSITION_CHANNELS and name not in _ROTATION_CHANNELS:
        raise ValueError(f"unknown channel {word!r}")
    return name


def _rotations(order: str, angles_deg: np.ndarray) -> np.ndarray:
    """Products of rotations about the axes in `order`, (frame, 3, 3)."""
    product = np.broadcast_to(np.eye(3), (angles_deg.shape[0], 3, 3))
    for axis, angle in zip(order, angles_deg.T, strict=True):
        product = product @ Rotation.from_euler(axis, angle[:, None], degrees=True).as_matrix()
    return product
