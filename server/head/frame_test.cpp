// Frames show the state: positions are those of the strands in the space that was asked for, all
// formats agree within what each states, and workers do not matter.

#include "head/frame.h"

#include <gtest/gtest.h>

#include <cmath>

#include "head/sample_groom.h"
#include "rod/chain.h"
#include "rod/wound_shape.h"
#include "wire/frame_codec.h"
#include "wire/reconstruct.h"

namespace mane::head {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kPoints = 9;

template <typename Vector>
std::vector<Vector> Elements(const groom::Guide& guide, const double* coordinates) {
  std::vector<Vector> elements(guide.strand.elements());
  for (Vector& element : elements) {
    element = Eigen::Map<const Vector>(coordinates);
    coordinates += element.size();
  }
  return elements;
}

// The point of a guide at arc length s, from its coordinates.
Vector3d OfPlain(const groom::Guide& guide, const math::Pose& root, const double* coordinates,
                 double s) {
  const auto theta = Elements<Vector3d>(guide, coordinates);
  return rod::PointAt(guide.strand, root, theta, rod::Locate(guide.strand, s)).r;
}
Vector3d OfWound(const groom::Guide& guide, const math::Pose& root, const double* coordinates,
                 double s) {
  const auto x = Elements<rod::Vector4d>(guide, coordinates);
  return rod::PointOnHair(*guide.wound, rod::WoundFrames(*guide.wound, root, x), x, s);
}

class FrameTest : public ::testing::Test {
 protected:
  FrameTest() {
    for (int i = 1; i <= 20; ++i) {
      const math::Pose pose{{0.02 * i, 1, 0}, math::FromRotationVector({0, 0.05 * i, 0.1})};
      Advance(*groom_, {pose, 1 / 60.0, 1}, {}, &state_, pool_);
    }
  }

  // Positions of all guides from the rods themselves.
  std::vector<Vector3d> Expected(Space space) const {
    const std::vector<double> coordinates = Coordinates(*groom_, state_);
    std::vector<Vector3d> points;
    for (int i = 0; i < groom_->guide_count(); ++i) {
      const groom::Guide& guide = groom_->guides[i];
      const math::Pose root = space == Space::kHead ? guide.root : state_.pose * guide.root;
      const double* const own = &coordinates[groom_->first_coordinate[i]];
      for (int k = 0; k < kPoints; ++k) {
        const double s = guide.strand.TotalLength() * k / (kPoints - 1);
        points.push_back(guide.wound ? OfWound(guide, root, own, s) : OfPlain(guide, root, own, s));
      }
    }
    return points;
  }

  std::span<const std::byte> Guide(const std::string& data, int guide, size_t size) const {
    return std::as_bytes(std::span(data)).subspan(guide * size, size);
  }

  exec::WorkerPool pool_{2};
  std::shared_ptr<const groom::Groom> groom_ = SampleGroom(40, 5);
  HeadState state_ = AtRest(*groom_, {});
};

TEST_F(FrameTest, PositionsAreThoseOfTheRods) {
  for (const Space space : {Space::kWorld, Space::kHead}) {
    const View view{FrameFormat::kPositionsFloat32, space, kPoints};
    const std::string data = EncodeFrame(*groom_, state_, view, pool_);
    ASSERT_EQ(data.size(), FrameSize(*groom_, view));
    const std::vector<Vector3d> expected = Expected(space);
    for (int i = 0; i < groom_->guide_count(); ++i) {
      std::vector<Vector3f> points(kPoints);
      wire::DecodePositions(Guide(data, i, wire::PositionsSize(kPoints)), points);
      for (int k = 0; k < kPoints; ++k) {
        // A few units in the last place of a float near 1.5 m.
        EXPECT_LT((points[k].cast<double>() - expected[i * kPoints + k]).norm(), 2e-6);
      }
    }
  }
}

TEST_F(FrameTest, QuantizedPositionsAreWithinTheStatedError) {
  const View view{FrameFormat::kPositionsQuantized16, Space::kWorld, kPoints};
  const std::string data = EncodeFrame(*groom_, state_, view, pool_);
  ASSERT_EQ(data.size(), FrameSize(*groom_, view));
  const std::vector<Vector3d> expected = Expected(Space::kWorld);
  for (int i = 0; i < groom_->guide_count(); ++i) {
    std::vector<Vector3f> points(kPoints);
    wire::DecodeQuantized(Guide(data, i, wire::QuantizedSize(kPoints)), points);
    const double L = groom_->guides[i].strand.TotalLength();
    for (int k = 0; k < kPoints; ++k) {
      // A box is at most L wide; 1/131070 of it an axis, and the float's own rounding.
      EXPECT_LT((points[k].cast<double>() - expected[i * kPoints + k]).lpNorm<Eigen::Infinity>(),
                L / 131070 + 1e-6);
    }
  }
}

TEST_F(FrameTest, GeneralizedCoordinatesRebuildTheStrands) {
  const View view{FrameFormat::kGeneralized, Space::kWorld, kPoints};
  const std::string data = EncodeFrame(*groom_, state_, view, pool_);
  ASSERT_EQ(data.size(), FrameSize(*groom_, view));
  const std::vector<Vector3d> expected = Expected(Space::kWorld);
  for (int i = 0; i < groom_->guide_count(); ++i) {
    const groom::Guide& guide = groom_->guides[i];
    const math::Pose root = state_.pose * guide.root;
    std::vector<double> coordinates(guide.coordinate_count());
    std::vector<Vector3d> points(kPoints);
    wire::DecodeCoordinates(std::as_bytes(std::span(data))
                                .subspan(wire::CoordinatesSize(groom_->first_coordinate[i]),
                                         wire::CoordinatesSize(coordinates.size())),
                            coordinates);
    if (guide.wound) {
      wire::SampleWoundPoints(root, guide.strand.length, guide.strand.natural,
                              Elements<rod::Vector4d>(guide, coordinates.data()),
                              std::span(points));
    } else {
      wire::SamplePoints(root, guide.strand.length, Elements<Vector3d>(guide, coordinates.data()),
                         std::span(points));
    }
    for (int k = 0; k < kPoints; ++k) {
      // Float angles of up to 10 rad are 5e-7 off, times a strand of 0.3 m, summed over elements.
      EXPECT_LT((points[k] - expected[i * kPoints + k]).norm(), 1e-6);
    }
  }
}

TEST_F(FrameTest, WorkersDoNotMatter) {
  exec::WorkerPool one(1);
  for (const auto format : {FrameFormat::kPositionsFloat32, FrameFormat::kPositionsQuantized16,
                            FrameFormat::kGeneralized}) {
    const View view{format, Space::kWorld, kPoints};
    EXPECT_EQ(EncodeFrame(*groom_, state_, view, pool_), EncodeFrame(*groom_, state_, view, one));
  }
}

}  // namespace
}  // namespace mane::head
