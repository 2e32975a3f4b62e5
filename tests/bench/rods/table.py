"""The table of rows, and what it says in sum."""

from rods import strand
from rods.strand import Row


def times_dearer(row: Row, mane: list[Row]) -> float | None:
    """Cost of `row` for a frame over that of the cheapest of `mane` whose error is no larger.

    None for a row without an error, or one more accurate than any of `mane`.
    """
    if row.tip_error_over_L is None:
        return None
    costs = [
        candidate.us_per_frame
        for candidate in mane
        if candidate.tip_error_over_L is not None
        and candidate.tip_error_over_L <= row.tip_error_over_L
    ]
    return row.us_per_frame / min(costs) if costs else None


def text(rows: list[Row], mane: list[Row]) -> str:
    columns = "{:40} {:>8} {:>10} {:>14} {:>14} {:>12} {:>8}"
    lines = [
        columns.format(
            "code", "segments", "step", "us per strand", "us per strand", "tip error", "x"
        ),
        columns.format("", "", "[ms]", "and step", "and 1/60 s", "/ L", "mane"),
    ]
    for row in rows:
        dearer = None if row in mane else times_dearer(row, mane)
        error = row.tip_error_over_L
        lines.append(
            columns.format(
                row.name,
                row.segments,
                f"{row.dt * 1e3:.3g}",
                f"{row.us_per_strand_step:.3g}",
                f"{row.us_per_frame:.4g}",
                "-" if error is None else f"{error:.2e}",
                "-" if dearer is None else f"{dearer:.3g}",
            )
        )
    return "\n".join(lines)


def summary(rows: list[Row], mane: list[Row]) -> dict:
    """The last line. The factor is that of the peer that comes closest to Mane."""
    factors = [times_dearer(row, mane) for row in rows if row not in mane]
    known = [factor for factor in factors if factor is not None]
    return {
        "peers": [row.entry() for row in rows],
        "reference_tip_m": [round(value, 9) for value in strand.reference_tip()],
        "cheaper_at_equal_or_smaller_error": float(f"{min(known):.3g}") if known else None,
    }
