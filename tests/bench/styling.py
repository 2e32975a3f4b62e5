"""Times hairstyles on this machine: roots, master strands, their deformation, members and colours.

Wavy hair of 28 cm on a head of 5,000 triangles with shoulders, 2,000 wisps, 28 control points a strand.
strands_20k_s and strands_100k_s are whole styles from nothing on all cores (goals: 1 and 4 on two);
restyle_after_one_change_s applies a style of 20,000 strands again after one number changed, by what
changed. bytes_per_control_point is the peak of memory over the members' control points (goal: 40).
The exponents are those of the whole time over strands (20,000 to 100,000), wisps (2,000 to 8,000)
and cells of the density field (8 times as many), 1 being linear. The last line is one JSON object.
tests/bench/run builds what it needs.
"""

import json

from program import print_table, result_of


def main() -> None:
    result = result_of("styling", "styling_speed", __doc__)
    print_table(result)
    print(json.dumps(result))


if __name__ == "__main__":
    main()
