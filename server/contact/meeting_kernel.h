#pragma once

/// How points of a block of strands meet bodies in a step (contact.md, K1 to K15), lane by lane;
/// only for sources that define MANE_ISA.

#include "contact/meeting_layout.h"
#include "rod/batch_layout.h"
#include "rod/scheme.h"
#include "simd/lanewise.h"

namespace mane::contact {
namespace MANE_ISA {

template <int W>
class Meetings : simd::MANE_ISA::Lanewise<float, W> {
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

  static bool Begin(const MeetingBlock& block, const MeetingNumbers& numbers,
                    const float* touched) {
    const int rows = block.wound ? int{rod::layout::kConstantsPerWoundElement}
                                 : int{rod::layout::kConstantsPerElement};
    const int stride = rows * kLanes;
    const float* element = block.constants + rod::layout::kFirstElement * kLanes;
    const V unit = Row(block.constants, rod::layout::kUnit);
    const float h = numbers.h, dt = numbers.dt;
    const int points = block.first_point[block.elements];
    int i = 0;
    V before{};  // Arc length of the element's left end [l0].
    V sag_before{};
    Middle before_it = NoMiddle();
    bool any = false;
    const float* point = block.points;
    float *meeting = block.meetings, *load = block.loads;
    unsigned char *loaded = block.loaded, *watched = block.watched;
    for (int Q = 0; Q < block.elements; ++Q, element += stride) {
      const V length = Row(element, rod::layout::kLength);
      const int count = block.first_point[Q + 1] - block.first_point[Q];
      const V share = (1.0F / static_cast<float>(count)) * length;
      const V radius = block.wound ? unit * Row(element, rod::layout::kRadius) : V{};
      for (int k = 0; k < count; ++k) {
        const V arc = unit * (before + static_cast<float>(k + 1) * share);
        // A coil's envelope, from nothing at the root.
        const V around = 0.25F * arc < radius ? 0.25F * arc : radius;
        const Middle after_it = ++i < points ? MiddleOf(meeting) : NoMiddle();
        const V sag_after = i < points ? Sag(point, meeting) : V{};
        V sag = sag_before > sag_after ? sag_before : sag_after;
        JoinMiddle(before_it, meeting);
        JoinMiddle(after_it, meeting);
        before_it = after_it;
        if (!block.wound) {
          const V bulge = Bulge(element, unit * share, count);
          sag = sag > bulge ? sag : bulge;
        }
        sag_before = sag_after;
        const V keeps = numbers.thickness + around + sag, room = Row(meeting, kRoom);
        const V gap = Row(meeting, kDistance) - (keeps < room ? keeps : room);
        const Vec n = Rows(meeting, kMeetNormal), surface = Rows(meeting, kSurface);
        const Vec last = Rows(point, rod::layout::kLastVelocity), over = last - surface;
        const V towards = Dot(n, over),
                near = kReach * h * Abs(towards) + (kNear + numbers.surprise);
        const auto meets = (arc >= numbers.root_length) & (gap < near);
        const V mass = meets ? share : V{};
        const V start = gap - h * towards, out = Dot(n, surface);
        const V allowed = start < 0.0F ? start : V{};
        const V least = (1.0F / dt) * (allowed - gap + h * Dot(n, last) + (dt - h) * out);  // K2
        // K9
        const V back = (-1.0F / dt) * allowed;
        const V speed = back < numbers.recovery_speed ? back : All(numbers.recovery_speed);
        // A coil gives way.
        const float soft = block.wound ? kCoilSoftness : 1;
        const V pull = mass * (numbers.recovery_pull * dt / soft);
        const V spring = (dt / (kLiftDepth * soft)) * pull, steep = pull / (speed + 1e-9F);
        Put(speed > 0.0F ? (spring < steep ? spring : steep) : V{}, meeting, kLift);
        Put(out + speed, meeting, kLiftSpeed);
        if (simd::MANE_ISA::Any(meets)) *watched = 1;
        ++watched;
        Put(mass, meeting, kMass);
        Put(least, meeting, kLeast);

        const V impulse = Row(touched, kTouched), size = Abs(impulse);
        const V falls = least - Dot(n, last), lift = Row(meeting, kLift);
        const auto was = size > 0.0F, holds = impulse > 0.0F;
        const auto stops = meets & ((falls > 0.0F) | (was & (lift == 0.0F)));
        const auto touches = stops | (meets & was);
        // K12
        const Vec drift = Rows(touched, kDrift);
        const Vec back_again = All(-1 / (kDrawSteps * dt)) * (drift - Dot(n, drift) * n);
        const Vec drawn = Select(was, back_again, Vec{V{}, V{}, V{}});
        Put(drawn, meeting, kDrawn);
        const Vec across = over - towards * n - drawn;
        const V slip = Speed(across), pressing = was ? size : mass * falls;
        const V most = Coefficient(meeting, point, across, slip) * pressing;
        const V hold = holds ? kHolding * mass : Rub(mass, most, slip);
        const V rub = touches ? (holds ? All(1) : All(-1)) : V{};
        any |= Load(stops ? kPressing * mass : V{}, least, rub, hold, n, surface, meeting, load,
                    loaded++);
        point += rod::layout::kPointRows * kLanes, touched += kTouchRows * kLanes;
        meeting += kMeetingRows * kLanes, load += rod::layout::kLoadRows * kLanes;
      }
      before += length;
    }
    return any;
  }

  static bool Revise(const MeetingBlock& block, const float* velocities) {
    bool any = false;
    const float* point = block.points;
    float *meeting = block.meetings, *load = block.loads;
    for (int i = 0; i < block.first_point[block.elements]; ++i,
             point += rod::layout::kPointRows * kLanes, velocities += 3 * kLanes,
             meeting += kMeetingRows * kLanes, load += rod::layout::kLoadRows * kLanes) {
      if (block.watched[i] == 0) continue;

      const V mass = Row(meeting, kMass), least = Row(meeting, kLeast), rub = Row(meeting, kRub);
      const Vec n = Rows(meeting, kMeetNormal), surface = Rows(meeting, kSurface);
      const Vec u = Rows(velocities, 0), over = u - surface;
      const Vec across = over - Dot(n, over) * n - Rows(meeting, kDrawn);
      const V speed = Dot(n, u), short_of = least - speed, slip = Speed(across);
      const auto stops = (mass > 0.0F) & (short_of > 0.0F);
      const V pressing = Pressing(meeting, speed);
      const V most = Coefficient(meeting, point, across, slip) * pressing;
      const auto stays = (Abs(rub) > 0.5F) & (kHolding * mass * slip <= most);
      // What friction no longer takes makes it faster, but not as if it were alone (K8).
      const V over_most = Row(load, rod::layout::kHold) * slip - most;
      const V faster = over_most > 0.0F ? slip + over_most / (kLettingGo * mass + 1e-30F) : slip;
      const V hold = stays ? kHolding * mass : Rub(mass, most, faster);
      const V next = pressing > 0.0F ? (stays ? All(1) : All(-1)) : V{};
      any |= simd::MANE_ISA::Any(Abs(next) + Abs(rub) > 0.5F);
      const V out = Dot(n, surface), press = stops ? kPressing * mass : V{};
      const V lacks = Row(meeting, kStiff) * short_of;
      const auto resists = stops & (lacks > 0.0F) & (least < out);
      Load(resists ? Resistance(lacks, out - speed, press) : press, resists ? out : least, next,
           hold, n, surface, meeting, load, block.loaded + i);
    }
    return any;
  }

  static bool Finish(const MeetingBlock& block, const float* velocities,
                     const MeetingNumbers& numbers, bool last, float* touched) {
    V wrong{};  // 1 in lanes where any load must change.
    const float *meeting = block.meetings, *load = block.loads, *u = velocities;
    for (int i = 0; i < block.first_point[block.elements]; ++i, u += 3 * kLanes,
             meeting += kMeetingRows * kLanes, load += rod::layout::kLoadRows * kLanes,
             touched += kTouchRows * kLanes) {
      const Vec none{V{}, V{}, V{}};
      Put(V{}, touched, kTouched);
      Put(none, touched, kDrift);
      if (block.watched[i] == 0) continue;

      const Vec n = Rows(meeting, kMeetNormal), over = Rows(u, 0) - Rows(meeting, kSurface);
      const V speed = Dot(n, Rows(u, 0)), rub = Row(meeting, kRub);
      const V pressing = Pressing(meeting, speed), sign = rub > 0.5F ? All(1) : All(-1);
      const auto touches = (Abs(rub) > 0.5F) & (pressing > 0.0F);
      Put(touches ? sign * pressing : V{}, touched, kTouched);
      // What is held creeps on; what slides is as far from where it was as what drew on it (K12).
      const Vec across = over - Dot(n, over) * n, drawn = Rows(meeting, kDrawn);
      const V hold = Row(load, rod::layout::kHold), largest = kHolding * Row(meeting, kMass);
      const Vec held = All(numbers.dt) * (across - All(kDrawSteps) * drawn);
      const Vec slid =
          All(kDrawSteps * numbers.dt) * (hold / (largest + 1e-30F)) * (across - drawn);
      Put(Select(touches, Select(rub > 0.5F, held, slid), none), touched, kDrift);
      const auto pulls = Pulls(meeting, speed), falls = Falls(meeting, speed);
      wrong = (pulls | falls) ? All(1) : wrong;
    }
    const auto again = wrong > 0.5F;
    if (!simd::MANE_ISA::Any(again)) return false;
    Amend(block, velocities, last, again);
    return true;
  }

 private:
  // Of a point's own mass: what resists penetration and what holds it sideways within a step (K2,
  // K3); less than in double precision, as float32 has six digits for them and the free directions.
  static constexpr float kPressing = 1e3F;
  static constexpr float kHolding = 1.6e4F;
  static constexpr float kDrawSteps = 4;      // In which what is held goes back where it was (K12).
  static constexpr float kLettingGo = 1e3F;   // Masses that go along with one that lets go (K8).
  static constexpr float kStillMore = 0.03F;  // Of friction at rest over that of sliding (K15),
  static constexpr float kStillSpeed = 5e-3F;  // half of which is left at this speed [m/s].
  static constexpr float kSoftStop = 4;        // Of what falls at last, over its own mass (K8).
  static constexpr float kLiftDepth = 1e-3F;   // At which what lifts is at its most (K9) [m].
  static constexpr float kMostSag = 3e-3F;     // Kept away for what lies between points [m],
  static constexpr float kSagReach = 2e-2F;    // of those that are so near.
  static constexpr float kSharp = 6e-4F;       // That by a bulge, bodies are looked at there [m],
  static constexpr float kAskReach = 2e-2F;    // if both ends together are so near [m],
  static constexpr float kEdge = 0.15F;  // but for these parts of the way next to points (K14).
  static constexpr float kJoin = 2e-3F;  // Width in which two bodies join (K13) [m].
  static constexpr float kCoilSoftness = 3;
  static constexpr float kPlaneReach = 1.2e-3F;  // K7 [m]
  static constexpr float kPlaneShare = 0.3F;
  static constexpr float kSure = 0.1F;           // Distances up to here are those of fields [m],
  static constexpr float kSureShare = 1.0F / 3;  // and beyond no less than this part of them (D12).
  static constexpr float kLying = 3e-3F;         // Of what lies so near [m], no more than this [m]
  static constexpr float kSlowReach = 2e-6F;     // and what it moves
  static constexpr float kSlowSteps = 4;         // in so many steps.
  static constexpr float kSlack = 2e-2F;         // Of a velocity that K2 asks for [m/s].
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
  // mu by the cosine law (K4), and more of what hardly moves (K15).
  static V Coefficient(const float* meeting, const float* point, const Vec& across, const V& slip) {
    const V along = Dot(Rows(point, rod::layout::kTangent), across) / slip;
    const V still = 1.0F + kStillMore * kStillSpeed / (kStillSpeed + slip);
    return still * Row(meeting, kMeetFriction) * (1.0F + Row(meeting, kMeetAnisotropy) * along);
  }
  // A spring that pulls its point nearer to the body.
  static auto Pulls(const float* meeting, const V& speed) {
    const V to = Row(meeting, kStopSpeed);
    const V out = Dot(Rows(meeting, kMeetNormal), Rows(meeting, kSurface));
    return (Row(meeting, kStiff) > 0.0F) & (to < speed) & (speed < out - 1e-6F);
  }
  // What nothing stops, or too little, would fall in.
  static auto Falls(const float* meeting, const V& speed) {
    const V least = Row(meeting, kLeast);
    const V stiff = Row(meeting, kStiff), to = Row(meeting, kStopSpeed), mass = Row(meeting, kMass);
    const auto soft = (stiff == 0.0F) | (to > least);
    return soft & (mass > 0.0F) & (least - speed > kSlack);
  }
  // What gives the impulse `needs` to what comes nearer at `speed`.
  static V Resistance(const V& needs, const V& speed, const V& largest) {
    const V resistance = needs / (speed > 1e-9F ? speed : All(1e-9F));
    return resistance < largest ? resistance : largest;
  }
  // New loads in the lanes `again`: what falls is stopped, and every other point that comes nearer
  // is resisted with what pressed it, so that nothing pulls (K8).
  template <typename M>
  static void Amend(const MeetingBlock& block, const float* u, bool last, const M& again) {
    const float* point = block.points;
    float *meeting = block.meetings, *load = block.loads;
    for (int i = 0; i < block.first_point[block.elements]; ++i,
             point += rod::layout::kPointRows * kLanes, u += 3 * kLanes,
             meeting += kMeetingRows * kLanes, load += rod::layout::kLoadRows * kLanes) {
      if (block.watched[i] == 0) continue;

      const V mass = Row(meeting, kMass), rub = Row(meeting, kRub), least = Row(meeting, kLeast);
      const V stiff = Row(meeting, kStiff), to = Row(meeting, kStopSpeed);
      const Vec n = Rows(meeting, kMeetNormal), surface = Rows(meeting, kSurface);
      const Vec velocity = Rows(u, 0), over = velocity - surface;
      const Vec across = over - Dot(n, over) * n - Rows(meeting, kDrawn);
      const V speed = Dot(n, velocity), out = Dot(n, surface), slip = Speed(across);
      const auto falls = Falls(meeting, speed), nears = (speed < out - 1e-6F) & (to < out);
      const V lacks = to > speed ? stiff * (to - speed) : V{}, hard = kPressing * mass;
      const V resists = nears ? Resistance(lacks, out - speed, hard) : stiff;
      const V needs = kSoftStop * mass * (least - speed);
      const V stops = last ? Resistance(needs, out - least, hard) : hard;
      const V press = falls ? stops : resists;
      const V stop = falls ? (last ? out : least) : ((nears & (press > 0.0F)) ? out : to);
      const V most = Coefficient(meeting, point, across, slip) * Pressing(meeting, speed);
      const V hold = Row(load, rod::layout::kHold);
      const V rubs = (falls | ((rub < -0.5F) & nears)) ? Rub(mass, most, slip) : hold;
      Load(again ? press : stiff, again ? stop : to, (again & falls) ? All(-1) : rub,
           again ? rubs : hold, n, surface, meeting, load, block.loaded + i);
    }
  }
  // Resistance of what slides at `slip` under the friction `most` (K4).
  static V Rub(const V& mass, const V& most, const V& slip) {
    const V hold = most / slip, largest = kHolding * mass;
    return hold < largest ? hold : largest;
  }
  // Normal impulse of a point in a solution: what stops it, if anything does, and what lifts it; of
  // one that was free, what would stop its own mass.
  static V Pressing(const float* meeting, const V& speed) {
    const V stiff = Row(meeting, kStiff);
    const auto stopped = stiff > 0.0F;
    const V short_of = (stopped ? Row(meeting, kStopSpeed) : Row(meeting, kLeast)) - speed;
    const V stopping = short_of > 0.0F ? (stopped ? stiff : Row(meeting, kMass)) * short_of : V{};
    const V lifting = Row(meeting, kLift) * (Row(meeting, kLiftSpeed) - speed);
    return stopping + (lifting > 0.0F ? lifting : V{});
  }
  // Loads of a point: kept by `press` from being slower than `stop` along the normal, rubbed with
  // `hold` where `rub` is not 0, and lifted.
  static bool Load(const V& press, const V& stop, const V& rub, const V& hold, const Vec& n,
                   const Vec& surface, float* meeting, float* load, unsigned char* loaded) {
    const V lift = Row(meeting, kLift), held = Abs(rub) > 0.5F ? hold : V{};
    const V out = Dot(n, surface);
    Put(rub, meeting, kRub);
    Put(press, meeting, kStiff);
    Put(stop, meeting, kStopSpeed);
    Put(n, load, rod::layout::kNormal);
    Put(press + lift, load, rod::layout::kPress);
    Put(held, load, rod::layout::kHold);
    const V along = press * stop + lift * Row(meeting, kLiftSpeed);
    Put(along * n + held * (surface - out * n + Rows(meeting, kDrawn)), load, rod::layout::kPush);
    Put(lift > 0.0F ? Row(meeting, kLiftSpeed) : out, load, rod::layout::kSurfaceSpeed);
    const bool any = simd::MANE_ISA::Any(press + lift + held > 0.0F);
    if (any) *loaded = 1;
    return any;
  }
};

/// The table for W lanes at a time.
template <int W>
struct MeetingTable {
  template <typename Visit>
  static bool Groups(const Visit& visit) {
    bool any = false;
    for (int lane = 0; lane < rod::layout::kLanes; lane += W) any |= visit(lane);
    return any;
  }
  static MeetingBlock At(MeetingBlock block, int lane) {
    block.constants += lane, block.points += lane, block.meetings += lane, block.loads += lane;
    return block;
  }

  static bool Look(int points, const float* point, const GroupMotion& group,
                   const MeetingNumbers& numbers, const float* seen, float* local, float* stale,
                   unsigned char* any_stale) {
    return Groups([&](int l) {
      return Meetings<W>::Look(points, point + l, group, numbers, seen + l, local + l, stale + l,
                               any_stale);
    });
  }
  static void Meet(int points, const float* point, const GroupMotion& group, const float* seen,
                   const float* local, bool first, float* meeting) {
    Groups([&](int l) {
      Meetings<W>::Meet(points, point + l, group, seen + l, local + l, first, meeting + l);
      return false;
    });
  }
  static bool Between(int points, const float* point, const GroupMotion& group, const float* seen,
                      const float* local, float* places, float* sharp, unsigned char* any_sharp) {
    return Groups([&](int l) {
      return Meetings<W>::Between(points, point + l, group, seen + l, local + l, places + l,
                                  sharp + l, any_sharp);
    });
  }
  static bool Begin(const MeetingBlock& block, const MeetingNumbers& numbers,
                    const float* touched) {
    return Groups([&](int l) { return Meetings<W>::Begin(At(block, l), numbers, touched + l); });
  }
  static bool Revise(const MeetingBlock& block, const float* velocities) {
    return Groups([&](int l) { return Meetings<W>::Revise(At(block, l), velocities + l); });
  }
  static bool Finish(const MeetingBlock& block, const float* velocities,
                     const MeetingNumbers& numbers, bool last, float* touched) {
    return Groups([&](int l) {
      return Meetings<W>::Finish(At(block, l), velocities + l, numbers, last, touched + l);
    });
  }
  static constexpr MeetingKernels Make() {
    return {&Look, &Meet, &Between, &Begin, &Revise, &Finish};
  }
};

}  // namespace MANE_ISA
}  // namespace mane::contact
