"""`mane groom import` and `mane groom report`: hair of other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.table import Table

from mane import cli_bodies
from mane.bodies import Material
from mane.client import Client
from mane.convert import CONVENTIONS, UNITS_M
from mane.groom import Groom, HairType
from mane.pose import Pose
from mane.progress import listing, out, waiting
from mane.strand_files import load_strands, thinned
from mane.strands import ImportOptions, ImportReport, ImportSummary, Strand

_SETTLE_S = 5.0
_RATE_HZ = 60.0
_WORST = 5  # Strands that are listed one by one.


def import_(
    context: typer.Context,
    file: Annotated[
        Path,
        typer.Argument(exists=True, dir_okay=False, help=".npz, .json, .csv, .hair or .data file."),
    ],
    groom_id: Annotated[
        str, typer.Argument(help="Last part of the name: a-z, 0-9 and -, at most 63 letters.")
    ],
    hair_type: Annotated[
        HairType, typer.Option(help="Preset of thickness, stiffness and damping; not of the curl.")
    ] = HairType.CAUCASIAN_WAVY,
    elements: Annotated[
        int, typer.Option(min=0, max=64, help="Most helical elements per strand; 0 means 20.")
    ] = 0,
    error_bound: Annotated[
        float,
        typer.Option(
            min=0, max=1, help="Largest distance from the points, metres; 0: none, --elements each."
        ),
    ] = 0.001,
    hold: Annotated[
        bool, typer.Option(help="Solve for natural curvatures with which the hair does not sag.")
    ] = True,
    max_stiffness: Annotated[
        float, typer.Option(min=1, max=1000, help="Largest factor on stiffness to hold a shape.")
    ] = 4.0,
    strands: Annotated[
        int, typer.Option(min=0, help="Take so many strands, evenly out of the file; 0: all.")
    ] = 0,
    points: Annotated[
        int, typer.Option(min=0, max=1000, help="Most points of a strand; 0: all.")
    ] = 100,
    unit: Annotated[str, typer.Option(help=f"Unit of the file: {', '.join(UNITS_M)}.")] = "m",
    axes: Annotated[
        str, typer.Option(help=f"Axes of the file: {', '.join(CONVENTIONS)}.")
    ] = "mane",
    body: cli_bodies.Bodies = None,
    body_material: cli_bodies.BodyMaterial = Material.UNSPECIFIED,
    wisp_radius: cli_bodies.WispRadius = 0.0,
    display_name: Annotated[str, typer.Option(help="Free text.")] = "",
    picture: Annotated[
        Path | None,
        typer.Option(help="Also animate five seconds at rest, and draw the hair before and after."),
    ] = None,
) -> None:
    """Import strands of another program as guides that rest in the shape that they have.

    Each strand is a line of points, root first, in metres and in the frame of an upright head that
    looks along +Z; --unit and --axes convert. A file holds them as

    - `.npz`: `points` (strand, point, 3), or `points` (all, 3) and `counts` (strand,)

    - `.json`: a list of strands, each a list of `[x, y, z]`

    - `.csv`: a line `strand,x,y,z`, then a line for every point

    - `.hair`: Cem Yuksel's HAIR format; `.data`: USC-HairSalon

    Two steps make a guide of a strand. A fit by helical elements follows the points; what stays
    farther away than --error-bound is reported, and more --elements help. Then natural curvatures
    are found with which the shape is at rest under its weight. Where hair is too soft for its
    shape, and would buckle, stiffness is raised up to --max-stiffness times; what still does not
    hold is reported, with the factor that it needs. Stiffer is also a --hair-type with thicker
    hair. Modelled without weight, hair should sag: --no-hold. OBJ files of bodies are in metres.

    Examples:

    ```
    mane groom import bob.npz bob
    mane groom import wWavy.hair wavy --unit cm --axes z_up --strands 500 --elements 30
    mane groom import bun.json bun --hair-type asian_smooth --max-stiffness 20 --picture bun.png
    mane groom report bun
    ```
    """
    client: Client = context.obj
    for value, known, option in ((unit, UNITS_M, "--unit"), (axes, CONVENTIONS, "--axes")):
        if value not in known:
            raise typer.BadParameter(
                f"{value!r} is not one of {', '.join(known)}", param_hint=option
            )
    given = thinned(load_strands(file, unit, axes), strands, points)
    options = ImportOptions(
        hair_type=hair_type,
        element_count=elements,
        error_bound_m=error_bound,
        hold=hold,
        max_stiffness_factor=max_stiffness,
        wisp_radius_m=wisp_radius,
    )
    with waiting(f"importing {len(given)} strands"):
        groom = client.create_groom(
            strands=map(Strand, given),
            import_options=options,
            bodies=cli_bodies.load_bodies(body, body_material, 1.0),
            groom_id=groom_id,
            display_name=display_name,
        )
    out.print(f"{groom.name}: {groom.guide_count} guides, {groom.element_count} elements")
    _print_summary(groom.import_summary, options)
    _print_worst(client.import_report(groom))
    if picture:
        _draw(client, groom, given, picture)


def report(
    context: typer.Context, groom: Annotated[str, typer.Argument(help="Name, such as demo.")]
) -> None:
    """Show how closely imported strands were fitted, and which did not hold.

    Examples:

    ```
    mane groom report bob
    ```
    """
    told = context.obj.import_report(groom)
    _print_summary(told.summary, told.options)
    _print_worst(told)


def _print_summary(summary: ImportSummary, options: ImportOptions) -> None:
    bound = f"{1e3 * options.error_bound_m:g} mm" if options.error_bound_m else "none"
    table = Table(box=None, show_header=False)
    rows = {
        "strands": f"{summary.strand_count}, of {summary.point_count} points",
        "largest fit distance": _mm(summary.largest_fit_distance_m),
        "rms fit distance": _mm(summary.rms_fit_distance_m),
        "missed the bound": f"{summary.bound_missed_count} (bound: {bound})",
        "do not hold" if options.hold else "sag": str(summary.not_held_count),
        "largest tip deviation": _mm(summary.largest_tip_deviation_m),
        "largest stiffness factor": f"{summary.largest_stiffness_factor:.2f}",
    }
    for row in rows.items():
        table.add_row(*row)
    out.print(table)


def _print_worst(told: ImportReport) -> None:
    """The strands that missed the bound or do not hold, the worst of them."""
    bad = np.flatnonzero(~told.bounds_met | ~told.held)
    if not bad.size:
        return
    harm = np.maximum(told.largest_fit_distances, told.largest_deviations)
    worst = bad[np.argsort(-harm[bad], kind="stable")][:_WORST]
    table = listing("strand", "elements", "fit distance", "held", "tip moves", "factor", "needed")
    for index in worst:
        needed = told.needed_stiffness_factors[index]
        table.add_row(
            str(index),
            str(told.element_counts[index]),
            _mm(told.largest_fit_distances[index]),
            "yes" if told.held[index] else "no",
            _mm(told.tip_deviations[index]),
            f"{told.stiffness_factors[index]:.2f}",
            f"{needed:.2f}" if needed else "",
        )
    out.print(f"the worst {len(worst)} of {bad.size} strands that missed the bound or do not hold:")
    out.print(table)


def _draw(client: Client, groom: Groom, given: list[np.ndarray], picture: Path) -> None:
    from mane.strand_picture import draw_import  # Only here: it takes a while to load.

    with (
        waiting(f"animating {_SETTLE_S:g} s and drawing"),
        client.open_head(groom, "lockstep", points_per_guide=64) as head,
    ):
        for step in range(round(_SETTLE_S * _RATE_HZ) + 1):
            frame = head.step(Pose(step / _RATE_HZ))
        draw_import(picture, given, frame.positions, f"after {_SETTLE_S:g} s")
    out.print(f"{picture}: the hair as given (orange) and after {_SETTLE_S:g} s (dark)")


def _mm(metres: float) -> str:
    return f"{1e3 * metres:.3f} mm"
