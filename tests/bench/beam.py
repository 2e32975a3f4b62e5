"""Times hairs as beams ([AUK92]) on this machine.

style_20k_ms is a bob of 20,000 hairs of 20 segments, combed and cut, from nothing on two workers (goal:
50). The exponents are those of its time over hairs (20,000 to 160,000) and segments (20 to 160), 1
being linear. The last line is one JSON object. tests/bench/run builds what it needs.
"""

import json

from program import result_of


def main() -> None:
    result = result_of("beam", "beam_speed", __doc__)
    for name, value in result.items():
        if isinstance(value, dict):
            for part, number in value.items():
                print(f"{name + ' ' + part:<36}{number:>10}")
        else:
            print(f"{name:<36}{value:>10}")
    print(json.dumps(result))


if __name__ == "__main__":
    main()
