// Properties of Result and MANE_CHECK:
//   one of two    a Result holds its value or its error; asking for the other is a CheckFailure
//   moves         a move-only value passes through untouched
//   check         a failed check throws, names its condition and place, and evaluates it once

#include "base/result.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <string_view>

#include "base/check_failure.h"

namespace mane {
namespace {

TEST(ResultTest, HoldsAValue) {
  Result<std::string> result = std::string("hair");
  ASSERT_TRUE(result.has_value());
  EXPECT_TRUE(static_cast<bool>(result));
  EXPECT_EQ(*result, "hair");
  EXPECT_EQ(result->size(), 4u);
  result->push_back('s');
  const Result<std::string>& view = result;
  EXPECT_EQ(*view, "hairs");
  EXPECT_EQ(view->size(), 5u);
  EXPECT_THROW((void)result.error(), base::CheckFailure);
}

TEST(ResultTest, HoldsAnError) {
  Result<int> result = InvalidArgument("guides[3].length_m", "length_m is -1; allowed: above 0");
  ASSERT_FALSE(result.has_value());
  EXPECT_FALSE(static_cast<bool>(result));
  EXPECT_EQ(result.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(result.error().field, "guides[3].length_m");
  EXPECT_EQ(result.error().message, "length_m is -1; allowed: above 0");
  EXPECT_THROW((void)*result, base::CheckFailure);
  const Result<int>& view = result;
  EXPECT_THROW((void)*view, base::CheckFailure);
}

TEST(ResultTest, MovesItsValueOut) {
  Result<std::unique_ptr<int>> result = std::make_unique<int>(7);
  const std::unique_ptr<int> taken = *std::move(result);
  ASSERT_NE(taken, nullptr);
  EXPECT_EQ(*taken, 7);
}

TEST(ResultTest, VoidIsSuccessOrAnError) {
  const Result<void> success;
  EXPECT_TRUE(success.has_value());
  EXPECT_TRUE(static_cast<bool>(success));
  EXPECT_THROW((void)success.error(), base::CheckFailure);
  const Result<void> failure = Error{ErrorCode::kNotFound, "no such groom", ""};
  EXPECT_FALSE(failure.has_value());
  EXPECT_FALSE(static_cast<bool>(failure));
  EXPECT_EQ(failure.error().code, ErrorCode::kNotFound);
}

TEST(CheckTest, ThrowsWithConditionAndPlaceAndEvaluatesOnce) {
  int evaluations = 0;
  EXPECT_NO_THROW(MANE_CHECK(++evaluations == 1));
  EXPECT_EQ(evaluations, 1);
  try {
    MANE_CHECK(evaluations == 2);
    FAIL() << "the check passed";
  } catch (const base::CheckFailure& failure) {
    const std::string_view what = failure.what();
    EXPECT_NE(what.find("evaluations == 2"), std::string_view::npos) << what;
    EXPECT_NE(what.find("result_test.cpp:"), std::string_view::npos) << what;
  }
}

}  // namespace
}  // namespace mane
