#include "head/contact.h"

#include <algorithm>
#include <utility>

#include "base/check.h"
#include "head/head.h"
#include "head/kernels.h"
#include "simd/isa.h"

namespace mane::head {
namespace {

constexpr double kArm = 0.3;  // At which hair lies from what turns [m].

std::span<rod::Row<float>> MemoryOf(int block, Contact* contact) {
  return std::span(contact->memory)
      .subspan(contact->blocks[block].first, contact->blocks[block].rows);
}

// A body that is that far in a step has been cut to another place.
math::Pose StartOf(const math::Pose& begin, const math::Pose& end, double duration) {
  return (end.p - begin.p).norm() > kFastestHead * duration ? end : begin;
}

Eigen::Vector3d VelocityOf(const rod::ClampMotion& head) {
  return (head.end.p - head.begin.p) / head.dt;
}
Eigen::Vector3d SpinOf(const rod::ClampMotion& head) {
  return math::RotationVector(head.end.q * head.begin.q.conjugate()) / head.dt;
}

}  // namespace

std::span<rod::Row<float>> TouchedBy(int block, Contact* contact) {
  return MemoryOf(block, contact)
      .first(contact->blocks[block].first_point.back() * contact::kTouchRows);
}

void StartContact(const groom::Groom& groom, std::shared_ptr<const Bodies> bodies,
                  HeadState* state) {
  Contact& contact = state->contact;
  contact = Contact();
  contact.bodies = std::move(bodies);
  if (contact.bodies == nullptr) return;
  contact.moving = BodiesAtRest(*contact.bodies, state->pose);
  size_t first = 0;
  for (const auto& block : groom.batch.blocks()) {
    const std::vector<int> first_point = contact::FirstPoints(groom.batch, block);
    const size_t rows = contact::MemoryRows(first_point.back(), contact.bodies->groups.size());
    contact.blocks.push_back({first_point, first_point, first, rows, 1});
    first += rows;
  }
  contact.memory.resize(first);
  contact::Forget(contact.memory);
  if (!contact.bodies->settled.empty()) ResetContact(state);
}

void ResetContact(HeadState* state) {
  Contact& contact = state->contact;
  state->guides = contact.bodies->settled;
  contact.velocity.setZero(), contact.spin.setZero();
  contact.wisps.Clear();
  contact.fineness = 1;
  for (Contact::Block& block : contact.blocks) {
    block.fineness = 1;
    block.first_point = block.first_of_all;
  }
  if (contact.bodies->settled_memory.empty()) {
    contact::Forget(contact.memory);
  } else {
    contact.memory = contact.bodies->settled_memory;
  }
}

void ForgetContact(int block, const rod::Parts& parts, Contact* contact) {
  if (contact->bodies == nullptr) return;
  contact::Forget(MemoryOf(block, contact));
  const std::vector<int>& fine = contact->blocks[block].first_of_all;
  std::vector<int>& first = contact->blocks[block].first_point;
  if (parts.empty()) {
    first = fine;
    return;
  }
  first.resize(parts.back() + 2);
  for (size_t Q = 0; Q < parts.size(); ++Q) first[parts[Q] + 1] = fine[Q + 1];
}

void SetGroupMotions(const Contact& contact, std::span<const math::Pose> targets,
                     const rod::ClampMotion& head, double begin, double end,
                     std::vector<contact::GroupMotion>* motions) {
  motions->clear();
  if (contact.bodies == nullptr) return;
  MANE_CHECK(targets.empty() || targets.size() == contact.moving.size());
  for (const Bodies::Group& group : contact.bodies->groups) {
    contact::BodyMotion motion{head.begin, head.end, head.dt};
    if (group.moving >= 0) {
      const math::Pose& from = contact.moving[group.moving];
      const math::Pose& to = targets.empty() ? from : targets[group.moving];
      const math::Pose start = StartOf(from, to, head.dt / (end - begin));
      motion = {math::Interpolate(start, to, begin), math::Interpolate(start, to, end), head.dt};
    }
    motions->push_back(contact::MotionOf(motion, head));
  }
}

double Surprise(const Contact& contact, const rod::ClampMotion& head) {
  return head.dt * ((VelocityOf(head) - contact.velocity).norm() +
                    kArm * (SpinOf(head) - contact.spin).norm());
}

int FinenessFor(const Contact& contact, std::span<const math::Pose> targets,
                const rod::ClampMotion& head, int steps) {
  double way = Surprise(contact, head);
  for (size_t i = 0; i < targets.size(); ++i) {
    const math::Pose from = head.begin.Inverse() * StartOf(contact.moving[i], targets[i], head.dt);
    const math::Pose to = head.end.Inverse() * targets[i];
    way = std::max(way, (to.p - from.p).norm() + kArm * from.q.angularDistance(to.q));
  }
  const int finest = contact.bodies->wisps ? kFinestOfWisps : kFinest;
  int fineness = 1;
  while (fineness < finest && way > kLargestWay * steps * fineness) fineness *= 2;
  return fineness;
}

void Remember(const rod::ClampMotion& head, Contact* contact) {
  contact->velocity = VelocityOf(head);
  contact->spin = SpinOf(head);
}

uint32_t StepAmongBodies(int index, const rod::Batch<float>& batch,
                         const rod::Batch<float>::Block& block,
                         std::span<const rod::Row<float>, rod::layout::kDriveRows> drive,
                         std::span<const contact::GroupMotion> motions, double surprise,
                         std::span<rod::Row<float>> state, Contact* contact, float* bend) {
  thread_local contact::BatchContactScratch scratch;
  thread_local std::vector<const contact::BodyGroup*> groups;
  groups.clear();
  for (const Bodies::Group& group : contact->bodies->groups) groups.push_back(&group.bodies);
  const contact::BatchContact among{Kernels(), Meetings(), groups, motions, {}, surprise};
  return contact::StepBlockAmong(among, batch, block, contact->blocks[index].first_point, drive,
                                 MemoryOf(index, contact), state, scratch, bend);
}

}  // namespace mane::head
