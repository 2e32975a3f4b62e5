#pragma once

/// How points of a block of strands meet the bodies that they see (contact.md, K1 to K15), lane by
/// lane; only for sources that define MANE_ISA.

#include "contact/meeting_layout.h"
#include "contact/meeting_sight.h"
#include "rod/batch_layout.h"
#include "rod/scheme.h"
#include "simd/lanewise.h"

namespace mane::contact {
namespace MANE_ISA {

template <int W>
class Meetings : Sight<W> {
  using Base = Sight<W>;
  using Base::Abs;
  using Base::All;
  using Base::Bulge;
  using Base::JoinMiddle;
  using Base::kFar;
  using Base::kNear;
  using Base::kReach;
  using Base::MiddleOf;
  using Base::NoMiddle;
  using Base::Put;
  using Base::Row;
  using Base::Rows;
  using Base::Sag;
  using Base::Speed;
  using typename Base::Middle;
  using typename Base::V;
  using typename Base::Vec;
  static constexpr int kLanes = rod::layout::kLanes;

 public:
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
  static constexpr float kCoilSoftness = 3;
  static constexpr float kSlack = 2e-2F;  // Of a velocity that K2 asks for [m/s].
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
      return Sight<W>::Look(points, point + l, group, numbers, seen + l, local + l, stale + l,
                            any_stale);
    });
  }
  static void Meet(int points, const float* point, const GroupMotion& group, const float* seen,
                   const float* local, bool first, float* meeting) {
    Groups([&](int l) {
      Sight<W>::Meet(points, point + l, group, seen + l, local + l, first, meeting + l);
      return false;
    });
  }
  static bool Between(int points, const float* point, const GroupMotion& group, const float* seen,
                      const float* local, float* places, float* sharp, unsigned char* any_sharp) {
    return Groups([&](int l) {
      return Sight<W>::Between(points, point + l, group, seen + l, local + l, places + l, sharp + l,
                               any_sharp);
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
