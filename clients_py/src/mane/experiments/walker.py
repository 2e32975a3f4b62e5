"""A figure that walks: a head, and the parts of its body as moving bodies.

All meshes are in the axes of the head at rest, with the pivot of the head on the neck as origin
(`mane.mesh`), so that every pose is the identity there.
"""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation, Slerp

from mane import clips, mesh
from mane.mesh import Mesh
from mane.motion import Motion, read_bvh

RATE_HZ = 60.0

NECK = np.array([0.0, -0.113, -0.034])
"""Where the neck leaves the shoulders: head and neck turn about it [m]."""
SHOULDER = np.array([0.172, -0.165, -0.026])
"""The left one, about which an arm turns [m]: somewhat above the joint, so that it stays closed as
arms that were held away from the body come down."""

_NECK_OVERLAP_M = 0.02  # Of head and torso.
_WAIST_M = -0.5
_TORSO_HALF_WIDTH_M = 0.18
_ARM_FROM_M = 0.16  # From the mid plane.
_ARM_DIRECTION = np.array([0.64, -0.77, 0.0])  # At rest, the left one.
_EASE_S = 1.0
_SWING = 0.1  # Of a torso, about the vertical axis [rad].
_ARM_SWING = 3  # Of an arm, to and fro, over that.


@dataclass(frozen=True)
class Walker:
    """head: with its hair region. parts: meshes of moving bodies by name. motion: of the head, and
    of the parts as its `bodies`. walks: frames of `motion` in which it does, the others stand."""

    head: Mesh
    parts: dict[str, Mesh]
    motion: Motion
    walks: slice

    def walking(self) -> np.ndarray:
        """Whether it does in each frame, (frame,)."""
        walking = np.zeros(len(self.motion), bool)
        walking[self.walks] = True
        return walking


def walker(
    body: str | os.PathLike | None,
    group: str | None,
    unit_m: float,
    motion: str | os.PathLike | None,
    before_s: float,
    after_s: float,
) -> Walker:
    """A figure that stands, walks, and stands.

    body: an OBJ file of a body that holds its arms away from it (`mesh.place_head`); None is the
    mannequin, which has none. group, unit_m: as of `mesh.load_obj`. motion: a BVH file with the
    joints of the CMU database; None is the clip `walk`.
    """
    if body is None:
        whole = mesh.mannequin()
    else:
        whole = mesh.with_hair_region(mesh.place_head(mesh.load_obj(body, group, unit_m)))
    head, parts = _cut(whole)
    moving = _clip() if motion is None else _recorded(motion)
    count = len(moving["head"])
    before, after = round(before_s * RATE_HZ), round(after_s * RATE_HZ)
    times = np.arange(before + count + after) / RATE_HZ
    frames = np.clip(np.arange(len(times)) - before, 0, count - 1)
    tracks = {
        name: Motion(times, moving[name].positions[frames], moving[name].orientations[frames])
        for name in ("head", *parts)
    }
    whole_motion = Motion(
        times,
        tracks["head"].positions,
        tracks["head"].orientations,
        {name: tracks[name] for name in parts},
    )
    return Walker(head, parts, whole_motion, slice(before, before + count))


def _cut(whole: Mesh) -> tuple[Mesh, dict[str, Mesh]]:
    """The head with its neck, and torso and arms, if there are any."""
    up, down, aside = np.eye(3)[1], -np.eye(3)[1], np.eye(3)[0]
    bare = Mesh(whole.vertices, whole.triangles)
    waist = (up, (0, _WAIST_M, 0))
    has_arms = np.abs(whole.vertices[:, 0]).max() > 0.3
    sides = [(s * aside, (-s * _TORSO_HALF_WIDTH_M, 0, 0)) for s in (1, -1)] if has_arms else []
    head = mesh.cut(whole, [(up, (0, NECK[1], 0))])
    shoulders = (down, (0, NECK[1] + _NECK_OVERLAP_M, 0))
    parts = {"torso": mesh.cut(bare, [shoulders, *_above(bare, waist), *sides])}
    if has_arms:
        for name, s in (("left-arm", 1), ("right-arm", -1)):
            parts[name] = mesh.cut(bare, [waist, shoulders, (s * aside, (s * _ARM_FROM_M, 0, 0))])
    return head, parts


def _above(bare: Mesh, waist) -> list:
    """The plane, where the mesh reaches beyond it."""
    return [waist] if bare.vertices[:, 1].min() < waist[1][1] else []


def _poses(neck: np.ndarray, head: Rotation, torso: Rotation, arms: dict[str, Rotation]) -> dict:
    """Motions of all parts from the way of the neck, (k, 3) [m], and their rotations from rest."""
    times = np.arange(len(neck)) / RATE_HZ
    tracks = {}
    for name, turn in (("head", head), ("torso", torso)):
        tracks[name] = Motion(times, neck - turn.apply(NECK), turn.as_quat())
    for name, turn in arms.items():
        joint = SHOULDER * (1 if name == "left-arm" else -1, 1, 1)
        place = neck + torso.apply(joint - NECK)
        tracks[name] = Motion(times, place - turn.apply(joint), turn.as_quat())
    return tracks


def _recorded(path: str | os.PathLike) -> dict:
    """A recorded walk that sets out and stops within `_EASE_S`, by going through it slower there.

    Its frame 0 is a T-pose, as in conversions of the CMU database.
    """

    def track(joint: str) -> Motion:
        return _eased(read_bvh(path, joint, t_pose=True))

    neck = track("Neck1").positions
    head, torso = (Rotation.from_quat(track(j).orientations) for j in ("Head", "Spine1"))
    arms = {}
    for name, joint, s in (("left-arm", "LeftArm", 1), ("right-arm", "RightArm", -1)):
        to_t_pose = Rotation.align_vectors([(s, 0, 0)], [_ARM_DIRECTION * (s, 1, 1)])[0]
        arms[name] = Rotation.from_quat(track(joint).orientations) * to_t_pose
    return _poses(neck, head, torso, arms)


def _eased(motion: Motion) -> Motion:
    t = np.arange(round((motion.duration_s + _EASE_S) * RATE_HZ) + 1) / RATE_HZ
    # Speeds up and slows down evenly; goes at its own speed between.
    slow = np.minimum(t, _EASE_S) ** 2 - np.maximum(t - motion.duration_s, 0) ** 2
    passed = slow / (2 * _EASE_S) + np.maximum(t - _EASE_S, 0)
    passed = np.clip(motion.times_s[0] + passed, *motion.times_s[[0, -1]])
    positions = [np.interp(passed, motion.times_s, axis) for axis in motion.positions.T]
    turns = Slerp(motion.times_s, Rotation.from_quat(motion.orientations))(passed)
    return Motion(t, np.stack(positions, axis=1), turns.as_quat())


def _clip() -> dict:
    """The clip `walk`; its torso keeps upright and swings about the vertical axis at every step."""
    clip = clips.load("walk").resampled(RATE_HZ)
    head = Rotation.from_quat(clip.orientations)
    neck = clip.positions + head.apply(NECK)
    speed = np.gradient(gaussian_filter1d(clip.positions[:, 2], 6), 1 / RATE_HZ)
    swing = _SWING * np.clip(speed / 1.4, 0, 1) * np.sin(2 * np.pi * 0.95 * clip.times_s)
    torso = Rotation.from_rotvec(np.outer(swing, (0, 1, 0)))
    arms = {}
    for name, s in (("left-arm", 1), ("right-arm", -1)):
        down = Rotation.align_vectors([(0.1 * s, -1, 0)], [_ARM_DIRECTION * (s, 1, 1)])[0]
        arms[name] = Rotation.from_rotvec(np.outer(s * _ARM_SWING * swing, (1, 0, 0))) * down
    return _poses(neck, head, torso, arms)

