"""`mane experiment`: scenes of [SH06], [AUK92] and of rod mechanics, held against theory."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from mane.progress import err, out, waiting

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode="markdown",
    help="Scenes of the Super-Helix paper, of beams and of rod mechanics, played on the server and "
    "held against theory.",
)

_Folder = Annotated[
    Path, typer.Option("--out", file_okay=False, help="Folder for figures and numbers.")
]
_Quick = Annotated[bool, typer.Option("--quick", help="Fewer cases: seconds instead of minutes.")]

_HELP = {
    "curly-clump": """
    Shake a curly clump up and down, and see its span against internal friction gamma.

    Figure 6 of the Super-Helix paper fits gamma to such a clump. The more friction, the smaller the
    swing of the span; where friction rules, it falls as 1 / gamma.
    """,
    "pendulum": """
    Let a hanging strand swing, and see how fast air drag nu damps it.

    Without internal friction every vibration decays at nu / (2 rho S). The time step adds some,
    which a sweep of steps tells apart; the frequency is that of a heavy rod.
    """,
    "buckling": """
    See an upright strand fall over by its weight, and strands buckle over a shaken root.

    The critical length is Greenhill's, 1.986 (EI / (rho S g))^(1/3). Roots that go up and down make
    strands sway where Floquet's theory says so (figure 7 of the Super-Helix paper).
    """,
    "head-shake": """
    Shake a whole head of every hair type: pictures at several times, and what the tips do.

    Strands keep their length, and come to rest at least as fast as air drag says.
    """,
    "cantilever": """
    See how far straight strands sag from a horizontal clamp, against the gravito-bending number.

    rho S g L^3 / EI alone decides: the master curve is that of the heavy elastica. Tips of N = 5,
    10 and 20 elements are compared with it.
    """,
    "fabrics": """
    Draw fabrics of several materials along under hair, with and against its scales.

    On a slope hair is deflected by friction's part of its weight, from which the coefficient
    follows: mu_0 (1 + alpha cos(angle between sliding and tangent)), as in section 4.2 of the
    Super-Helix paper.
    """,
    "shoulders": """
    Let somebody with long hair walk, and see how deep hair gets in head, torso and arms.

    At most 1 mm while the body stands, 3 mm while it walks; hair that has stood for five seconds
    has no tip faster than 1 mm/s. Pictures show the walk. A body and a recorded walk of your own:
    `--body body.obj --group body --unit 0.1 --motion walk.bvh`.
    """,
    "stick-slip": """
    Tilt slabs with hair across them, and see at which angle it slides, for mu of 0.1 to 1.

    That is Coulomb's angle of friction, atan(mu); below it hair stays where it is.
    """,
    "bend-twist": """
    See when a naturally curved strand in a horizontal clamp leaves its plane, and where it rests.

    Gravito-bending number and natural angle decide. The border, and tips of N = 5, 10 and 20
    elements, are compared with converged equilibria of a Kirchhoff rod.
    """,
    "wisps-collide": """
    Let a wisp swing into another, and a curtain of stiff hair catch what a head leaves behind.

    The sum of their momenta goes on as if they did not meet; they are pressed together, but none
    passes through the other, nor through the curtain at up to 4 m/s, from three distances.
    """,
    "cohesion": """
    Shake a clump of three guides, straight, wavy and curly, with wisps and without.

    Wisps that rub and hold each other leave tips at most 0.7 of the spread that they have without.
    """,
    "gust": """
    Blow at long hair of beams, and turn the wind: figure 10 of Anjyo, Usami and Kurihara, 1992.

    Ends go on with the old wind while what is near the pores falls with the new one, so that hair
    undulates. Nodes are those of the published recurrences, integrated in double precision.
    """,
    "bangs": """
    Press bangs of beams on a forehead, and count the nodes that get in: after their figure 11.

    As it is, the field takes a third of the nodes through the head. The published pseudo-force
    keeps all out for ten frames, turning nodes out of the head's ellipsoid for ever.
    """,
    "flutter": """
    Let short hair of beams fluctuate in a wind that turns, with and without stiff joints.

    Figure 12 of the same paper: joints that turn by at most 12 degrees make more of fluctuations,
    and yet smooth curves. Spectra along the hair show that long waves grow and short ones go.
    """,
    "beams": """
    Animate the same heads as beams and as Super-Helices, and change over between the two.

    Half periods, swings and decay after a stop and in a shake, and the time of a frame, side by
    side. Beams keep their length and the rest shape, and hair does not jump where the model
    changes.
    """,
}

_MORE = """

    Examples:

    ```
    mane experiment {name}
    mane experiment {name} --out results --quick
    ```

    Writes NAME-PART.png, NAME-PART.csv and NAME.json, and prints what theory says beside what was
    measured. Exits with 1 where they disagree. Needs `mane[pictures]`; its grooms are deleted.
    """


def _command(name: str) -> Callable:
    def experiment(
        context: typer.Context, folder: _Folder = Path("."), quick: _Quick = False
    ) -> None:
        _run(name, context.obj, folder, quick)

    return experiment


def _shoulders(
    context: typer.Context,
    folder: _Folder = Path("."),
    quick: _Quick = False,
    body: Annotated[
        Path | None,
        typer.Option(
            exists=True,
            dir_okay=False,
            help="OBJ file of a body, Y up, face toward +Z, arms away from it; else the mannequin.",
        ),
    ] = None,
    group: Annotated[
        str | None, typer.Option(help="Group of the OBJ file that is the skin; else all of it.")
    ] = None,
    unit: Annotated[float, typer.Option(help="Length of the OBJ file's unit, metres.")] = 1.0,
    motion: Annotated[
        Path | None,
        typer.Option(
            exists=True, dir_okay=False, help="BVH file of a walk with CMU's joints; else a clip."
        ),
    ] = None,
) -> None:
    _run(
        "shoulders", context.obj, folder, quick, body=body, group=group, unit_m=unit, motion=motion
    )


def _run(name: str, client, folder: Path, quick: bool, **options) -> None:
    from mane.experiments.report import Report  # Only here: solvers take a while to load.

    report = Report(name, folder)
    module = importlib.import_module(f"mane.experiments.{name.replace('-', '_')}")
    with waiting(f"{name} on {client.server}"):
        module.run(client, report, quick, **options)
    report.write()
    _print(report)
    if not report.holds:
        err.print(f"{name}: measurement and theory disagree", style="red")
        raise typer.Exit(1)


def _print(report) -> None:
    table = Table("", "", "theory", "measured", box=None)
    for fact in report.facts:
        table.add_row("ok" if fact.holds else "OFF", fact.what, fact.theory, fact.measured)
    out.print(table, markup=False)
    for path in report.files:
        out.print(str(path.absolute()), markup=False)


for _name, _text in _HELP.items():
    _function = _shoulders if _name == "shoulders" else _command(_name)
    app.command(_name, help=_text + _MORE.replace("{name}", _name))(_function)
