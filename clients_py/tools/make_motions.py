#!/usr/bin/env python3
"""Makes the head motion clips that the package ships: src/mane/data/motions/*.csv, 60 Hz.

Every clip is a formula in the time t [s]. It starts at the identity, at rest, and ends at rest,
upright and looking forward; walk and run end farther along +Z. Angles turn about the head frame's
axes: positive pitch nods down, positive yaw looks to the figure's left, positive roll leans the top
of the head to its right shoulder.

  ease(x)   10 x^3 - 15 x^4 + 6 x^5 on [0, 1], 0 before, 1 after: the smoothest step from rest to
            rest (least jerk).
  swell(t)  ease(t / r) ease((T - t) / r): 1 in the middle of a clip of length T, 0 at both ends.

Usage: make_motions.py [--out FOLDER].
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from mane.motion import CSV_COLUMNS, Motion

RATE_HZ = 60
NECK_M = 0.10  # Length of the neck below the head's pivot.
SHIPPED = Path(__file__).resolve().parents[1] / "src" / "mane" / "data" / "motions"


def ease(x):
    x = np.clip(x, 0.0, 1.0)
    return x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)


def swell(t, rise_s):
    return ease(t / rise_s) * ease((t[-1] - t) / rise_s)


def times(duration_s):
    return np.arange(round(duration_s * RATE_HZ) + 1) / RATE_HZ


def motion(t, pitch=0.0, yaw=0.0, roll=0.0, x=0.0, y=0.0, z=0.0):
    """A clip from angles [deg], applied roll first, yaw last, and places [m], each (k,) or 0."""
    angles = np.stack([np.broadcast_to(a, t.shape) for a in (yaw, pitch, roll)], 1)
    places = np.stack([np.broadcast_to(p, t.shape) for p in (x, y, z)], 1)
    return Motion(
        t, places, Rotation.from_euler("YXZ", angles, degrees=True).as_quat(canonical=True)
    )


def nod():
    """Yes: 20 degrees up and down at 1.1 Hz; the neck takes two fifths of the angle, so that the
    head also swings forward and back on it."""
    t = times(5.0)
    pitch = 20.0 * np.sin(2 * np.pi * 1.1 * t) * swell(t, 1.0)
    neck = np.radians(0.4 * pitch)
    return motion(t, pitch=pitch, y=NECK_M * (np.cos(neck) - 1.0), z=NECK_M * np.sin(neck))


def shake():
    """No: 35 degrees to both sides, from 0.5 Hz up to 2 Hz in the middle and down again."""
    t = times(6.0)
    half = t[-1] / 2
    # Phase of the frequency 0.5 + 1.5 sin^2(pi t / T) Hz; its whole is 2 pi times 1.25 T = 7.5.
    turns = 0.5 * t + 0.75 * (t - half / np.pi * np.sin(np.pi * t / half))
    return motion(t, yaw=35.0 * np.sin(2 * np.pi * turns) * swell(t, 1.0))


def gait(duration_s, speed_m_s, step_hz, bob_m, sway_m, pitch_deg, yaw_deg, lean_deg):
    """Going along +Z: the head bobs and pitches once a step, sways and yaws once every two."""
    t = times(duration_s)
    on = swell(t, 1.2)
    along = np.cumsum(np.concatenate([[0.0], (on[1:] + on[:-1]) / (2 * RATE_HZ)])) * speed_m_s
    step, stride = 2 * np.pi * step_hz * t, np.pi * step_hz * t
    return motion(
        t,
        pitch=on * (lean_deg + pitch_deg * np.sin(step)),
        yaw=on * yaw_deg * np.sin(stride),
        roll=on * 0.5 * yaw_deg * np.cos(stride),
        x=on * sway_m * np.cos(stride),
        y=-on * bob_m * np.cos(step),
        z=along + on * 0.3 * bob_m * np.sin(step),
    )


def walk():
    """1.4 m/s, 1.9 steps a second, bob 2.2 cm and sway 2 cm to either side."""
    return gait(6.0, 1.4, 1.9, 0.022, 0.020, 1.5, 2.5, 1.0)


def run():
    """3 m/s, 2.7 steps a second, bob 4.5 cm and sway 1.5 cm to either side, leaning forward."""
    return gait(5.0, 3.0, 2.7, 0.045, 0.015, 3.5, 4.0, 6.0)


def turn():
    """Looks 90 degrees to the left in 0.4 s, stays 1.6 s, and back in 0.4 s."""
    t = times(5.0)
    return motion(t, yaw=90.0 * (ease((t - 0.6) / 0.4) - ease((t - 2.6) / 0.4)))


CLIPS = {"nod": nod, "shake": shake, "walk": walk, "run": run, "turn": turn}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out", type=Path, default=SHIPPED, help="folder to write to (%(default)s)"
    )
    out = parser.parse_args().out
    out.mkdir(parents=True, exist_ok=True)
    for name, make in CLIPS.items():
        clip = make()
        table = np.column_stack([clip.times_s, clip.positions, clip.orientations])
        np.savetxt(
            out / f"{name}.csv",
            np.round(table, 9) + 0.0,
            fmt="%.9g",
            delimiter=",",
            header=",".join(CSV_COLUMNS),
            comments="",
        )
        print(f"{out / name}.csv: {len(table)} poses, {clip.times_s[-1]:.1f} s")


if __name__ == "__main__":
    main()
