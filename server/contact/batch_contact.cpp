#include "contact/batch_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "rod/scheme.h"

namespace mane::contact {
namespace {

using rod::Row;
using rod::layout::kLanes;
using Block = rod::Batch<float>::Block;

constexpr double kPointSpacing = 0.015;  // [m]
constexpr double kLargestBulge = 2e-3;   // Of curled hair between two points [m].
constexpr int kMostPoints = 10;
// Normals whose sum is no longer than that are opposite by rounding, and have no mean.
constexpr float kOpposite = 1e-5F;

void Reserve(const Block& block, size_t points, BatchContactScratch* scratch) {
  const auto grow = [](size_t size, auto* list) {
    if (list->size() < size) list->resize(size);
  };
  grow(points * rod::layout::kPointRows, &scratch->points);
  grow(points * kMeetingRows, &scratch->meetings);
  grow(points * rod::layout::kLoadRows, &scratch->loads);
  grow(points * 3, &scratch->velocities);
  grow(points * 3, &scratch->local);
  grow(points * 3, &scratch->places);
  grow(points, &scratch->stale);
  grow(static_cast<size_t>(block.elements) * rod::layout::StateRowsPerElement(block.kind),
       &scratch->next);
  scratch->loaded.assign(points, 0);
  scratch->watched.assign(points, 0);
  for (auto* list : {&scratch->x, &scratch->y, &scratch->z, &scratch->distance, &scratch->nx,
                     &scratch->ny, &scratch->nz, &scratch->vx, &scratch->vy, &scratch->vz}) {
    grow(points * kLanes, list);
  }
  grow(points * kLanes, &scratch->body);
  grow(points * kLanes, &scratch->place);
}

// Takes of `places` those that are marked, of the first `count` lanes. Returns how many.
size_t Gather(const std::vector<Row<float>>& places, int points, int count,
              BatchContactScratch* scratch) {
  size_t n = 0;
  for (int i = 0; i < points; ++i) {
    if (scratch->any_stale[i] == 0) continue;
    const float* const stale = scratch->stale[i].lane;
    for (int lane = 0; lane < count; ++lane) {
      if (stale[lane] == 0) continue;
      scratch->place[n] = static_cast<uint32_t>(i * kLanes + lane);
      scratch->x[n] = places[3 * i].lane[lane];
      scratch->y[n] = places[3 * i + 1].lane[lane];
      scratch->z[n] = places[3 * i + 2].lane[lane];
      ++n;
    }
  }
  return n;
}

// What a group is like at the first `n` places of `scratch`.
void AtPlaces(const BodyGroup& group, size_t n, BatchContactScratch* scratch) {
  const PointSpans at{{scratch->x.data(), n}, {scratch->y.data(), n}, {scratch->z.data(), n}};
  At(group.bodies, 0, at,
     {{{scratch->distance.data(), n},
       {scratch->nx.data(), n},
       {scratch->ny.data(), n},
       {scratch->nz.data(), n}},
      {scratch->vx.data(), n},
      {scratch->vy.data(), n},
      {scratch->vz.data(), n},
      {scratch->body.data(), n}});
}

// Looks at a group from the points that are stale, and remembers what is seen.
void LookAgain(const BodyGroup& group, int points, int count, Row<float>* seen,
               BatchContactScratch* scratch) {
  const size_t n = Gather(scratch->local, points, count, scratch);
  AtPlaces(group, n, scratch);
  for (size_t j = 0; j < n; ++j) {
    const uint32_t point = scratch->place[j] / kLanes, lane = scratch->place[j] % kLanes;
    Row<float>* const rows = seen + point * kSeenRows;
    const Friction& friction = group.frictions[std::max(scratch->body[j], 0)];
    const float values[kSeenRows] = {scratch->x[j],
                                     scratch->y[j],
                                     scratch->z[j],
                                     scratch->nx[j],
                                     scratch->ny[j],
                                     scratch->nz[j],
                                     scratch->distance[j],
                                     static_cast<float>(friction.coefficient),
                                     static_cast<float>(friction.anisotropy)};
    for (int row = 0; row < kSeenRows; ++row) rows[row].lane[lane] = values[row];
  }
  // Lanes past the last strand repeat it.
  for (int i = 0; count < kLanes && i < points * kSeenRows; ++i) {
    std::fill(seen[i].lane + count, seen[i].lane + kLanes, seen[i].lane[count - 1]);
  }
}

}  // namespace

GroupMotion MotionOf(const BodyMotion& group, const rod::ClampMotion& head) {
  const math::Pose pose = group.PoseAt(rod::kTheta);
  const math::Pose seen_from = math::Interpolate(head.begin, head.end, rod::kTheta);
  const Eigen::Matrix3f R = pose.q.toRotationMatrix().cast<float>();
  const Eigen::Vector3f p = (pose.p - seen_from.p).cast<float>();
  const Eigen::Vector3f v = group.LinearVelocity().cast<float>();
  const Eigen::Vector3f w = group.AngularVelocity().cast<float>();
  GroupMotion motion;
  std::copy_n(R.data(), 9, motion.frame);
  std::copy_n(p.data(), 3, motion.position);
  std::copy_n(v.data(), 3, motion.velocity);
  std::copy_n(w.data(), 3, motion.spin);
  return motion;
}

std::vector<int> FirstPoints(const rod::Batch<float>& batch, const Block& block) {
  const float* const constants = batch.constants(block);
  const float* const unit = constants + rod::layout::kUnit * kLanes;
  const bool wound = block.kind == rod::layout::Kind::kWound;
  std::vector<int> first = {0};
  for (int Q = 0; Q < block.elements; ++Q) {
    const float* const element = constants + rod::layout::ConstantRows(block.kind, Q) * kLanes;
    double count = 1;
    for (int lane = 0; lane < kLanes; ++lane) {
      const double length = unit[lane] * element[rod::layout::kLength * kLanes + lane];
      count = std::max(count, length / kPointSpacing);
      if (wound) continue;
      const double bend = std::hypot(element[(rod::layout::kNatural + 1) * kLanes + lane],
                                     element[(rod::layout::kNatural + 2) * kLanes + lane]);
      count = std::max(count, std::sqrt(length * bend / (8 * kLargestBulge)));
    }
    first.push_back(first.back() +
                    static_cast<int>(std::ceil(std::min<double>(count - 1e-3, kMostPoints))));
  }
  return first;
}

void Forget(std::span<Row<float>> memory) {
  // Of what is not a number nothing is near, so that it is looked at.
  constexpr float kNever = std::numeric_limits<float>::quiet_NaN();
  for (Row<float>& row : memory) std::fill(row.lane, row.lane + kLanes, kNever);
}

BlockStep::BlockStep(const BatchContact& contact, const rod::Batch<float>& batch,
                     const Block& block, std::span<const int> first_point,
                     std::span<const Row<float>, rod::layout::kDriveRows> drive,
                     std::span<Row<float>> memory, std::span<Row<float>> state,
                     BatchContactScratch& scratch, bool watch_all)
    : contact_(contact),
      kernels_(contact.step.Of(block.kind)),
      block_(block),
      first_point_(first_point),
      points_(first_point.back()),
      drive_(drive),
      memory_(memory),
      state_(state.subspan(block.state, static_cast<size_t>(block.elements) *
                                            rod::layout::StateRowsPerElement(block.kind))),
      scratch_(scratch),
      watch_all_(watch_all),
      constants_(batch.constants(block)),
      bytes_(scratch.step.Reserve(kernels_.approach_scratch(block.elements, points_))) {
  MANE_CHECK(std::ssize(first_point) == block.elements + 1);
  MANE_CHECK(memory.size() == MemoryRows(points_, contact.groups.size()));
  Reserve(block, points_, &scratch);
  if (watch_all) std::fill_n(scratch.watched.begin(), points_, 1);
  const float dt = drive[rod::layout::kDuration].lane[0];
  const BatchContactSettings& settings = contact.settings;
  numbers_ = {
      static_cast<float>(rod::kTheta) * dt,        dt,
      static_cast<float>(settings.thickness),      static_cast<float>(settings.root_length),
      static_cast<float>(settings.recovery_speed), static_cast<float>(settings.recovery_pull),
      static_cast<float>(contact.surprise)};
}

MeetingBlock BlockStep::Meetings() {
  return {block_.elements,
          first_point_.data(),
          block_.kind == rod::layout::Kind::kWound,
          constants_,
          scratch_.points[0].lane,
          scratch_.meetings[0].lane,
          scratch_.loads[0].lane,
          scratch_.loaded.data(),
          scratch_.watched.data()};
}

void BlockStep::Begin() {
  kernels_.approach(block_.elements, first_point_.data(), constants_, drive_[0].lane,
                    state_[0].lane, bytes_, scratch_.points[0].lane);
  const float* const points = scratch_.points[0].lane;
  for (size_t g = 0; g < contact_.groups.size(); ++g) {
    Row<float>* const seen = memory_.data() + points_ * (kTouchRows + g * kSeenRows);
    scratch_.any_stale.assign(points_, 0);
    if (contact_.meetings.look(points_, points, contact_.motions[g], numbers_, seen->lane,
                               scratch_.local[0].lane, scratch_.stale[0].lane,
                               scratch_.any_stale.data())) {
      LookAgain(*contact_.groups[g], points_, block_.count, seen, &scratch_);
    }
    contact_.meetings.meet(points_, points, contact_.motions[g], seen->lane, scratch_.local[0].lane,
                           g == 0, scratch_.meetings[0].lane);
    LookBetween(g, seen);
  }
  if (contact_.groups.empty()) {
    constexpr Row<float> kNone{};
    std::fill_n(scratch_.meetings.begin(), points_ * kMeetingRows, kNone);
    for (int i = 0; i < points_; ++i) {
      std::fill_n(scratch_.meetings[i * kMeetingRows + kDistance].lane, kLanes, 1e9F);
      std::fill_n(scratch_.meetings[i * kMeetingRows + kMiddle].lane, kLanes, 1e9F);
    }
  }
  contact_.meetings.begin(Meetings(), numbers_, memory_[0].lane);
}

void BlockStep::LookBetween(size_t g, const Row<float>* seen) {
  const GroupMotion& motion = contact_.motions[g];
  scratch_.any_stale.assign(points_, 0);
  if (!contact_.meetings.between(points_, scratch_.points[0].lane, motion, seen->lane,
                                 scratch_.local[0].lane, scratch_.places[0].lane,
                                 scratch_.stale[0].lane, scratch_.any_stale.data())) {
    return;
  }
  const size_t n = Gather(scratch_.places, points_, kLanes, &scratch_);
  AtPlaces(*contact_.groups[g], n, &scratch_);
  const Eigen::Map<const Eigen::Matrix3f> R(motion.frame);
  const Eigen::Map<const Eigen::Vector3f> v(motion.velocity), w(motion.spin);
  for (size_t j = 0; j < n; ++j) {
    const uint32_t point = scratch_.place[j] / kLanes, lane = scratch_.place[j] % kLanes;
    Row<float>* const rows = &scratch_.meetings[point * kMeetingRows];
    if (scratch_.distance[j] >= rows[kMiddle].lane[lane]) continue;
    // Ends that face each other through a thin body say where its rim is.
    const auto normal = [&](const Row<float>* of) {
      return Eigen::Vector3f(of[kSeenNormal].lane[lane], of[kSeenNormal + 1].lane[lane],
                             of[kSeenNormal + 2].lane[lane]);
    };
    const Row<float>* const of = seen + point * kSeenRows;
    const Eigen::Vector3f sum = normal(of) + normal(of + kSeenRows);
    if (!(sum.norm() > kOpposite)) continue;
    rows[kMiddle].lane[lane] = scratch_.distance[j];
    const Eigen::Vector3f out = R * sum.normalized();
    const Eigen::Vector3f at(scratch_.x[j], scratch_.y[j], scratch_.z[j]);
    const Eigen::Vector3f surface = v + w.cross(R * at);
    for (int i = 0; i < 3; ++i) {
      rows[kMiddleNormal + i].lane[lane] = out[i];
      rows[kMiddleSurface + i].lane[lane] = surface[i];
    }
  }
}

void BlockStep::ExpectSolve() const {
  const auto expect = [](const void* from, size_t bytes) {
    for (size_t i = 0; i < bytes; i += 64) {
      __builtin_prefetch(static_cast<const char*>(from) + i, 0, 2);
    }
  };
  expect(bytes_, kernels_.approach_scratch(block_.elements, points_));
  expect(scratch_.loads.data(), static_cast<size_t>(points_) * rod::layout::kLoadRows * 64);
}

void BlockStep::Solve() {
  kernels_.solve(block_.elements, first_point_.data(), constants_, drive_[0].lane, state_[0].lane,
                 scratch_.loads[0].lane, scratch_.loaded.data(), scratch_.watched.data(), bytes_,
                 scratch_.next[0].lane, scratch_.velocities[0].lane, size_.lane, turning_.lane);
}

bool BlockStep::Revise() {
  return contact_.meetings.revise(Meetings(), scratch_.velocities[0].lane);
}

bool BlockStep::Finish() {
  const bool last = corrections_ + 1 >= kCorrections;
  return contact_.meetings.finish(Meetings(), scratch_.velocities[0].lane, numbers_, last,
                                  memory_[0].lane) &&
         corrections_++ < kCorrections;
}

uint32_t BlockStep::Commit() {
  std::copy_n(scratch_.next.begin(), state_.size(), state_.begin());
  return rod::FailedLanes(size_);
}

float BlockStep::Bend() const {
  float most = 0;
  for (int lane = 0; lane < block_.count; ++lane) {
    bool meets = watch_all_;
    for (int i = 0; i < points_ && !meets; ++i) {
      meets =
          scratch_.watched[i] != 0 && scratch_.meetings[i * kMeetingRows + kMass].lane[lane] > 0;
    }
    if (meets) most = std::max(most, turning_.lane[lane]);
  }
  return 0.5F * numbers_.dt * numbers_.dt * most;
}

float BlockStep::Mass(int point, int lane) const {
  const auto next = std::upper_bound(first_point_.begin(), first_point_.end(), point);
  const int Q = static_cast<int>(next - first_point_.begin()) - 1;
  const int length = rod::layout::ConstantRows(block_.kind, Q) + rod::layout::kLength;
  return constants_[rod::layout::kUnitMass * kLanes + lane] * constants_[length * kLanes + lane] /
         static_cast<float>(first_point_[Q + 1] - first_point_[Q]);
}

void BlockStep::SetImpulse(int point, Vectors impulse) {
  const float* const unit = constants_ + rod::layout::kUnitMass * kLanes;
  Row<float>* const rows = &scratch_.loads[point * rod::layout::kLoadRows + rod::layout::kImpulse];
  for (int i = 0; i < 3; ++i) {
    for (int lane = 0; lane < kLanes; ++lane)
      rows[i].lane[lane] = impulse[i].lane[lane] / unit[lane];
  }
  scratch_.loaded[point] = 1;
}

uint32_t StepBlockAmong(const BatchContact& contact, const rod::Batch<float>& batch,
                        const Block& block, std::span<const int> first_point,
                        std::span<const Row<float>, rod::layout::kDriveRows> drive,
                        std::span<Row<float>> memory, std::span<Row<float>> state,
                        BatchContactScratch& scratch, float* bend) {
  BlockStep step(contact, batch, block, first_point, drive, memory, state, scratch);
  step.Begin();
  step.Solve();
  if (step.Revise()) step.Solve();
  while (step.Finish()) step.Solve();
  if (bend != nullptr) *bend = std::max(*bend, step.Bend());
  return step.Commit();
}

}  // namespace mane::contact
