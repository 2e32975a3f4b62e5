"""Measures what detail by tolerance saves, on one core.

A head of 512 guides of 10 cm and 10 elements of each hair type, without encoding: standing still,
in an unceasing small shake with a tolerance of 3 mm, and in a moderate one with 10 mm. Prints a
table, and as the last line one JSON object: time of a frame and elements stepped over those at full
detail, and how far the worst tip was from full detail in ten seconds. tests/bench/run builds what
it needs.
"""

import json

from program import result_of


def main() -> None:
    result = result_of("detail", "detail", __doc__)

    print(f"{'over full detail':<28}{'time':>8}{'elements':>10}{'worst tip':>12}")
    for hair, scenes in result.items():
        for scene, numbers in scenes.items():
            tip = f"{1e3 * numbers['worst_tip_m']:.2f} mm"
            print(
                f"{hair + ', ' + scene.replace('_', ' '):<28}{numbers['time_ratio']:>8.2f}"
                f"{numbers['elements_ratio']:>10.2f}{tip:>12}"
            )
    print(json.dumps(result))


if __name__ == "__main__":
    main()
