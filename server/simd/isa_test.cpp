#include "simd/isa.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

namespace mane::simd {
namespace {

TEST(IsaTest, ScalarIsAlwaysThereAndOrderIsBySpeed) {
  ASSERT_FALSE(Supported().empty());
  EXPECT_EQ(Supported().front(), Isa::kScalar);
  EXPECT_TRUE(std::ranges::is_sorted(Supported()));
}

TEST(IsaTest, EverySupportedSetIsChosenByItsName) {
  for (const Isa isa : Supported()) {
    const auto chosen = Choose(Name(isa));
    ASSERT_TRUE(chosen.has_value()) << Name(isa);
    EXPECT_EQ(*chosen, isa);
  }
}

TEST(IsaTest, TheFastestIsChosenWhereNothingIsAsked) {
  const auto chosen = Choose("");
  ASSERT_TRUE(chosen.has_value());
  EXPECT_EQ(*chosen, Supported().back());
}

TEST(IsaTest, AnUnknownNameIsRefusedAndTheChoicesAreNamed) {
  for (const char* name : {"avx1024", "AVX2", "scalar ", "mmx"}) {
    const auto chosen = Choose(name);
    ASSERT_FALSE(chosen.has_value()) << name;
    EXPECT_EQ(chosen.error().field, "MANE_ISA");
    EXPECT_NE(chosen.error().message.find("scalar"), std::string::npos);
  }
}

TEST(IsaTest, KernelsObeyTheEnvironment) {
  const char* forced = std::getenv("MANE_ISA");
  EXPECT_EQ(Best(), *Choose(forced ? forced : ""));
}

}  // namespace
}  // namespace mane::simd
