"""Options of commands that make hair: what it meets."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from mane.bodies import Body, Material
from mane.groom import Groom
from mane.mesh import load_obj



def _wisp_radius(value: float) -> float:
    if not 0 <= value <= 0.1:  # A range of the option's own is wrong about NaN.
        raise typer.BadParameter(f"{value} is not a finite number in [0, 0.1]")
    return value


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
