"""Measures the batched Super-Helix step on one core of this machine.

Prints a table, and as the last line one JSON object: microseconds a strand-step of the kernel at
N = 5 and 10 elements for the fastest instruction set and for each; AVX2 over AVX-512; the
double-precision reference over the fastest; a whole head step (pose in, 16 positions a guide out)
over the kernel alone, for 100 and 1000 guides; the diagnostics of a frame over one step of the
kernel, at N = 5 and 10; bytes of a strand; the largest relative distance of the cost from a
straight line over N = 5 to 40; the cost of a strand among 100,000 over one among 1,000; wound strands, and
one of 10 elements over a plain one of 10.
tests/bench/run builds what it needs.
"""

import json

from program import result_of


def main() -> None:
    result = result_of("rod", "rod_speed", __doc__)

    print("us a strand-step         N = 5    N = 10")
    for isa, times in result["us_per_strand_step_by_isa"].items():
        print(f"  {isa:<20}{times['5']:>9.3f}{times['10']:>10.3f}")
    reference = result["reference_us"]
    print(f"  {'reference (double)':<20}{reference['5']:>9.3f}{reference['10']:>10.3f}")
    print(
        "by elements:  " + "  ".join(f"{n}: {t:.3f}" for n, t in result["us_by_elements"].items())
    )
    print("by strands:   " + "  ".join(f"{n}: {t:.3f}" for n, t in result["us_by_strands"].items()))
    wound = result["us_wound"]
    print(f"  {'wound':<20}{wound['5']:>9.3f}{wound['10']:>10.3f}")
    print(f"a head step over the kernel: {result['head_step_over_kernel']}")
    print(f"diagnostics over a step of the kernel: {result['diagnostics_over_step']}")
    print(json.dumps(result))


if __name__ == "__main__":
    main()
