// Times hairs as beams. Prints one JSON object; every number is a median, and exponents are of one
// run.

#include "beam.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

int main() {
  mane::Report numbers, exponents;
  mane::TimeStyling(&numbers, &exponents);
  fmt::print("{{{}, \"exponents\": {{{}}}}}\n", fmt::join(numbers, ", "),
             fmt::join(exponents, ", "));
}
