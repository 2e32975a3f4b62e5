#include "contact/wisp_approach.h"

#include <algorithm>
#include <array>

namespace mane::contact {
namespace {

using Eigen::Vector3f;
using Contact = WispScratch::Contact;
using simd::kLanes;
using Approaches = std::array<simd::Row<float>, kApproachRows>;

constexpr int kSteps = 5;  // That a walk takes at most.

Vector3f Get(const Approaches& rows, int row, size_t lane) {
  const auto r = static_cast<size_t>(row);
  return {rows[r].lane[lane], rows[r + 1].lane[lane], rows[r + 2].lane[lane]};
}

// The steps from where a contact is at an end of its segments to the next ones along the guides
// that lead nearer: along both, along the first, along the second. Calls visit(points).
template <typename Visit>
void ForNext(const WispPoints& points, const WispScratch& scratch, const Contact& contact,
             const Visit& visit) {
  int32_t next[2];
  for (int k = 0; k < 2; ++k) {
    const float s = contact.fraction[k];
    next[k] = contact.point[k];
    const int way = s >= 1 ? 1 : s <= 0 ? -1 : 0;
    const int32_t p = contact.point[k] + way;
    if (way == 0 || p < 0) continue;
    const auto at = static_cast<size_t>(p);
    if (scratch.guide_of[at] != contact.guide[k]) continue;
    const Vector3f edge = points.Position(at + 1) - points.Position(at);
    const float nearer = (k == 0 ? -1.0f : 1.0f) * contact.approach.dot(edge);
    if (static_cast<float>(way) * nearer > 0) next[k] = p;
  }
  const bool one = next[0] != contact.point[0], two = next[1] != contact.point[1];
  if (one && two) visit(next[0], next[1]);
  if (one) visit(next[0], contact.point[1]);
  if (two) visit(contact.point[0], next[1]);
}

}  // namespace

float SumOfRadii(const WispPoints& points, const int32_t guide[2]) {
  const auto radius = [&](int32_t g) {
    return std::min(points.radius[static_cast<size_t>(g)], kLargestRadius);
  };
  return radius(guide[0]) + radius(guide[1]);
}

void FindApproaches(const WispPoints& points, const WispStep& step, const WispScratch& scratch,
                    std::span<Contact> contacts) {
  SegmentPairRows segments{};
  Approaches approaches;
  for (size_t first = 0; first < contacts.size(); first += kLanes) {
    const auto some = contacts.subspan(first, std::min<size_t>(kLanes, contacts.size() - first));
    for (size_t lane = 0; lane < some.size(); ++lane) {
      for (size_t end = 0; end < 4; ++end) {
        const auto p = static_cast<size_t>(some[lane].point[end / 2]) + end % 2;
        Put(scratch.start[p], kEnds + 3 * end, lane, segments);
        Put(points.velocity[p], kMotion + 3 * end, lane, segments);
      }
      segments[kTouchAt].lane[lane] = SumOfRadii(points, some[lane].guide);
    }
    step.kernels->approach(segments[0].lane, step.dt, approaches[0].lane);
    for (size_t lane = 0; lane < some.size(); ++lane) {
      Contact& contact = some[lane];
      contact.fraction[0] = approaches[kFractions].lane[lane];
      contact.fraction[1] = approaches[kFractions + 1].lane[lane];
      contact.distance = approaches[kLeastApart].lane[lane];
      contact.start = Get(approaches, kApart, lane);
      contact.approach = Get(approaches, kTouching, lane);
    }
  }
}

void Walk(const WispPoints& points, const WispStep& step, const WispScratch& scratch,
          std::span<Contact> contacts, WalkScratch& walk) {
  auto& walking = walk.walking;
  auto& next = walk.next;
  auto& next_of = walk.next_of;
  walking.resize(contacts.size());
  KeepRoom(walking), KeepRoom(next), KeepRoom(next_of);
  for (size_t i = 0; i < contacts.size(); ++i) walking[i] = static_cast<int32_t>(i);
  for (int steps = 0; steps < kSteps && !walking.empty(); ++steps) {
    next.clear(), next_of.clear();
    for (const int32_t i : walking) {
      const Contact& contact = contacts[static_cast<size_t>(i)];
      ForNext(points, scratch, contact, [&](int32_t first, int32_t second) {
        next.push_back({{contact.guide[0], contact.guide[1]},
                        {first, second},
                        {contact.origin[0], contact.origin[1]}});
        next_of.push_back(i);
      });
    }
    KeepRoom(next), KeepRoom(next_of);
    FindApproaches(points, step, scratch, next);
    walking.clear();
    for (size_t k = 0; k < next.size(); ++k) {
      Contact& contact = contacts[static_cast<size_t>(next_of[k])];
      if (next[k].distance >= contact.distance) continue;
      if (!walking.empty() && walking.back() == next_of[k]) continue;  // It has gone on.
      contact = next[k];
      walking.push_back(next_of[k]);
    }
  }
}

}  // namespace mane::contact
