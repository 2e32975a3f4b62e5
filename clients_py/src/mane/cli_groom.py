"""`mane groom`: the hair that a server holds."""

from __future__ import annotations

from typing import Annotated

import typer
from rich.table import Table

from mane import cli_bodies, cli_import
from mane.bodies import Material, ScalpContact
from mane.client import Client
from mane.convert import UNITS_M
from mane.groom import Groom, GuideGeneration, HairType, StrandModel
from mane.progress import listing, out, waiting

app = typer.Typer(
    no_args_is_help=True, rich_markup_mode="markdown", help="Make and look after hair."
)


app.command("import")(cli_import.import_)
app.command("report")(cli_import.report)


@app.command()
def create(
    context: typer.Context,
    groom_id: Annotated[
        str, typer.Argument(help="Last part of the name: a-z, 0-9 and -, at most 63 letters.")
    ],
    hair_type: Annotated[
        HairType, typer.Option(help="Preset of the hair's physics and curl.")
    ] = HairType.CAUCASIAN_WAVY,
    guides: Annotated[int, typer.Option(min=1, help="How many guide strands.")] = 200,
    length: Annotated[float, typer.Option(help="Length of the strands, metres.")] = 0.2,
    elements: Annotated[
        int, typer.Option(min=0, help="Helical elements per strand; 0 lets the server choose.")
    ] = 0,
    model: Annotated[
        StrandModel | None,
        typer.Option(
            help="How elements describe strands: wound is for hair of many turns; "
            "the server chooses unless given."
        ),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Same seed, same hair.")] = 0,
    scalp: cli_bodies.Scalp = None,
    group: cli_bodies.Group = None,
    unit: cli_bodies.Unit = "m",
    scalp_contact: cli_bodies.Contact = False,
    body: cli_bodies.Bodies = None,
    body_material: cli_bodies.BodyMaterial = Material.UNSPECIFIED,
    wisp_radius: cli_bodies.WispRadius = 0.0,
    display_name: Annotated[str, typer.Option(help="Free text.")] = "",
) -> None:
    """Grow hair on a head and keep it on the server.

    Examples:

    ```
    mane groom create demo
    mane groom create afro --hair-type african_fuzzy --length 0.1 --guides 400 --model wound
    mane groom create anna --scalp body.obj --group body --unit dm
    mane groom create eve --scalp-contact --body collar=collar.obj --body-material cotton
    ```

    The unit is that of all OBJ files.
    """
    client: Client = context.obj
    head = cli_bodies.load_scalp(scalp, group, unit)
    bodies = cli_bodies.load_bodies(body, body_material, UNITS_M[unit])
    generate = GuideGeneration(
        hair_type, guides, length, elements, seed, model=model, wisp_radius_m=wisp_radius
    )
    with waiting(f"growing {guides} guides"):
        groom = client.create_groom(
            scalp=head,
            scalp_contact=ScalpContact(Material.SKIN) if scalp_contact else None,
            bodies=bodies,
            generate=generate,
            groom_id=groom_id,
            display_name=display_name,
        )
    out.print(f"{groom.name}: {groom.guide_count} guides, {groom.element_count} elements")


@app.command("list")
def list_(context: typer.Context) -> None:
    """List all grooms.

    Examples:

    ```
    mane groom list
    ```
    """
    table = listing("name", "hair", "guides", "elements", "longest", "created", "title")
    for groom in context.obj.list_grooms():
        table.add_row(
            groom.name,
            _hair(groom),
            str(groom.guide_count),
            str(groom.element_count),
            f"{groom.longest_guide_m:.3f} m",
            f"{groom.create_time:%Y-%m-%d %H:%M}",
            groom.display_name,
        )
    out.print(table)


@app.command()
def show(
    context: typer.Context, groom: Annotated[str, typer.Argument(help="Name, such as demo.")]
) -> None:
    """Show one groom.

    Examples:

    ```
    mane groom show demo
    ```
    """
    found = context.obj.get_groom(groom)
    table = Table(box=None, show_header=False)
    rows = {
        "name": found.name,
        "title": found.display_name,
        "created": f"{found.create_time:%Y-%m-%d %H:%M:%S} UTC",
        "hair": _hair(found),
        "seed": str(found.seed),
        "guides": str(found.guide_count),
        "elements": str(found.element_count),
        "hairs": str(found.hair_count),
        "longest": f"{found.longest_guide_m:.3f} m",
        "scalp": "yes" if found.has_scalp else "no",
        "meets": cli_bodies.met_by(found),
        "etag": found.etag,
    }
    for row in rows.items():
        table.add_row(*row)
    out.print(table)


@app.command()
def delete(
    context: typer.Context,
    grooms: Annotated[list[str], typer.Argument(help="Names, such as demo.")],
) -> None:
    """Delete grooms. Heads that show them go on.

    Examples:

    ```
    mane groom delete demo
    mane groom delete afro anna
    ```
    """
    for groom in grooms:
        context.obj.delete_groom(groom)
        out.print(f"deleted {groom}")


def _hair(groom: Groom) -> str:
    if groom.import_summary:
        return "imported"
    return str(groom.hair_type) if groom.hair_type else "uploaded"
