// Frames of every format decode to the same positions, and malformed ones are refused.

#include "frame_decoder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "wire/frame_codec.h"
#include "wire/reconstruct.h"

namespace mane {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::Vector4d;

constexpr std::uint32_t kPoints = 12;
constexpr size_t kGuides = 3;

// Strands of two and three unequal elements, and a wound one of two, on a moved and turned head.
class FrameDecoderTest : public ::testing::Test {
 protected:
  FrameDecoderTest() {
    guides_ = {{{{0.1, 0, 0}, math::FromRotationVector({0, 0, 1.5})}, {0.05, 0.1}},
               {{{0, 0.1, 0}, math::FromRotationVector({0.3, -2, 0})}, {0.02, 0.03, 0.04}},
               {{{0, 0, 0.1}, math::FromRotationVector({1, 1, 1})},
                {0.03, 0.06},
                true,
                {{60, 100, -50}, {65, 110, -60}}}};
    coordinates_ = {{0.1, 0.4, -0.2, 1, -0.5, 2},
                    {0, 0, 0, -3, 0.1, 0.6, 0.2, 0.2, 0.2},
                    {-0.5, 0.3, 0.2, 0.7, 1, -0.4, 0.6, -0.1}};
    head_ = {{1, 1.7, -2}, math::FromRotationVector({0.2, 0.7, -0.1})};
  }

  v1::Opened Opened(v1::FrameFormat format, v1::Space space = v1::SPACE_WORLD) const {
    v1::Opened opened;
    opened.set_guide_count(kGuides);
    opened.set_element_count(7);
    opened.set_points_per_guide(kPoints);
    opened.set_format(format);
    opened.set_space(space);
    return opened;
  }

  v1::HairFrame Frame(v1::FrameFormat format) const {
    v1::HairFrame frame;
    frame.set_index(7);
    frame.set_time_s(2.5);
    auto& position = *frame.mutable_head_pose()->mutable_position();
    position.set_x(head_.p.x());
    position.set_y(head_.p.y());
    position.set_z(head_.p.z());
    auto& orientation = *frame.mutable_head_pose()->mutable_orientation();
    orientation.set_x(head_.q.x());
    orientation.set_y(head_.q.y());
    orientation.set_z(head_.q.z());
    orientation.set_w(head_.q.w());
    for (size_t g = 0; g < kGuides; ++g) frame.mutable_data()->append(Strand(format, g));
    return frame;
  }

  std::string Strand(v1::FrameFormat format, size_t g) const {
    const auto points = Points(g, head_);
    std::string data;
    if (format == v1::FRAME_FORMAT_GENERALIZED) {
      data.resize(wire::CoordinatesSize(coordinates_[g].size()));
      wire::EncodeCoordinates(coordinates_[g], std::as_writable_bytes(std::span(data)));
    } else if (format == v1::FRAME_FORMAT_POSITIONS_QUANTIZED16) {
      data.resize(wire::QuantizedSize(kPoints));
      wire::EncodeQuantized(points, std::as_writable_bytes(std::span(data)));
    } else {
      data.resize(wire::PositionsSize(kPoints));
      wire::EncodePositions(points, std::as_writable_bytes(std::span(data)));
    }
    return data;
  }

  std::vector<Vector3f> Points(size_t g, const math::Pose& head) const {
    std::vector<Vector3f> points(kPoints);
    const GuideGeometry& guide = guides_[g];
    const double* q = coordinates_[g].data();
    if (guide.wound) {
      const std::vector<Vector4d> x = {Vector4d(q), Vector4d(q + 4)};
      wire::SampleWoundPoints(head * guide.root, guide.element_lengths, guide.natural, x,
                              std::span(points));
    } else {
      std::vector<Vector3d> theta;
      for (size_t i = 0; i < coordinates_[g].size(); i += 3) theta.emplace_back(q + i);
      wire::SamplePoints(head * guide.root, guide.element_lengths, theta, std::span(points));
    }
    return points;
  }

  // Largest distance of a decoded point from where it should be [m].
  double Error(const mane::Frame& frame, const math::Pose& head) const {
    double worst = 0;
    for (size_t g = 0; g < kGuides; ++g) {
      const auto expected = Points(g, head);
      for (size_t i = 0; i < kPoints; ++i) {
        const float* x = &frame.positions[3 * (g * kPoints + i)];
        worst = std::max<double>(worst, (Vector3f(x[0], x[1], x[2]) - expected[i]).norm());
      }
    }
    return worst;
  }

  std::shared_ptr<const std::vector<GuideGeometry>> Guides() const {
    return std::make_shared<const std::vector<GuideGeometry>>(guides_);
  }

  std::vector<GuideGeometry> guides_;
  std::vector<std::vector<double>> coordinates_;
  math::Pose head_;
};

TEST_F(FrameDecoderTest, EveryFormatGivesTheSamePositions) {
  const struct {
    v1::FrameFormat format;
    double tolerance;  // [m]
  } cases[] = {{v1::FRAME_FORMAT_POSITIONS_FLOAT32, 0},
               {v1::FRAME_FORMAT_POSITIONS_QUANTIZED16, 2e-6},
               {v1::FRAME_FORMAT_GENERALIZED, 1e-6}};
  for (const auto& [format, tolerance] : cases) {
    SCOPED_TRACE(v1::FrameFormat_Name(format));
    const auto decoder = FrameDecoder::Create(Opened(format), Guides());
    ASSERT_TRUE(decoder);
    const auto frame = (*decoder)->Decode(Frame(format));
    ASSERT_TRUE(frame);
    EXPECT_EQ((*frame)->index, 7u);
    EXPECT_EQ((*frame)->time_s, 2.5);
    EXPECT_EQ((*frame)->guide_count, kGuides);
    EXPECT_EQ((*frame)->points_per_guide, kPoints);
    ASSERT_EQ((*frame)->positions.size(), kGuides * kPoints * 3);
    EXPECT_LE(Error(**frame, head_), tolerance);
  }
}

TEST_F(FrameDecoderTest, GeneralizedFramesGiveCoordinatesAndRespectTheSpace) {
  const auto format = v1::FRAME_FORMAT_GENERALIZED;
  const auto decoder = FrameDecoder::Create(Opened(format, v1::SPACE_HEAD), Guides());
  ASSERT_TRUE(decoder);
  const auto frame = (*decoder)->Decode(Frame(format));
  ASSERT_TRUE(frame);
  EXPECT_LE(Error(**frame, {}), 1e-6);
  ASSERT_EQ((*frame)->angles.size(), 5u * 3 + 2u * 4);
  EXPECT_EQ((*frame)->angles[3 * 3], -3.0f);
  EXPECT_EQ((*frame)->angles[5 * 3 + 4 + 1], -0.4f);
}

TEST_F(FrameDecoderTest, RefusesFramesOfTheWrongSize) {
  for (const auto format : {v1::FRAME_FORMAT_POSITIONS_FLOAT32,
                            v1::FRAME_FORMAT_POSITIONS_QUANTIZED16, v1::FRAME_FORMAT_GENERALIZED}) {
    SCOPED_TRACE(v1::FrameFormat_Name(format));
    const auto decoder = FrameDecoder::Create(Opened(format), Guides());
    ASSERT_TRUE(decoder);
    for (const int change : {-1, 1}) {
      v1::HairFrame frame = Frame(format);
      frame.mutable_data()->resize(frame.data().size() + static_cast<size_t>(change));
      const auto decoded = (*decoder)->Decode(frame);
      ASSERT_FALSE(decoded);
      EXPECT_EQ(decoded.error().code, ErrorCode::kInternal);
    }
  }
}

TEST_F(FrameDecoderTest, RefusesAHeadThatItsGroomDoesNotFit) {
  v1::Opened opened = Opened(v1::FRAME_FORMAT_GENERALIZED);
  opened.set_element_count(8);
  EXPECT_FALSE(FrameDecoder::Create(opened, Guides()));
  opened = Opened(v1::FRAME_FORMAT_GENERALIZED);
  opened.set_guide_count(4);
  EXPECT_FALSE(FrameDecoder::Create(opened, Guides()));
  opened = Opened(v1::FRAME_FORMAT_POSITIONS_FLOAT32);
  opened.set_points_per_guide(0);
  EXPECT_FALSE(FrameDecoder::Create(opened, Guides()));
}

TEST_F(FrameDecoderTest, RefusesAWoundGuideWithoutACoil) {
  for (const std::vector<Vector3d>& natural : {std::vector<Vector3d>{},
                                               {{60, 100, -50}},
                                               {{60, 100, -50}, {60, 0, 0}},
                                               {{60, 100, -50}, {60, NAN, 0}}}) {
    guides_[2].natural = natural;
    const auto decoder = FrameDecoder::Create(Opened(v1::FRAME_FORMAT_GENERALIZED), Guides());
    ASSERT_FALSE(decoder);
    EXPECT_EQ(decoder.error().code, ErrorCode::kInternal);
    EXPECT_NE(decoder.error().message.find("guide 2"), std::string::npos);
  }
}

TEST(GuideGeometry, NaturalCurvatureIsOneForAllOrOneEach) {
  v1::Guide guide;
  guide.set_length_m(0.3);
  guide.set_element_count(2);
  guide.add_natural_twist(5);
  guide.add_natural_curvature_2(7);
  guide.add_natural_curvature_2(8);
  EXPECT_TRUE(GuideGeometry::From(guide).natural.empty()) << "a plain guide's is not needed";
  guide.set_model(v1::STRAND_MODEL_WOUND);
  const GuideGeometry geometry = GuideGeometry::From(guide);
  EXPECT_EQ(geometry.natural, (std::vector<Vector3d>{{5, 0, 7}, {5, 0, 8}}));
  EXPECT_TRUE(geometry.usable());
  EXPECT_EQ(geometry.coordinates(), 8u);
  guide.add_natural_curvature_2(9);
  EXPECT_FALSE(GuideGeometry::From(guide).usable());
}

TEST(GuideGeometry, EqualElementsFollowFromTheLength) {
  v1::Guide guide;
  guide.set_length_m(0.3);
  guide.set_element_count(3);
  guide.mutable_root_frame()->set_w(1.005);
  const GuideGeometry geometry = GuideGeometry::From(guide);
  ASSERT_EQ(geometry.element_lengths.size(), 3u);
  for (const double length : geometry.element_lengths) EXPECT_DOUBLE_EQ(length, 0.1);
  EXPECT_DOUBLE_EQ(geometry.root.q.norm(), 1);
}

}  // namespace
}  // namespace mane
