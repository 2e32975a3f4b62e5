"""The command line `mane`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from mane import channel, cli_experiment, cli_groom, cli_job, cli_motion, cli_style
from mane.client import Client
from mane.errors import Error
from mane.progress import err, out

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
app.add_typer(cli_groom.app, name="groom")
app.add_typer(cli_style.app, name="style")
app.add_typer(cli_job.app, name="job")
app.add_typer(cli_experiment.app, name="experiment")
app.command()(cli_motion.animate)
app.command()(cli_motion.bake)


@app.callback()
def connect(
    context: typer.Context,
    server: Annotated[
        str, typer.Option(envvar=channel.SERVER_VARIABLE, help="Address of maned, host:port.")
    ] = channel.DEFAULT_SERVER,
    tls: Annotated[bool, typer.Option(help="Encrypt, trusting the system's authorities.")] = False,
    ca_file: Annotated[
        Path | None,
        typer.Option(
            exists=True, dir_okay=False, help="Encrypt, trusting the authorities in this PEM file."
        ),
    ] = None,
    token: Annotated[
        str | None,
        typer.Option(envvar="MANE_TOKEN", help="Bearer token; needs --tls or --ca-file."),
    ] = None,
) -> None:
    """Hair simulation as a service: grooms, hairstyles, moving heads of hair, bakes.

    A first tour, with `maned` running on this machine:

    ```
    mane status
    mane groom create demo --hair-type caucasian_wavy --guides 200 --length 0.25
    mane style apply bob -o bob --picture bob.png
    mane animate walk.bvh -g demo -o walk.npz --picture walk.png
    ```

    Options before the command, such as --server, hold for every command. Exit codes: 0 done,
    1 failed, 2 wrong usage.
    """
    client = Client(server, tls=tls, ca_file=ca_file, token=token)
    context.call_on_close(client.close)
    context.obj = client


@app.command()
def status(context: typer.Context) -> None:
    """Tell whether a server answers, and what it holds.

    Examples:

    ```
    mane status
    mane --server render-3:7420 status
    ```

    Exits with 1 where none answers or it does not serve.
    """
    client: Client = context.obj
    health = client.status()
    out.print(f"{health.server}: {health.state}, answers in {health.round_trip_ms:.1f} ms")
    if not health.serving:
        raise typer.Exit(1)
    grooms = sum(1 for _ in client.list_grooms(page_size=1000))
    running = sum(1 for job in client.list_jobs(page_size=1000) if not job.ended)
    out.print(f"grooms: {grooms}, unfinished jobs: {running}")


def main() -> None:
    """Runs the command line; what fails is said in one line."""
    try:
        app()
    except (Error, OSError) as error:
        message = " ".join(str(error).split())
        err.print(f"error: {message}", markup=False, style="red")
        raise SystemExit(1) from None
