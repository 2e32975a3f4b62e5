"""Times hairs as beams ([AUK92]) on this machine.

style_20k_ms is a bob of 20,000 hairs of 20 segments, combed and cut, from nothing on two workers (goal:
50). frame_20k_ms_one_core and frame_50k_ms are a frame of moving hair, 20,000 by one thread (goal: 8)
and 50,000 by two (goal: 25). The exponents are those of both times over hairs and segments, 1 being
linear. The last line is one JSON object. tests/bench/run builds what it needs.
"""

import json

from program import print_table, result_of


def main() -> None:
    result = result_of("beam", "beam_speed", __doc__)
    print_table(result)
    print(json.dumps(result))


if __name__ == "__main__":
    main()
