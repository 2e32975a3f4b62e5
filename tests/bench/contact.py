"""Times hair among bodies, on this machine.

Smooth hair of 25 cm on a mesh of a walking head, with neck and shoulders that move on their own.
contact_over_rod is what bodies and the wisps of neighbours add to a step of 100 guides of 10 elements
on one core, over the rod kernel's own time for it (goal: 3); bodies_over_rod the same without wisps,
and of wavy hair, which meets bodies at more points. The exponents are those of the whole step's time
over the number of guides, with and without wisps, 1 being linear. full_head_100k_ms is one step of
100,000 strands of 5 elements among the bodies on all cores (goal: 33 on two). The last line is one JSON
object. tests/bench/run builds what it needs.
"""

import json

from program import result_of


def main() -> None:
    result = result_of("contact", "contact_speed", __doc__)
    for name, value in result.items():
        print(f"{name:<36}{value:>10}")
    print(json.dumps(result))


if __name__ == "__main__":
    main()
