"""`mane job`: long work on a server."""

from __future__ import annotations

from typing import Annotated

import typer
from rich.table import Table

from mane.jobs import Job
from mane.progress import listing, out

app = typer.Typer(no_args_is_help=True, rich_markup_mode="markdown", help="Follow long work.")

_Name = Annotated[str, typer.Argument(help="Name, as `mane job list` says it.")]


@app.command("list")
def list_(context: typer.Context) -> None:
    """List all jobs, newest first.

    Examples:

    ```
    mane job list
    ```
    """
    table = listing("name", "kind", "state", "progress", "created", "what")
    for job in context.obj.list_jobs():
        table.add_row(
            job.name, job.kind, job.state, f"{job.progress:.0%}", _moment(job.create_time),
            job.description,
        )  # fmt: skip
    out.print(table)


@app.command()
def show(context: typer.Context, job: _Name) -> None:
    """Show one job.

    Examples:

    ```
    mane job show 3f2a
    ```
    """
    _print(context.obj.get_job(job))


@app.command()
def cancel(context: typer.Context, job: _Name) -> None:
    """Stop a job. One that has ended stays as it is.

    Examples:

    ```
    mane job cancel 3f2a
    ```
    """
    _print(context.obj.cancel_job(job))


def _print(job: Job) -> None:
    table = Table(box=None, show_header=False)
    rows = {
        "name": job.name,
        "kind": job.kind,
        "what": job.description,
        "state": job.state,
        "progress": f"{job.progress:.0%}",
        "seconds left": f"{job.seconds_left:.0f}" if job.seconds_left > 0 else "-",
        "created": _moment(job.create_time),
        "started": _moment(job.start_time),
        "ended": _moment(job.end_time),
        "result": f"{job.result_bytes} bytes",
        "error": job.error or "-",
    }
    for row in rows.items():
        table.add_row(*row)
    out.print(table)


def _moment(time) -> str:
    return f"{time:%Y-%m-%d %H:%M:%S}" if time else "-"
