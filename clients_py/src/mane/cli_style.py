"""`mane style`: hairstyles, from a preset or a document to a groom."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from mane import cli_bodies, grey_png, scalp_maps
from mane.beam_style import BeamStyle
from mane.bodies import Material, ScalpContact
from mane.cli_motion import writable
from mane.client import Client
from mane.convert import UNITS_M
from mane.errors import InvalidArgument, NotFound
from mane.groom import HairType
from mane.hairstyle import Hairstyle, StyleReport
from mane.jobs import Job
from mane.progress import err, listing, out, waiting, watched
from mane.strands import ImportOptions
from mane.style import GUIDES, Style
from mane.styles import load_style

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode="markdown",
    help="Make hairstyles: wisps or bending beams that are combed, cut and tied.",
)

_STYLE = "A style's .json file, or the name of a preset."
_Image = Annotated[
    Path,
    typer.Option(
        "-o", "--output", dir_okay=False, callback=writable, help="The PNG file to write."
    ),
]


@app.command()
def presets(context: typer.Context) -> None:
    """List the styles that the server ships.

    Examples:

    ```
    mane style presets
    ```
    """
    table = listing("name", "what")
    for preset in context.obj.style_presets():
        table.add_row(preset.name, preset.description)
    out.print(table)


@app.command()
def show(
    context: typer.Context,
    name: Annotated[str, typer.Argument(help="Of the preset, as `mane style presets` says it.")],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            dir_okay=False,
            callback=writable,
            help="The .json file to write; else it is printed.",
        ),
    ] = None,
) -> None:
    """Write a preset as a document to edit.

    Examples:

    ```
    mane style show bob
    mane style show ponytail -o tail.json
    mane style show beam-bob
    ```

    The document says only what differs from the API's defaults. `proto/mane/v1/style.proto`
    describes every field; that of a style by beams, all of whose document is its field
    `beam_style`, `proto/mane/v1/beam_style.proto`. A field that there is not is refused by name
    when the style is applied.
    """
    style = _preset(context.obj, name)
    if output is None:
        out.print(style.to_json(), end="", markup=False)
    else:
        style.save(output)
        out.print(f"{output}: {name}")


@app.command()
def apply(
    context: typer.Context,
    style: Annotated[str, typer.Argument(metavar="STYLE.json|PRESET", help=_STYLE)],
    groom_id: Annotated[
        str,
        typer.Option(
            "-o",
            "--output",
            metavar="GROOM",
            help="Last part of the groom's name: a-z, 0-9 and -, at most 63 letters.",
        ),
    ],
    scalp: cli_bodies.Scalp = None,
    group: cli_bodies.Group = None,
    unit: cli_bodies.Unit = "m",
    strands: Annotated[
        int | None, typer.Option(min=0, help="How many hairs, in place of the style's.")
    ] = None,
    wisps: Annotated[
        int | None,
        typer.Option(min=1, help="How many wisps, or of beams guides, in place of the style's."),
    ] = None,
    seed: Annotated[
        int | None, typer.Option(min=0, help="Of everything random, in place of the style's.")
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option(
            dir_okay=False,
            callback=writable,
            help="Also draw it from the front, the side and behind, into this PNG file.",
        ),
    ] = None,
    npz: Annotated[
        Path | None,
        typer.Option(
            dir_okay=False, callback=writable, help="Also keep all hair in this .npz file."
        ),
    ] = None,
    hair_type: Annotated[
        HairType, typer.Option(help="Preset of the guides' thickness, stiffness and damping.")
    ] = HairType.CAUCASIAN_WAVY,
    elements: Annotated[
        int, typer.Option(min=0, max=64, help="Helical elements per guide; 0 means 20.")
    ] = GUIDES.element_count,
    scalp_contact: cli_bodies.Contact = False,
    body: cli_bodies.Bodies = None,
    body_material: cli_bodies.BodyMaterial = Material.UNSPECIFIED,
    display_name: Annotated[str, typer.Option(help="Free text.")] = "",
) -> None:
    """Make a style on a head, and keep it on the server as a groom.

    Master strands, one a wisp, grow from the scalp, fall, make room for each other, and go where
    constraints lead them; members fill every wisp around its master. The masters become the groom's
    guides, which `mane animate` moves, the members its hairs. A style by beams bends every hair on
    its own instead, around an ellipsoid that stands for the head; some hairs become guides.

    Examples:

    ```
    mane style apply bob -o bob --picture bob.png
    mane style apply tail.json -o anna --scalp body.obj --group body --unit dm --scalp-contact
    mane style apply bob -o small --strands 5000 --seed 7 --npz small.npz
    mane style apply beam-swept-back -o swept --picture swept.png
    mane animate walk.bvh -g bob -o walk.npz
    ```

    Says which constraints some of their wisps missed, being too short or held back, and what each
    stage took. Interrupting this command cancels the job. The .npz file holds points and counts of
    the strands, wisps, colours, masters, density and maps; `mane style picture` draws it. The unit
    is that of all OBJ files.
    """
    client: Client = context.obj
    chosen = _changed(_style(client, style), strands, wisps, seed)
    head = cli_bodies.load_scalp(scalp, group, unit)
    bodies = cli_bodies.load_bodies(body, body_material, UNITS_M[unit])
    with waiting("uploading"):
        job = client.apply_style(
            chosen,
            scalp=head,
            scalp_contact=ScalpContact(Material.SKIN) if scalp_contact else None,
            bodies=bodies,
            guides=ImportOptions(hair_type, element_count=elements, error_bound_m=0),
            groom_id=groom_id,
            display_name=display_name,
        )
    _wait(client, job)
    with waiting("fetching the hair"):
        hairstyle = client.read_hairstyle(job)
    report = hairstyle.report
    out.print(f"{report.groom}: {report.wisp_count} guides, {report.strand_count} hairs")
    _print_report(hairstyle)
    sagging = client.import_report(report.groom).summary.not_held_count
    if sagging:
        out.print(f"{sagging} guides do not hold their shape: see `mane groom report`")
    out.print(f"made by {job.name}")
    if npz:
        hairstyle.save(npz)
        out.print(f"{npz}: {report.strand_count} strands, {report.control_point_count} points")
    if picture:
        _draw(picture, hairstyle, head, groom_id)


@app.command("map")
def map_(
    context: typer.Context,
    style: Annotated[
        str,
        typer.Argument(
            metavar="STYLE.json|PRESET|JOB",
            help=_STYLE + " Or the job that made one, such as jobs/3f2a.",
        ),
    ],
    name: Annotated[str, typer.Argument(help=f"One of {', '.join(scalp_maps.UNSET)}.")],
    output: _Image,
    size: Annotated[
        int, typer.Option(min=1, max=grey_png.LARGEST_SIDE, help="Pixels of a side; not of jobs.")
    ] = 512,
) -> None:
    """Draw one of a style's maps, to look at or to paint on.

    Examples:

    ```
    mane style map tail.json length -o length.png
    mane style map jobs/3f2a density -o density.png
    ```

    The picture shows the head from above: the crown in the middle, the forehead at the bottom, the
    head's left at the right. The circle that fills it is straight down. White is the map's largest
    value, which is printed along with the line of Python that takes a painted picture back:

    ```
    style = mane.Style.load("tail.json")
    style.with_map("length", value=0.25, image="length.png").save("tail.json")
    ```
    """
    if name not in scalp_maps.UNSET:
        raise typer.BadParameter(
            f"{name!r} is not one of {', '.join(scalp_maps.UNSET)}", param_hint="NAME"
        )
    if style.startswith("jobs/"):
        values = context.obj.read_hairstyle(style).maps.get(name)
    else:
        chosen = _style(context.obj, style)
        by_wisps = isinstance(chosen, Style)
        values = scalp_maps.drawn(chosen.message, name, size) if by_wisps else None
    if values is None:
        raise InvalidArgument.of("style", f"{style} is made of beams, which have no maps")
    white = float(values.max()) or 1.0
    output.write_bytes(grey_png.encode(values / white))
    out.print(f"{output}: {name}, white is {white:g}")
    out.print(f"style.with_map({name!r}, value={white:g}, image={str(output)!r})", markup=False)


@app.command()
def picture(
    context: typer.Context,
    source: Annotated[
        str,
        typer.Argument(
            metavar="HAIR.npz|JOB",
            help="File that `mane style apply --npz` wrote, or the job, such as jobs/3f2a.",
        ),
    ],
    output: _Image,
    scalp: cli_bodies.Scalp = None,
    group: cli_bodies.Group = None,
    unit: cli_bodies.Unit = "m",
    title: Annotated[str, typer.Option(help="Is written into the picture.")] = "",
    size: Annotated[
        int, typer.Option(min=16, help="Pixels of a view's side, a multiple of 16.")
    ] = 640,
) -> None:
    """Draw every strand of a hairstyle, in its colour, from the front, the side and behind.

    Examples:

    ```
    mane style picture bob.npz -o bob.png
    mane style picture jobs/3f2a -o tail.png --scalp body.obj --group body --unit dm --size 960
    ```
    """
    if source.startswith("jobs/"):
        with waiting("fetching the hair"):
            hairstyle = context.obj.read_hairstyle(source)
    else:
        hairstyle = Hairstyle.load(source)
    _draw(output, hairstyle, cli_bodies.load_scalp(scalp, group, unit), title, size)


def _style(client: Client, text: str) -> Style | BeamStyle:
    """The style of a file, or the preset of that name."""
    return load_style(text) if text.endswith(".json") else _preset(client, text)


def _preset(client: Client, name: str) -> Style | BeamStyle:
    known = {preset.name: preset.style for preset in client.style_presets()}
    if name not in known:
        raise NotFound(f"there is no preset {name!r}; there are {', '.join(known)}")
    return known[name]


def _changed(
    style: Style | BeamStyle, strands: int | None, wisps: int | None, seed: int | None
) -> Style | BeamStyle:
    if isinstance(style, BeamStyle):
        given = {"guide_count": wisps, "seed": seed}
        if strands is not None:
            style = style.with_hair_count(strands)
    else:
        given = {"strand_count": strands, "wisp_count": wisps, "seed": seed}
    given = {name: number for name, number in given.items() if number is not None}
    return type(style)(style.message, **given)


def _wait(client: Client, job: Job) -> None:
    """Follows a job to its end. Raises JobFailed where it failed; an interrupt cancels it."""
    try:
        *_, last = watched(client.watch_job(job), f"styling {job.name}")
    except KeyboardInterrupt:
        client.cancel_job(job)
        err.print(f"cancelled {job.name}")
        raise
    last.require_success()


def _print_report(hairstyle: Hairstyle) -> None:
    report = hairstyle.report
    table = Table(box=None, show_header=False)
    stages = report.stages_s()
    rows = {"control points": f"{report.control_point_count}, of hairs"}
    if hairstyle.density is None:  # By beams.
        stages = {name: stages[name] for name in ("members", "guides")}
    else:
        rows["crowded segments"] = str(report.crowded_segments)
        rows["constraints"] = (
            f"{len(report.outcomes)}, {len(report.missed)} not met by all their wisps"
        )
    rows["seconds"] = ", ".join(f"{name} {seconds:.1f}" for name, seconds in stages.items())
    for row in rows.items():
        table.add_row(*row)
    out.print(table)
    if not report.missed:
        return
    table = listing("queue", "constraint", "met", "of wisps")
    for outcome in report.missed:
        table.add_row(
            outcome.queue_name or str(outcome.queue),
            str(outcome.constraint),
            str(outcome.met),
            str(outcome.selected),
        )
    out.print(table)


def _draw(path: Path, hairstyle: Hairstyle, head, title: str, size: int = 640) -> None:
    from mane.style_picture import draw_hairstyle  # Only here: it takes a while to load.

    with waiting("drawing"):
        draw_hairstyle(path, hairstyle, head, title=title, size=size)
    out.print(f"{path}: the hair from the front, the side and behind")
