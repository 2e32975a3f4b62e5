#include "simd/isa.h"

#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <string>
#include <vector>

namespace mane::simd {
namespace {

constexpr std::array kNames = {"scalar", "neon", "avx2", "avx512"};

std::vector<Isa> Detect() {
  std::vector<Isa> found = {Isa::kScalar};
#if defined(__aarch64__)
  found.push_back(Isa::kNeon);  // Part of the architecture.
#elif defined(__x86_64__)
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (avx2) found.push_back(Isa::kAvx2);
  if (avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")) {
    found.push_back(Isa::kAvx512);
  }
#endif
  return found;
}

}  // namespace

std::string_view Name(Isa isa) { return kNames[static_cast<size_t>(isa)]; }

std::span<const Isa> Supported() {
  static const std::vector<Isa> supported = Detect();
  return supported;
}

Result<Isa> Choose(std::string_view name) {
  if (name.empty()) return Supported().back();
  std::string names;
  for (const Isa isa : Supported()) {
    if (Name(isa) == name) return isa;
    names += fmt::format("{}{}", names.empty() ? "" : ", ", Name(isa));
  }
  return InvalidArgument("MANE_ISA", fmt::format("is '{}', but this machine runs {}", name, names));
}

Isa Best() {
  static const Isa best = [] {
    const char* forced = std::getenv("MANE_ISA");
    return *Choose(forced ? forced : "");
  }();
  return best;
}

}  // namespace mane::simd
