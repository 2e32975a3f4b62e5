"""How tips swing after a stop and while a head shakes."""

from __future__ import annotations

from itertools import takewhile

import numpy as np

from mane.demo import RATE_HZ
from mane.motion import Motion

SPEED_M_S = 1.2
BEGINS_S, STOPS_S, STOP_ENDS_S = 1.0, 1.7, 4.5
SHAKE_HZ, SHAKE_M, SHAKE_S = 2.0, 0.02, 3.0

LEAST_SWING = 0.05
"""Swings that are smaller than this part of the largest are not counted."""


def stop() -> Motion:
    """The head sets out softly, goes aside and stops at once."""
    times = np.arange(round(STOP_ENDS_S * RATE_HZ) + 1) / RATE_HZ
    speed = SPEED_M_S * 0.5 * (1 - np.cos(np.pi * np.minimum(times / BEGINS_S, 1)))
    speed[times > STOPS_S] = 0
    return Motion(times, np.outer(np.cumsum(speed) / RATE_HZ, (1, 0, 0)))


def shake() -> Motion:
    times = np.arange(round(SHAKE_S * RATE_HZ) + 1) / RATE_HZ
    return Motion(times, np.outer(SHAKE_M * np.sin(2 * np.pi * SHAKE_HZ * times), (1, 0, 0)))


def free_swing(motion: Motion, aside: np.ndarray) -> dict[str, float]:
    """What tips do that are so far aside, (frame,) [m], after the stop: numbers by name."""
    free = motion.times_s > STOPS_S - 0.5 / RATE_HZ  # The hair still lags in the first frame.
    times, sizes = turning_points(motion.times_s[free], aside[free])
    found = {"largest swing [mm]": float(1e3 * sizes[0])}
    if len(times) > 1:
        lasts = times[-1] - times[0]
        found["half period [s]"] = float(lasts / (len(times) - 1))
        found["decay [1/s]"] = float(np.log(sizes[0] / sizes[-1]) / lasts)
    return found


def turning_points(times: np.ndarray, swing: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """When a swing about zero is farthest on either side, and how far, after its first passage."""
    passages = np.flatnonzero(np.diff(np.signbit(swing))) + 1
    ways = np.split(np.arange(len(swing)), passages)[1:-1]
    tops = [way[np.abs(swing[way]).argmax()] for way in ways]
    counted = list(takewhile(lambda top: abs(swing[top]) > LEAST_SWING * abs(swing[tops[0]]), tops))
    return times[counted], np.abs(swing[counted])
