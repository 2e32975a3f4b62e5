#include "contact/wisp_pairs.h"

#include <algorithm>
#include <cmath>

#include <tuple>
#include <utility>

#include "contact/wisp_ends.h"
#include "contact/wisp_impulse.h"
#include "contact/wisp_neighbours.h"
#include "contact/wisp_search.h"
#include "rod/scheme.h"

namespace mane::contact {
namespace {

using Eigen::Vector3f;
using Contact = WispScratch::Contact;

constexpr int kGuidesAPiece = WispScratch::kGuidesAPiece;
// A pair goes on along its guides by this many segments within a step.
constexpr float kFarthestFollowed = 2.5f;
// A push that stops the pair at no more than this goes on; larger ones may double in a step [m/s].
constexpr float kCarried = 0.3f;
// What slides no faster goes on being held [m/s].
constexpr float kSticking = 0.02f;
constexpr float kLostCrossed = 2;  // Wisps that crossed and are this many radii apart are let go.
constexpr float kFastestParting = 10;  // What parts faster is let go as at this [m/s].

auto GuidesOf(const WispPair& pair) { return std::tie(pair.guide[0], pair.guide[1]); }

// Goes through old pairs by guides, as contacts do.
class OldPairs {
 public:
  OldPairs(const std::vector<WispPair>& old, int guide)
      : begin_(std::lower_bound(
            old.begin(), old.end(), guide,
            [](const WispPair& pair, int first) { return pair.guide[0] < first; })),
        end_(begin_),
        last_(old.end()) {}

  // Those of the same two guides, which are no earlier ones than the last time.
  std::span<const WispPair> Of(const int32_t guide[2]) {
    const auto key = std::tie(guide[0], guide[1]);
    if (begin_ != end_ && GuidesOf(*begin_) == key) return {begin_, end_};
    for (begin_ = end_; begin_ != last_ && GuidesOf(*begin_) < key;) ++begin_;
    for (end_ = begin_; end_ != last_ && GuidesOf(*end_) == key;) ++end_;
    return {begin_, end_};
  }

 private:
  std::vector<WispPair>::const_iterator begin_, end_, last_;
};

// How far a pair would have to go along the guides [segments].
float Along(const WispPair& old, const Contact& contact) {
  float sum = 0;
  for (int k = 0; k < 2; ++k) {
    sum += std::abs(static_cast<float>(contact.point[k] - old.point[k]) + contact.fraction[k] -
                    old.fraction[k]);
  }
  return sum;
}

// A pair that goes on takes with it what it pushes with, once (H7).
void Continue(const WispPair& old, bool first, double steps, WispPair& pair) {
  const float push = old.impulse.dot(old.normal);
  if (!first || !(push > 0) || !(steps > 0)) return;
  pair.past_push[0] = push * static_cast<float>(steps);
  pair.past_push[1] = old.past_push[0] * static_cast<float>(steps);
  const Eigen::Vector3f& n = pair.normal;
  const Eigen::Vector3f w = pair.velocity[0] - pair.velocity[1];
  if ((w - w.dot(n) * n).norm() < kSticking) {
    pair.held = static_cast<float>(steps) * (old.impulse - old.impulse.dot(n) * n);
  }
  pair.rebound = static_cast<float>((1 - rod::kTheta) / rod::kTheta) * push;
}

// Whether a pair that was lost sight of goes on (H4): crossed wisps until they are far apart, and
// those that began the step no farther out of reach than they part by in one: they may turn round
// in it, and pass through.
bool GoesOn(const WispPair& pair, const Contact& contact, float reach, float dt) {
  const float distance = contact.start.norm(), near = (1 + kMargin) * reach;
  if (contact.start.dot(pair.normal) < 0) return distance <= kLostCrossed * reach;
  const float parting = (pair.velocity[0] - pair.velocity[1]).dot(pair.normal);
  return distance > near && distance <= near + dt * std::min(parting, kFastestParting);
}

// The pairs of one piece of guides: found ones, then those that were lost sight of.
void FindPairs(const WispPoints& points, const WispStep& step, const WispSettings& settings,
               double steps, int begin, int end, WispScratch& scratch, WispNeighbours& neighbours,
               WispScratch::Piece& piece) {
  piece.pairs.clear();
  OldPairs old_pairs(scratch.pairs, begin);
  for (const Contact& contact : FindContacts(points, step, scratch, begin, end, neighbours)) {
    const WispPair* nearest = nullptr;
    float least = kFarthestFollowed;
    for (const WispPair& old : old_pairs.Of(contact.guide)) {
      const float along = Along(old, contact);
      if (along >= least) continue;
      least = along;
      nearest = &old;
    }
    piece.pairs.push_back(MakePair(points, step, settings, scratch, contact, nearest));
    if (!nearest) continue;
    uint8_t& followed = scratch.followed[static_cast<size_t>(nearest - scratch.pairs.data())];
    Continue(*nearest, !followed, steps, piece.pairs.back());
    followed = 1;
  }

  const auto by_guide = [](const WispPair& pair, int guide) { return pair.guide[0] < guide; };
  const size_t found = piece.pairs.size();
  thread_local std::vector<Contact> lost;
  thread_local std::vector<const WispPair*> old_of;
  lost.clear(), old_of.clear();
  for (auto old = std::lower_bound(scratch.pairs.begin(), scratch.pairs.end(), begin, by_guide);
       old != scratch.pairs.end() && old->guide[0] < end; ++old) {
    const auto usable = [&](int k) {
      const auto p = static_cast<size_t>(old->point[k]);
      return p < scratch.guide_of.size() && scratch.guide_of[p] == old->guide[k];
    };
    if (scratch.followed[static_cast<size_t>(old - scratch.pairs.begin())] || !usable(0) ||
        !usable(1)) {
      continue;
    }
    lost.push_back({{old->guide[0], old->guide[1]},
                    {old->point[0], old->point[1]},
                    {old->point[0], old->point[1]}});
    old_of.push_back(&*old);
  }
  FindApproaches(points, step, scratch, lost);
  for (size_t k = 0; k < lost.size(); ++k) {
    const Contact& contact = lost[k];
    const WispPair& old = *old_of[k];
    const WispPair pair = MakePair(points, step, settings, scratch, contact, &old);
    if (!GoesOn(pair, contact, SumOfRadii(points, pair.guide), step.dt)) continue;
    piece.pairs.push_back(pair);
    Continue(old, true, steps, piece.pairs.back());
  }
  KeepRoom(lost), KeepRoom(old_of);
  KeepRoom(piece.pairs);
  if (piece.pairs.size() == found) return;
  std::sort(piece.pairs.begin(), piece.pairs.end(), [](const WispPair& a, const WispPair& b) {
    return std::tie(a.guide[0], a.guide[1], a.point[0], a.point[1]) <
           std::tie(b.guide[0], b.guide[1], b.point[0], b.point[1]);
  });
}

// (H6): a point's mass is shared by the pairs that may act on it.
void ShareMasses(const WispPoints& points, float dt, std::span<WispPair> pairs,
                 WispScratch& scratch, exec::WorkerPool& pool) {
  scratch.share.resize(points.mass.size());
  pool.ParallelFor(points.size(), kPointsAPiece, [&](int begin, int end) {
    SumAtPoints(
        begin, end, pairs, scratch, 0.0f,
        [&](const WispPair& pair, int) { return MayTouch(pair, dt) ? 1.0f : 0.0f; },
        [&](size_t p, float share) { scratch.share[p] = share; });
  });
  pool.ParallelFor(static_cast<int>(pairs.size()), kPairsAPiece, [&](int begin, int end) {
    for (WispPair& pair :
         pairs.subspan(static_cast<size_t>(begin), static_cast<size_t>(end - begin))) {
      for (int k = 0; k < 2; ++k) {
        const auto p = static_cast<size_t>(pair.point[k]);
        const float s = pair.fraction[k];
        pair.inverse_mass[k] = (1 - s) * std::max(1 - s, scratch.share[p]) / points.mass[p] +
                               s * std::max(s, scratch.share[p + 1]) / points.mass[p + 1];
      }
    }
  });
}

}  // namespace

void WispTracker::Begin(const WispPoints& points, double dt, WispScratch& scratch,
                        exec::WorkerPool& pool, const ImpulseSpans& impulses) {
  dt = dt >= 1e-5 ? std::min(dt, 0.25) : 1e-5;
  const WispStep step{
      static_cast<float>(dt), static_cast<float>(rod::kTheta * dt),
      static_cast<float>(-std::expm1(-dt / std::max(1e-3, settings_.relaxation_time))),
      !(last_dt_ > 0), kernels_};
  const double steps = last_dt_ > 0 ? std::min(1.0, dt / last_dt_) : 0;
  std::swap(pairs_, scratch.pairs);
  scratch.followed.assign(scratch.pairs.size(), 0);

  const auto pieces = static_cast<size_t>((points.guides() + kGuidesAPiece - 1) / kGuidesAPiece);
  if (scratch.pieces.size() < pieces) scratch.pieces.resize(pieces);
  FindNeighbours(points, step, settings_, scratch, pool, neighbours_);
  pool.ParallelFor(points.guides(), kGuidesAPiece, [&](int begin, int end) {
    FindPairs(points, step, settings_, steps, begin, end, scratch, neighbours_,
              scratch.pieces[static_cast<size_t>(begin / kGuidesAPiece)]);
  });
  pairs_.clear();
  for (size_t i = 0; i < pieces; ++i) {
    pairs_.insert(pairs_.end(), scratch.pieces[i].pairs.begin(), scratch.pieces[i].pairs.end());
  }

  KeepRoom(pairs_);
  scratch.pairs.reserve(pairs_.capacity());
  scratch.ends.reserve(2 * pairs_.capacity());
  scratch.followed.reserve(pairs_.capacity());
  scratch.passing.reserve(pairs_.capacity());
  scratch.revised.reserve(2 * pairs_.capacity());
  scratch.passing_by.reserve(pairs_.capacity());
  scratch.passing_by.resize(pairs_.size());
  scratch.first_point.assign(points.first.begin(), points.first.end());
  heaviness_.resize(points.radius.size());
  scratch.heaviness.reserve(heaviness_.size());
  ListEnds(pairs_, points.mass.size(), scratch);
  ShareMasses(points, step.dt, pairs_, scratch, pool);
  for (WispPair& pair : pairs_) {
    SetMasses(heaviness_, pair);
    StartImpulse(pair.gap <= 0 ? std::min(pair.past_push[0], std::max(2 * pair.past_push[1],
                                                                      kCarried * pair.normal_mass))
                               : 0,
                 pair);
  }
  last_dt_ = dt;
  passes_ = 0;
  SpreadImpulses(pairs_, scratch, pool, impulses);
}

}  // namespace mane::contact
