"""What an experiment found: facts held against theory, tables of numbers, figures; as files."""

from __future__ import annotations

import csv
import importlib.util
import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from mane.errors import FailedPrecondition


@dataclass(frozen=True)
class Fact:
    """One comparison: what theory says, what was measured, and whether they agree."""

    what: str
    theory: str
    measured: str
    holds: bool


@dataclass
class Report:
    """Collects an experiment's results in a folder, which is made where there is none.

    Files are named after the experiment: NAME.json holds the facts and values, NAME-PART.csv a
    table, NAME-PART.png a figure.

    Attributes:
      name: of the experiment.
      folder: where files go.
      facts: in the order in which they were found.
      values: single numbers by name, for whoever reads the JSON file.
      files: what was written.
    """

    name: str
    folder: Path
    facts: list[Fact] = field(default_factory=list)
    values: dict[str, float] = field(default_factory=dict)
    files: list[Path] = field(default_factory=list)

    def __post_init__(self):
        if importlib.util.find_spec("matplotlib") is None:
            raise FailedPrecondition("figures need matplotlib; pip install 'mane[pictures]'")
        self.folder.mkdir(parents=True, exist_ok=True)

    @property
    def holds(self) -> bool:
        """Whether every fact does."""
        return all(fact.holds for fact in self.facts)

    def fact(self, what: str, theory: str, measured: str, holds: bool) -> None:
        """A comparison in words."""
        self.facts.append(Fact(what, theory, measured, bool(holds)))

    def at_most(self, what: str, measured: float, bound: float, unit: str = "") -> None:
        """A number, such as an error, that should be `bound` or less."""
        self.values[what] = float(measured)
        self.fact(what, f"<= {bound:.3g}{unit}", f"{measured:.3g}{unit}", measured <= bound)

    def equal(
        self, what: str, theory: float, measured: float, within: float, unit: str = ""
    ) -> None:
        """A number that should be `theory`, to `within` as a part of it."""
        self.values[what] = float(measured)
        off = measured / theory - 1
        self.fact(
            what,
            f"{theory:.4g}{unit} (to {100 * within:.2g} %)",
            f"{measured:.4g}{unit} ({100 * off:+.2g} %)",
            abs(off) <= within,
        )

    def table(self, part: str, columns: Mapping[str, ArrayLike]) -> None:
        """Writes columns of equal length, headed by their keys, which say the unit."""
        path = self.path(part, ".csv")
        with open(path, "w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(columns)
            lists = (np.asarray(values).tolist() for values in columns.values())
            writer.writerows(zip(*lists, strict=True))

    @contextmanager
    def figure(self, part: str, columns: int = 1, rows: int = 1, width: float = 6.4) -> Iterator:
        """Axes of a figure to draw on, (rows * columns,); the file is written at the block's end.

        width: of each of them, inches; they are three quarters as high.
        """
        from matplotlib.figure import Figure  # Only here: it takes a while to load.

        figure = Figure((width * columns, 0.75 * width * rows), layout="constrained")
        axes = figure.subplots(rows, columns, squeeze=False).ravel()
        for each in axes:
            each.grid(True, alpha=0.3)
        yield axes
        figure.savefig(self.path(part, ".png"), dpi=110)

    def write(self) -> None:
        """Writes facts and values: the last thing to do."""
        content = {
            "experiment": self.name,
            "holds": self.holds,
            "facts": [asdict(fact) for fact in self.facts],
            "values": self.values,
        }
        path = self.folder / f"{self.name}.json"
        self.files.append(path)
        path.write_text(json.dumps(content, indent=1) + "\n")

    def path(self, part: str, ending: str) -> Path:
        """Where to write a part of the result, which counts as written from now on."""
        self.files.append(self.folder / f"{self.name}-{part}{ending}")
        return self.files[-1]
