"""The comparison with other rod codes, as far as it needs none of them: its reference and table."""

import math
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent / "bench"))

from rods import elastica, strand, table
from rods.strand import Row


@pytest.mark.parametrize("number", [0.01, 0.1, 0.3])
def test_elastica_agrees_with_its_series_at_small_loads(number: float) -> None:
    x, z = elastica.tip(number)
    series_x, series_z = elastica.tip_series(number)
    # The terms left out, with room in their factors, and the solver's tolerance.
    assert x == pytest.approx(series_x, abs=3e-4 * number**4 + 1e-9)
    assert z == pytest.approx(series_z, abs=1e-4 * number**5 + 1e-9)


def test_elastica_series_leaves_out_the_powers_it_says() -> None:
    def left_out(number: float) -> list[float]:
        pairs = zip(elastica.tip(number), elastica.tip_series(number), strict=True)
        return [solved - series for solved, series in pairs]

    ratios = [a / b for a, b in zip(left_out(0.8), left_out(0.4), strict=True)]
    assert ratios == pytest.approx([2**4, 2**5], rel=0.1)


def test_elastica_hangs_like_a_heavy_thread_in_the_limit() -> None:
    # The bend is confined to the root: a tip that hangs straight, off by about G^(-1/3).
    assert math.dist(elastica.tip(1e4), (0, -1)) < 3 * 1e4 ** (-1 / 3)


def test_reference_tip_of_the_strand() -> None:
    assert pytest.approx(83.285, abs=1e-3) == strand.NUMBER
    assert strand.reference_tip() == pytest.approx((35.540e-3, -186.197e-3), abs=1e-6)
    assert strand.tip_error(*strand.unit_reference_tip()) == 0


MANE = [Row("mane", 5, 1 / 60, 1.0, 2e-2), Row("mane", 10, 1 / 60, 2.0, 5e-3)]


@pytest.mark.parametrize(
    ("error", "factor"),
    [(5e-2, 8.0), (2e-2, 8.0), (1e-2, 4.0), (1e-3, None), (None, None)],
)
def test_a_peer_is_compared_at_equal_or_smaller_error(error, factor) -> None:
    peer = Row("peer", 10, 1 / 120, 4.0, error)
    assert table.times_dearer(peer, MANE) == (factor and pytest.approx(factor))


def test_the_factor_is_that_of_the_closest_peer() -> None:
    peers = [Row("slow", 5, 1 / 60, 9.0, 1e-1), Row("fast", 5, 1 / 60, 0.5, 1e-1)]
    answer = table.summary([*MANE, *peers], MANE)
    assert answer["cheaper_at_equal_or_smaller_error"] == 0.5
    assert [row["name"] for row in answer["peers"]] == ["mane", "mane", "slow", "fast"]
    assert answer["peers"][2]["us_per_frame_60hz"] == 9.0


def test_nothing_is_claimed_without_a_comparable_peer() -> None:
    better = Row("better", 100, 1 / 60, 50.0, 1e-6)
    answer = table.summary([*MANE, better], MANE)
    assert answer["cheaper_at_equal_or_smaller_error"] is None


def test_the_table_has_a_line_for_each_row() -> None:
    rows = [*MANE, Row("explicit", 10, 1e-8, 8.0, None)]
    assert len(table.text(rows, MANE).splitlines()) == 2 + len(rows)
