// Each preset is valid, makes hair on its hull and keeps what its description says.

#include "beam/presets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace mane::beam {
namespace {

using Eigen::Vector3d;

// Nodes of each hair, by the name of its part.
using Wig = std::map<std::string, std::vector<std::vector<Vector3d>>>;

Wig WigOf(const std::string& name) {
  for (const BeamPreset& preset : BeamPresets()) {
    if (preset.name != name) continue;
    const Loop loop = [](int count, const auto& work) { work(0, count); };
    const auto styled = ApplyBeamStyle(preset.style, PresetHull(), "style", loop);
    EXPECT_TRUE(styled) << styled.error().field << ": " << styled.error().message;
    Wig wig;
    for (int hair = 0; hair < styled->count(); ++hair) {
      auto& nodes = wig[preset.style.parts[styled->part[hair]].name].emplace_back();
      for (auto i = styled->first_node[hair]; i < styled->first_node[hair + 1]; ++i) {
        nodes.emplace_back(styled->nodes[i].cast<double>());
      }
    }
    return wig;
  }
  ADD_FAILURE() << name;
  return {};
}

double Mean(const std::vector<std::vector<Vector3d>>& hairs,
            const std::function<double(const std::vector<Vector3d>&)>& number) {
  double sum = 0;
  for (const auto& hair : hairs) sum += number(hair) / static_cast<double>(hairs.size());
  return sum;
}

double LowestOf(const Wig& wig) {
  double lowest = 1;
  for (const auto& [name, hairs] : wig) {
    for (const auto& hair : hairs) {
      for (const Vector3d& node : hair) lowest = std::min(lowest, node.y());
    }
  }
  return lowest;
}

double TipHeight(const std::vector<Vector3d>& hair) { return hair.back().y(); }

TEST(BeamPresetsTest, AreValidAndDescribed) {
  const auto presets = BeamPresets();
  ASSERT_EQ(presets.size(), 5U);
  for (const BeamPreset& preset : presets) {
    SCOPED_TRACE(preset.name);
    EXPECT_FALSE(preset.description.empty());
    EXPECT_TRUE(ValidateBeamStyle(preset.style, "style"));
    for (const auto& [name, hairs] : WigOf(preset.name)) {
      EXPECT_GT(hairs.size(), 200U) << name;
      for (const auto& hair : hairs) {
        for (const Vector3d& node : hair) EXPECT_GE(PresetHull().At(node), 0);
      }
    }
  }
}

TEST(BeamPresetsTest, TheBobIsLevelAndPartedWithShortBangs) {
  Wig wig = WigOf("bob");
  EXPECT_GE(LowestOf(wig), -0.1 - 1e-7);
  const auto level = [](const auto& hair) { return hair.back().y() < -0.1 + 1e-6 ? 1.0 : 0.0; };
  EXPECT_GT(Mean(wig["right back"], level), 0.9);
  EXPECT_GT(Mean(wig["left front"], level), 0.8);
  for (const auto& hair : wig["bangs"]) {
    for (const Vector3d& node : hair) EXPECT_GE(node.y(), 0.005 - 1e-7);  // Above the eyes.
  }
  const auto right = [](const auto& hair) { return hair.back().x() > 0 ? 1.0 : 0.0; };
  EXPECT_GT(Mean(wig["right front"], right), 0.99);
  EXPECT_LT(Mean(wig["left front"], right), 0.01);
}

TEST(BeamPresetsTest, DroopingBangsDroopAndEndsAreUneven) {
  Wig wig = WigOf("drooping_bangs");
  const auto in_face = [](const auto& hair) {
    return hair.back().y() < 0.06 && hair.back().z() > 0 ? 1.0 : 0.0;
  };
  EXPECT_GT(Mean(wig["bangs"], in_face), 0.9);
  const double mean = Mean(wig["right back"], TipHeight);
  const auto square = [&](const auto& hair) { return std::pow(TipHeight(hair) - mean, 2); };
  EXPECT_GT(std::sqrt(Mean(wig["right back"], square)), 0.03);
}

TEST(BeamPresetsTest, SweptHairLeavesTheFaceAndTuftsHangBeforeTheTemples) {
  Wig wig = WigOf("swept_back");
  const auto backward = [](const auto& hair) {
    return hair.back().z() < hair.front().z() ? 1.0 : 0.0;
  };
  EXPECT_GT(Mean(wig["swept"], backward), 0.97);
  EXPECT_LT(Mean(wig["right tuft"], TipHeight), -0.03);
  for (const auto& hair : wig["right tuft"]) EXPECT_GT(hair.back().x(), 0.05);
  for (const auto& hair : wig["left tuft"]) EXPECT_LT(hair.back().x(), -0.05);
}

TEST(BeamPresetsTest, ThePonytailIsDrawnToItsTieAndHangsBehind) {
  Wig wig = WigOf("ponytail");
  const Vector3d tie(0, 0.05, -0.094);
  const auto arrives = [&](const auto& hair) {
    return (hair.back() - tie).norm() < 0.04 ? 1.0 : 0.0;
  };
  EXPECT_GT(Mean(wig["front"], arrives), 0.6);
  EXPECT_GT(Mean(wig["back"], arrives), 0.6);
  for (const auto& hair : wig["tail"]) {
    EXPECT_LT(hair.back().z(), -0.09);
    EXPECT_LT(hair.back().y(), 0);
  }
}

TEST(BeamPresetsTest, TheShortCutIsShorterBelow) {
  Wig wig = WigOf("short");
  const auto length = [](const std::vector<Vector3d>& hair) {
    double sum = 0;
    for (size_t i = 1; i < hair.size(); ++i) sum += (hair[i] - hair[i - 1]).norm();
    return sum;
  };
  double low = 0, high = 0;
  for (const auto& hair : wig["back"]) {
    if (hair[0].y() < -0.03) low = std::max(low, length(hair));
    if (hair[0].y() > 0.1) high = std::max(high, length(hair));
  }
  EXPECT_LT(low, 0.025);
  EXPECT_GT(high, 0.1);
}

}  // namespace
}  // namespace mane::beam
