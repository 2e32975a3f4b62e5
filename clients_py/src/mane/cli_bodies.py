"""Options of commands that make hair: the head it grows on, and what it meets."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from mane.bodies import Body, Material
from mane.convert import UNITS_M
from mane.errors import InvalidArgument
from mane.groom import Groom
from mane.mesh import Mesh, load_head, load_obj, mannequin


def _unit(value: str) -> str:
    if value not in UNITS_M:
        raise typer.BadParameter(f"{value!r} is not one of {', '.join(UNITS_M)}")
    return value


def _wisp_radius(value: float) -> float:
    if not 0 <= value <= 0.1:  # A range of the option's own is wrong about NaN.
        raise typer.BadParameter(f"{value} is not a finite number in [0, 0.1]")
    return value


Scalp = Annotated[
    Path | None,
    typer.Option(
        exists=True,
        dir_okay=False,
        help="OBJ file of a head or body, Y up; without it hair grows on Mane's mannequin.",
    ),
]
Group = Annotated[
    str | None, typer.Option(help="Group of the OBJ file that is skin; all unless given.")
]
Unit = Annotated[
    str, typer.Option(callback=_unit, help=f"Unit of the OBJ files: {', '.join(UNITS_M)}.")
]
Contact = Annotated[
    bool, typer.Option(help="Let hair meet head and shoulders, of skin, and not pass through.")
]
Bodies = Annotated[
    list[str] | None,
    typer.Option(
        "--body",
        metavar="NAME=FILE.obj",
        help="A solid in the head frame that hair meets, fixed to the head; may be repeated.",
    ),
]
BodyMaterial = Annotated[Material, typer.Option(help="What the bodies are made of.")]
WispRadius = Annotated[
    float,
    typer.Option(
        callback=_wisp_radius,
        help="Of each guide's wisp, which others stay out of, 0 to 0.1 metres.",
    ),
]


def load_scalp(scalp: Path | None, group: str | None, unit: str) -> Mesh:
    """The head of a file, or the mannequin. InvalidArgument names `scalp`."""
    try:
        return load_head(scalp, group, UNITS_M[unit]) if scalp else mannequin()
    except ValueError as error:
        raise InvalidArgument.of("scalp", str(error)) from error


def load_bodies(given: list[str] | None, material: Material, unit_m: float) -> list[Body]:
    """Bodies of `NAME=FILE.obj`. BadParameter for what is not of that form or names no file."""
    bodies = []
    for text in given or ():
        name, _, file = text.partition("=")
        if not name or not Path(file).is_file():
            raise typer.BadParameter(
                f"{text!r} is not NAME=FILE.obj with a file that is there", param_hint="--body"
            )
        bodies.append(Body(name, load_obj(file, unit_m=unit_m), material=material))
    return bodies


def met_by(groom: Groom) -> str:
    """What the hair of a groom meets, for people."""
    told = [] if groom.scalp_contact is None else ["scalp"]
    for body in groom.body_summaries:
        kind = body.shape if body.mesh is None else f"mesh of {body.mesh.triangles} triangles"
        holes = f", {body.mesh.holes} holes closed" if body.mesh and body.mesh.holes else ""
        told.append(f"{body.name} ({kind}{holes}{', moving' if body.moving else ''})")
    return ", ".join(told) or "nothing"
