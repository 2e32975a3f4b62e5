#pragma once

/// What points of a block of strands see of bodies (contact.md, K7, K10, K13, K14), lane by lane;
/// only for sources that define MANE_ISA.

#include "contact/meeting_layout.h"
#include "rod/batch_layout.h"
#include "simd/lanewise.h"

namespace mane::contact {
namespace MANE_ISA {

template <int W>
class Sight : protected simd::MANE_ISA::Lanewise<float, W> {
 protected:
  using Base = simd::MANE_ISA::Lanewise<float, W>;
  using Base::All;
  using Base::Put;
  using Base::Row;
  using Base::Rows;
  using typename Base::V;
  using typename Base::Vec;
  template <typename X>
  using Frame = simd::MANE_ISA::Frame<X>;
  static constexpr int kLanes = rod::layout::kLanes;

 public:
  static bool Look(int points, const float* point, const GroupMotion& group,
                   const MeetingNumbers& numbers, const float* seen, float* local, float* stale,
                   unsigned char* any_stale) {
    const Frame<V> R = FrameOf(group);
    const Vec p = Broadcast(group.position);
    bool any = false;
    for (int i = 0; i < points; ++i) {
      const Vec x = Rows(point, rod::layout::kPosition) - p;
      const Vec at = TransposeTimes(R, x), moved = at - Rows(seen, kSeenAt);
      const V way2 = Dot(moved, moved);
      // Not far, and farther along than the plane seen there serves. Anything but a number is new.
      const V speed = SpeedOver(point, group, x);
      const V reach = kReach * numbers.h * speed + (kNear + 2 * kPlaneReach + numbers.surprise);
      const V distance = Row(seen, kSeenDistance), spare = Sure(distance) - reach;
      // Of what lies on a body and hardly moves, for some steps only: nothing may jump there.
      const V far = PlaneReach(distance), slow = kSlowReach + kSlowSteps * numbers.dt * speed;
      const V serves = ((slow < far) & (distance < kLying)) ? slow : far;
      const V limit = spare > serves ? spare : serves;
      const auto fresh = way2 < limit * limit;
      const V flag = fresh ? V{} : All(1);
      Put(at, local, 0);
      Put(flag, stale, 0);
      if (simd::MANE_ISA::Any(flag > 0.5F)) any_stale[i] = 1, any = true;
      point += rod::layout::kPointRows * kLanes;
      seen += kSeenRows * kLanes, local += 3 * kLanes, stale += kLanes;
    }
    return any;
  }

  static void Meet(int points, const float* point, const GroupMotion& group, const float* seen,
                   const float* local, bool first, float* meeting) {
    const Frame<V> R = FrameOf(group);
    const Vec p = Broadcast(group.position), v = Broadcast(group.velocity),
              w = Broadcast(group.spin);
    for (int i = 0; i < points; ++i) {
      const Vec x = Rows(point, rod::layout::kPosition) - p;
      const Vec moved = Rows(local, 0) - Rows(seen, kSeenAt), n = Rows(seen, kSeenNormal);
      const V square = Dot(moved, moved), serves = PlaneReach(Row(seen, kSeenDistance));
      // The plane that was seen holds near by; farther off only that the body is not near.
      const V distance =
          square < serves * serves ? Row(seen, kSeenDistance) + Dot(n, moved) : All(kFar);
      const Vec outward = R * n, surface = v + Cross(w, x);
      const Group own{distance, outward, surface, Row(seen, kSeenFriction),
                      Row(seen, kSeenAnisotropy)};
      V room = All(kFar);
      const Group all = first ? own : Join(GroupsBefore(meeting), own, Row(meeting, kRoom), &room);
      Put(all.distance, meeting, kDistance);
      Put(all.normal, meeting, kMeetNormal);
      Put(all.surface, meeting, kSurface);
      Put(all.friction, meeting, kMeetFriction);
      Put(all.anisotropy, meeting, kMeetAnisotropy);
      Put(room, meeting, kRoom);
      if (first) Put(All(kFar), meeting, kMiddle);
      point += rod::layout::kPointRows * kLanes;
      seen += kSeenRows * kLanes, local += 3 * kLanes, meeting += kMeetingRows * kLanes;
    }
  }

  static bool Between(int points, const float* point, const GroupMotion& group, const float* seen,
                      const float* local, float* place, float* sharp, unsigned char* any_sharp) {
    const Frame<V> R = FrameOf(group);
    bool any = false;
    for (int i = 0; i + 1 < points; ++i, point += rod::layout::kPointRows * kLanes,
             seen += kSeenRows * kLanes, local += 3 * kLanes, place += 3 * kLanes,
             sharp += kLanes) {
      Put(V{}, sharp, 0);
      // Nothing is farther from both ends than they are from each other. What lies deep comes out
      // where its points say.
      const V d = Row(seen, kSeenDistance), d_next = Row(seen, kSeenRows + kSeenDistance);
      const auto near = (d + d_next < kAskReach) & (d > -kMostSag) & (d_next > -kMostSag);
      if (!simd::MANE_ISA::Any(near)) continue;
      const Vec n = Rows(seen, kSeenNormal), n_next = Rows(seen, kSeenRows + kSeenNormal);
      const Vec at = Rows(local, 0), next = Rows(local, 3), way = next - at;
      const V in = Dot(n, way), out = Dot(n_next, way), turns = out - in;
      const auto asks = near & (0.125F * turns > kSharp);
      Put(asks ? All(1) : V{}, sharp, 0);
      if (!simd::MANE_ISA::Any(asks)) continue;
      // Where the planes of both are as deep; there on the curve with the tangents of both.
      const V apart = d - d_next + Dot(n, at - Rows(seen, kSeenAt)) -
                      Dot(n_next, next - Rows(seen, kSeenRows + kSeenAt));
      const V cross = (apart + out) / (turns > 1e-6F ? turns : All(1e-6F));
      const V s = cross > kEdge ? (cross < 1 - kEdge ? cross : All(1 - kEdge)) : All(kEdge);
      const V rest = All(1) - s, length = Speed(way);
      const Vec t = TransposeTimes(R, Rows(point, rod::layout::kTangent)),
                t_next =
                    TransposeTimes(R, Rows(point, rod::layout::kPointRows + rod::layout::kTangent));
      const Vec bent = rest * (length * t - way) - s * (length * t_next - way);
      Put(at + s * way + (s * rest) * bent, place, 0);
      any_sharp[i] = 1, any = true;
    }
    return any;
  }

 protected:
  static constexpr float kMostSag = 3e-3F;   // Kept away for what lies between points [m],
  static constexpr float kSagReach = 2e-2F;  // of those that are so near.
  static constexpr float kSharp = 6e-4F;     // That by a bulge, bodies are looked at there [m],
  static constexpr float kAskReach = 2e-2F;  // if both ends together are so near [m],
  static constexpr float kEdge = 0.15F;      // but for these parts of the way next to points (K14).
  static constexpr float kJoin = 2e-3F;      // Width in which two bodies join (K13) [m].
  static constexpr float kPlaneReach = 1.2e-3F;  // K7 [m]
  static constexpr float kPlaneShare = 0.3F;
  static constexpr float kSure = 0.1F;           // Distances up to here are those of fields [m],
  static constexpr float kSureShare = 1.0F / 3;  // and beyond no less than this part of them (D12).
  static constexpr float kLying = 3e-3F;         // Of what lies so near [m], no more than this [m]
  static constexpr float kSlowReach = 2e-6F;     // and what it moves
  static constexpr float kSlowSteps = 4;         // in so many steps.
  static constexpr float kNear = 4e-3F;          // Points are looked at from here on [m],
  static constexpr float kReach = 2;             // or from this many times what they move in h.
  static constexpr float kFar = 1e9F;

  // What a point sees of a group of bodies.
  struct Group {
    V distance;
    Vec normal, surface;
    V friction, anisotropy;
  };
  static Group GroupsBefore(const float* meeting) {
    return {Row(meeting, kDistance), Rows(meeting, kMeetNormal), Rows(meeting, kSurface),
            Row(meeting, kMeetFriction), Row(meeting, kMeetAnisotropy)};
  }
  // Two groups as one body (K13).
  static Group Join(const Group& a, const Group& b, const V& room_before, V* room) {
    const V facing = Dot(a.normal, b.normal), open = 2.0F + 2.0F * facing;
    const V width = kJoin * (open < 1.0F ? (open > 0.0F ? open : V{}) : All(1)) + 1e-6F;
    const V ahead = 0.5F + 0.5F * (a.distance - b.distance) / width;
    const V part = ahead < 1.0F ? (ahead > 0.0F ? ahead : V{}) : All(1);  // That b has.
    const V own = All(1) - part;
    const Vec n = own * a.normal + part * b.normal;
    // From bodies that face each other to those at 120 degrees, which join.
    const V opposed = -1.0F - 2.0F * facing, across = opposed > 0.01F ? opposed : All(0.01F);
    const V half = 0.5F * (a.distance + b.distance) / across, some = half > 0.0F ? half : V{};
    *room = some < room_before ? some : room_before;
    return {own * a.distance + part * b.distance - width * own * part, (1.0F / Speed(n)) * n,
            own * a.surface + part * b.surface, own * a.friction + part * b.friction,
            own * a.anisotropy + part * b.anisotropy};
  }
  // What a body is like between a point and the next (K14).
  struct Middle {
    V distance;
    Vec normal, surface;
  };
  static Middle NoMiddle() { return {All(kFar), Vec{V{}, V{}, V{}}, Vec{V{}, V{}, V{}}}; }
  static Middle MiddleOf(const float* meeting) {
    return {Row(meeting, kMiddle), Rows(meeting, kMiddleNormal), Rows(meeting, kMiddleSurface)};
  }
  // A point meets what lies beside it as if it were another body.
  static void JoinMiddle(const Middle& middle, float* meeting) {
    const auto counts = middle.distance < kFar;
    if (!simd::MANE_ISA::Any(counts)) return;
    const Group own = GroupsBefore(meeting);
    V room = All(kFar);
    const Group all =
        Join(own, {middle.distance, middle.normal, middle.surface, own.friction, own.anisotropy},
             room, &room);
    Put(counts ? all.distance : own.distance, meeting, kDistance);
    Put(Select(counts, all.normal, own.normal), meeting, kMeetNormal);
    Put(Select(counts, all.surface, own.surface), meeting, kSurface);
  }
  static V Farther(const float* meeting) {
    const V distance = Row(meeting, kDistance), next = Row(meeting, kMeetingRows + kDistance);
    return distance > next ? distance : next;
  }
  // Height of the arc between two points `apart` [m] of an element with its natural curvature (K10)
  // [m].
  static V Bulge(const float* element, const V& apart, int count) {
    const V b1 = Row(element, rod::layout::kNatural + 1),
            b2 = Row(element, rod::layout::kNatural + 2);
    const V bend =
        (1.0F / static_cast<float>(count)) * simd::MANE_ISA::Sqrt(b1 * b1 + b2 * b2 + 1e-20F);
    const V height = 0.125F * apart * bend;
    return height < kMostSag ? height : All(kMostSag);
  }
  // How much deeper than a point and the next the strand lies in a body between them: the body's
  // surface bulges there, and the strand bends towards it (K10) [m].
  static V Sag(const float* point, const float* meeting) {
    // What has been looked at is known.
    const V farther = Farther(meeting), middle = Row(meeting, kMiddle);
    const auto counts = (farther < kSagReach) & (middle >= kFar);
    if (!simd::MANE_ISA::Any(counts)) return V{};
    const Vec n = Rows(meeting, kMeetNormal), t = Rows(point, rod::layout::kTangent);
    const Vec turned = Rows(meeting, kMeetingRows + kMeetNormal) - n;
    const Vec bent = Rows(point, rod::layout::kPointRows + rod::layout::kTangent) - t;
    const Vec way = Rows(point, rod::layout::kPointRows) - Rows(point, 0);
    const V sag = 0.125F * (Dot(turned, way) + Speed(way) * Dot(bent, n + All(0.5F) * turned));
    return (counts & (sag > 0.0F)) ? (sag < kMostSag ? sag : All(kMostSag)) : V{};
  }
  static V Abs(const V& x) { return x > 0.0F ? x : -x; }
  static V Speed(const Vec& u) { return simd::MANE_ISA::Sqrt(Dot(u, u) + 1e-20F); }
  static Vec Broadcast(const float (&a)[3]) { return {All(a[0]), All(a[1]), All(a[2])}; }
  static Frame<V> FrameOf(const GroupMotion& group) {
    const float* f = group.frame;
    return {{All(f[0]), All(f[1]), All(f[2])},
            {All(f[3]), All(f[4]), All(f[5])},
            {All(f[6]), All(f[7]), All(f[8])}};
  }
  // How far a plane seen at this distance serves [m] (K7).
  static V PlaneReach(const V& distance) {
    return kPlaneReach + (distance > 0.0F ? kPlaneShare * distance : V{});
  }
  // What is left of a distance that may be too large (D12) [m].
  static V Sure(const V& distance) {
    const V part = kSureShare * distance, least = part > kSure ? part : All(kSure);
    return distance < least ? distance : least;
  }
  // How fast a point at `x` from the group's place moves relative to it [m/s].
  static V SpeedOver(const float* point, const GroupMotion& group, const Vec& x) {
    return Speed(Rows(point, rod::layout::kLastVelocity) - Broadcast(group.velocity) -
                 Cross(Broadcast(group.spin), x));
  }
};

}  // namespace MANE_ISA
}  // namespace mane::contact
