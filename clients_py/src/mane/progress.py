"""Progress bars of the command line."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.table import Column, Table

from mane.jobs import Job

# Results go to stdout; progress and errors to stderr, so that output can be piped.
out = Console(soft_wrap=True, highlight=False, width=None if sys.stdout.isatty() else 200)
err = Console(stderr=True, soft_wrap=True, highlight=False)


def listing(*columns: str) -> Table:
    """An empty table. The first column holds names, which are never cut."""
    return Table(Column(columns[0], no_wrap=True), *columns[1:], box=None)


def counted(items: Iterable, total: int, label: str) -> Iterator:
    """`items` as they are, with a bar that counts them."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=err, transient=True) as progress:
        yield from progress.track(items, total=total, description=label)


def watched(updates: Iterable[Job], label: str) -> Iterator[Job]:
    """Updates of a job as they are, with a bar that shows the newest."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TextColumn("{task.fields[left]}"),
    )
    with Progress(*columns, console=err, transient=True) as progress:
        task = progress.add_task(label, total=1.0, left="")
        for job in updates:
            left = f"{job.seconds_left:.0f} s left" if job.seconds_left > 0 else ""
            description = f"{label} ({job.state})"
            progress.update(task, completed=job.progress, left=left, description=description)
            yield job


@contextmanager
def waiting(label: str) -> Iterator[None]:
    """A spinner while something of unknown length goes on."""
    with err.status(label):
        yield
