"""What a style became on a head, as numpy arrays."""

from __future__ import annotations

import json
import os
from dataclasses import asdict, dataclass, fields

import numpy as np

from mane.errors import InvalidArgument


@dataclass(frozen=True)
class Outcome:
    """How one constraint came out.

    Attributes:
      queue: number of the queue: those of the style, then those of its operations.
      queue_name: its name.
      constraint: number of the constraint in the queue.
      selected: wisps that should meet it.
      met: those of them that did; the others were too short or held back.
    """

    queue: int
    queue_name: str
    constraint: int
    selected: int
    met: int


@dataclass(frozen=True)
class StyleReport:
    """How a style came out.

    Attributes:
      groom: that was made, `grooms/{groom}`.
      outcomes: an `Outcome` of every constraint.
      wisp_count, strand_count: masters, and members of them all; of a style by beams guides, and
        all hairs.
      control_point_count: of all members.
      crowded_segments: of masters, that are denser than the threshold all the same.
      seconds_roots, seconds_masters, seconds_deformation, seconds_members, seconds_guides: what
        each stage took; a style by beams has members and guides.
    """

    groom: str = ""
    outcomes: tuple[Outcome, ...] = ()
    wisp_count: int = 0
    strand_count: int = 0
    control_point_count: int = 0
    crowded_segments: int = 0
    seconds_roots: float = 0.0
    seconds_masters: float = 0.0
    seconds_deformation: float = 0.0
    seconds_members: float = 0.0
    seconds_guides: float = 0.0

    @property
    def missed(self) -> tuple[Outcome, ...]:
        """Constraints that not all of their wisps met."""
        return tuple(outcome for outcome in self.outcomes if outcome.met < outcome.selected)

    def stages_s(self) -> dict[str, float]:
        """What each stage took [s], by its name, in their order."""
        return {
            field.name.removeprefix("seconds_"): getattr(self, field.name)
            for field in fields(self)
            if field.name.startswith("seconds_")
        }


@dataclass(frozen=True, eq=False)
class Masters:
    """Master strands, one a wisp, root first. Joints of strand i are those from `first_joint[i]` to
    `first_joint[i + 1]`.

    Attributes:
      joint_counts: (wisp,) uint32.
      outline: the strands without their pattern, (joint, 3) float32, head frame [m].
      points: the strands, (joint, 3) float32 [m].
      lengths: (wisp,) float32 [m]; joints may go on beyond it.
    """

    joint_counts: np.ndarray
    outline: np.ndarray
    points: np.ndarray
    lengths: np.ndarray

    @property
    def first_joint(self) -> np.ndarray:
        """(wisp + 1,) int64."""
        return _firsts(self.joint_counts)


@dataclass(frozen=True, eq=False)
class Members:
    """Member strands: control points of Catmull-Rom splines, root first. Points of strand i are
    those from `first_point[i]` to `first_point[i + 1]`.

    Attributes:
      wisps: number of each one's wisp, (strand,) uint32.
      point_counts: (strand,) uint32.
      points: (point, 3) float32, head frame [m].
      colours: (strand, 3) uint8, sRGB.
    """

    wisps: np.ndarray
    point_counts: np.ndarray
    points: np.ndarray
    colours: np.ndarray

    @property
    def first_point(self) -> np.ndarray:
        """(strand + 1,) int64."""
        return _firsts(self.point_counts)

    def strands(self) -> list[np.ndarray]:
        """Points of every strand, (k, 3): views, not copies."""
        return np.split(self.points, self.first_point[1:-1])


@dataclass(frozen=True, eq=False)
class Volume:
    """Values at the nodes of a box.

    Attributes:
      low: the first node, (3,), head frame [m].
      cell_m: distance of neighbouring nodes.
      values: float32 (z, y, x), of vectors (z, y, x, 3).
    """

    low: np.ndarray
    cell_m: float
    values: np.ndarray


@dataclass(frozen=True, eq=False)
class Hairstyle:
    """What a style became on a head.

    Attributes:
      masters: `Masters`; of a style by beams the hairs that became guides.
      members: `Members`; of a style by beams all hairs, their `wisps` the guides that they ride on.
      density: `Volume`: the part of space that hair, or the head, takes.
      field: `Volume` of vectors: the styling field, without constraints; over the same box, not as
        fine.
      maps: `density`, `length` and `protrusion` as they were used, drawn over the scalp as
        `mane.scalp_maps` says: float32 (512, 512). A style by beams has none, nor a density and
        field, which are None.
      report: `StyleReport`.
    """

    masters: Masters
    members: Members
    density: Volume | None
    field: Volume | None
    maps: dict[str, np.ndarray]
    report: StyleReport

    def save(self, path: str | os.PathLike) -> None:
        """Writes an .npz file. `mane.strand_files` reads its members as strands."""
        arrays = {f"masters_{name}": value for name, value in vars(self.masters).items()}
        arrays |= {
            _MEMBER_KEYS.get(name, name): value for name, value in vars(self.members).items()
        }
        for part in _VOLUMES if self.density else ():
            arrays |= {f"{part}_{name}": value for name, value in vars(getattr(self, part)).items()}
        arrays |= {f"map_{name}": values for name, values in self.maps.items()}
        with open(path, "wb") as file:
            np.savez(file, report=json.dumps(asdict(self.report)), **arrays)

    @classmethod
    def load(cls, path: str | os.PathLike) -> Hairstyle:
        """What `save` wrote. InvalidArgument for another file."""
        try:
            with np.load(path) as file:
                arrays = dict(file)
            told = json.loads(str(arrays["report"]))
            report = StyleReport(
                **told | {"outcomes": tuple(Outcome(**outcome) for outcome in told["outcomes"])}
            )
            masters = {f.name: arrays[f"masters_{f.name}"] for f in fields(Masters)}
            members = {f.name: arrays[_MEMBER_KEYS.get(f.name, f.name)] for f in fields(Members)}
            volumes = [
                Volume(
                    low=arrays[f"{part}_low"],
                    cell_m=float(arrays[f"{part}_cell_m"]),
                    values=arrays[f"{part}_values"],
                )
                for part in _VOLUMES
                if f"{part}_low" in arrays
            ] or [None, None]
        except (ValueError, TypeError, KeyError, EOFError) as error:
            raise InvalidArgument.of(str(path), f"is not a saved hairstyle: {error!r}") from error
        maps = {
            name.removeprefix("map_"): values
            for name, values in arrays.items()
            if name.startswith("map_")
        }
        return cls(Masters(**masters), Members(**members), *volumes, maps, report)


_VOLUMES = ("density", "field")
_MEMBER_KEYS = {"point_counts": "counts"}  # In files, where `points` and `counts` are strands.


def _firsts(counts: np.ndarray) -> np.ndarray:
    return np.concatenate([[0], np.cumsum(counts, dtype=np.int64)])
