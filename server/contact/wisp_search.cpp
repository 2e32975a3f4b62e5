#include "contact/wisp_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "simd/rows.h"

namespace mane::contact {
namespace {

using Contact = WispScratch::Contact;
using Eigen::Vector3f;
using Pair = WispNeighbours::Pair;
using simd::kLanes;

// By the links' reach: how far they move until those that meet are compared again,
constexpr float kPatience = 0.35f;
constexpr float kLate = 0.1f;  // what may come in before it is seen, if not within the radii,
constexpr float kFast =
    0.25f;  // what they sweep from which on it is what they come to that counts,
constexpr float kFollowed = 0.5f;  // and up to which those that meet are followed.
// Contacts a point that are kept: of a link's, the nearest. What touched in the last step counts as
// nearer by a part of its reach, lest two take turns.
constexpr double kMostContacts = 0.8;
constexpr double kMore = 8e3;  // Points besides (Budget).
constexpr float kKept = 0.1f;
constexpr float kAsNear = 1e-3f;  // Distances that differ by no more of the reach count as equal.

// What stays within the margin does not touch.
constexpr float kStill = kMargin / (1 + kMargin);

// Two links that may meet in this step.
struct Look {
  int32_t pair;   // Among WispNeighbours::pairs.
  float reach;    // Of both [m].
  float sweep;    // What a point of one may move relative to the other's in the step [m].
  bool followed;  // Whether they touched in the last step.
};

// Two links that come near each other.
struct Candidate {
  int32_t pair;     // Among WispNeighbours::pairs.
  int32_t link[2];  // Which they are,
  float distance;   // and how near segments of theirs come within the step [m].
  bool followed;    // Whether they touched in the last step, too,
  bool resumed;     // and are looked at where they did.
};

// Where a candidate comes in the order of guides and links.
struct Ordered {
  uint64_t key;
  int32_t candidate;
  bool kept;
};

// Memory of one thread; grows to what it has seen and is reused.
struct Piece {
  std::vector<int32_t> close;  // Pairs that may touch.
  std::vector<Look> looks;
  std::vector<int32_t> lost, waking;  // Pairs that have to be looked at once more.
  std::vector<Candidate> candidates;
  std::vector<Contact> at;  // Where each of them touches.
  WalkScratch walk;
  std::vector<Ordered> order;     // All of them,
  std::vector<int32_t> kept;      // and those of a guide that are kept.
  std::vector<Contact> contacts;  // Of those.
};

// What the stages of the search share.
struct Search {
  const WispPoints& points;
  const WispStep& step;
  const WispScratch& scratch;
  WispNeighbours& neighbours;
  Piece& piece;

  [[nodiscard]] Pair& PairAt(int32_t k) const { return neighbours.pairs[static_cast<size_t>(k)]; }
  [[nodiscard]] const WispLink& LinkAt(int32_t l) const {
    return scratch.links[static_cast<size_t>(l)];
  }
  [[nodiscard]] const LinkMotion& MotionOf(int32_t l) const {
    return scratch.motions[static_cast<size_t>(l)];
  }
  [[nodiscard]] float Reach(const Pair& pair) const {
    return LinkAt(pair.first).reach + LinkAt(pair.second).reach;
  }
};

LinkPoints PointsOf(const Search& search, const WispLink& link) {
  const auto p = static_cast<size_t>(link.point);
  return {search.neighbours.place[p].data(), search.scratch.sweep[p].data(), link.count, link.half};
}

// Lists two links whose segments at these points come near.
void Add(const Search& search, const Look& look, const int32_t point[2], float distance,
         bool resumed) {
  const Pair& pair = search.PairAt(look.pair);
  const int32_t guide[2] = {search.LinkAt(pair.first).guide, search.LinkAt(pair.second).guide};
  search.piece.candidates.push_back(
      {look.pair, {pair.first, pair.second}, distance, look.followed, resumed});
  search.piece.at.push_back({{guide[0], guide[1]}, {point[0], point[1]}, {point[0], point[1]}});
}

// What two links may do in the step.
Look LookAt(const Search& search, int32_t k) {
  const Pair& pair = search.PairAt(k);
  const LinkMotion &a = search.MotionOf(pair.first), &b = search.MotionOf(pair.second);
  return {k, a.reach + b.reach, Apart(a.sweep, b.sweep), pair.known()};
}

// Brings the slack of pairs [begin, end) up to the step, and finds those that may touch in it, and
// those that do since the last. Which do is hard to guess: without branches.
std::span<const int32_t> FindClose(const Search& search, int32_t begin, int32_t end) {
  std::vector<int32_t>& close = search.piece.close;  // Never shorter than it was.
  const auto most = static_cast<size_t>(end - begin);
  if (close.size() < most) close.resize(most + most / 2);
  size_t count = 0;
  for (int32_t k = begin; k < end; ++k) {
    Pair& pair = search.PairAt(k);
    const LinkMotion &a = search.MotionOf(pair.first), &b = search.MotionOf(pair.second);
    pair.slack -= Apart(a.moved, b.moved);
    const float reach = a.reach + b.reach;
    const float enough = std::max(-kLate * reach, Apart(a.sweep, b.sweep) - kStill * reach);
    close[count] = k;
    count += static_cast<size_t>(!(pair.slack > enough)) | static_cast<size_t>(pair.known());
  }
  return std::span(close).first(count);
}

// Lists two links that may touch: to be looked at, or as a candidate where they touch since the
// last step and hardly move.
void Visit(const Search& search, int32_t k) {
  const Pair& pair = search.PairAt(k);
  const WispLink &a = search.LinkAt(pair.first), &b = search.LinkAt(pair.second);
  if (!(a.reach > 0) || !(b.reach > 0)) return;
  const Look look = LookAt(search, k);
  if (look.followed && pair.slack > 0 && look.sweep < kFollowed * look.reach) {
    const int32_t point[2] = {a.point + pair.segment[0], b.point + pair.segment[1]};
    Add(search, look, point, kUnknown, true);
  } else {
    search.piece.looks.push_back(look);
  }
}

// Whether two links may touch within the step, where the lines between their ends are `apart` and
// come nearer by `nearing`; if so, adds the segments that come closest.
bool Meet(const Search& search, const Look& look, float apart, float nearing) {
  Pair& pair = search.PairAt(look.pair);
  const WispLink &a = search.LinkAt(pair.first), &b = search.LinkAt(pair.second);
  const float sweep = std::max(0.0f, nearing + a.ripple + b.ripple - kStill * look.reach);
  pair.segment[0] = WispNeighbours::kNone;
  pair.slack = apart - a.bulge - b.bulge - look.reach;
  if (pair.slack > sweep) return false;
  const LinkPoints mine = PointsOf(search, a), other = PointsOf(search, b);
  const bool fast = look.sweep >= kFast * look.reach;
  const WispKernels& kernels = *search.step.kernels;
  const NearestSegments nearest =
      fast ? kernels.closest_within(mine, other) : kernels.closest(mine, other);
  if (!fast) pair.slack = nearest.distance - look.reach;
  if (fast ? nearest.distance > look.reach + a.half + b.half : pair.slack > sweep) return false;
  // Of those that sweep far, many come near in turn: what they come to is told by their middles.
  const int32_t point[2] = {a.point + nearest.segment[0], b.point + nearest.segment[1]};
  Add(search, look, point, fast ? nearest.distance : kUnknown, false);
  return true;
}

// Looks at those that are listed.
void LookAtAll(const Search& search) {
  SegmentPairRows lines{};
  std::array<simd::Row<float>, kLineRows> between;
  const std::span<const Look> looks = search.piece.looks;
  for (size_t first = 0; first < looks.size(); first += kLanes) {
    const auto some = looks.subspan(first, std::min<size_t>(kLanes, looks.size() - first));
    for (size_t lane = 0; lane < some.size(); ++lane) {
      const Pair& pair = search.PairAt(some[lane].pair);
      size_t row = 0;
      for (const int32_t l : {pair.first, pair.second}) {
        const WispLink& link = search.LinkAt(l);
        for (const int32_t p : {link.point, link.point + link.count}) {
          const auto at = static_cast<size_t>(p);
          Put(search.neighbours.place[at], kEnds + row, lane, lines);
          Put(search.scratch.sweep[at], kMotion + row, lane, lines);
          row += 3;
        }
      }
    }
    search.step.kernels->lines(lines[0].lane, between[0].lane);
    for (size_t lane = 0; lane < some.size(); ++lane) {
      const Look& look = some[lane];
      if (!Meet(search, look, between[kLinesApart].lane[lane], between[kLinesNearing].lane[lane]) &&
          look.followed) {
        search.piece.waking.push_back(look.pair);
      }
    }
  }
  search.piece.looks.clear();
}

// Finds where the candidates from `first` on touch, and drops those that are not within their
// margin.
void Touch(const Search& search, size_t first) {
  Piece& piece = search.piece;
  FindApproaches(search.points, search.step, search.scratch, std::span(piece.at).subspan(first));
  for (size_t i = first; i < piece.candidates.size(); ++i) {
    Candidate& candidate = piece.candidates[i];
    if (candidate.distance == kUnknown) candidate.distance = piece.at[i].distance;
  }
  Walk(search.points, search.step, search.scratch, std::span(piece.at).subspan(first), piece.walk);
  size_t kept = first;
  for (size_t i = first; i < piece.candidates.size(); ++i) {
    const Candidate& candidate = piece.candidates[i];
    const Contact& contact = piece.at[i];
    if (contact.distance <= (1 + kMargin) * SumOfRadii(search.points, contact.guide) &&
        !std::isnan(candidate.distance)) {  // As of what overflows; they are sorted by it.
      piece.candidates[kept] = candidate;
      piece.at[kept++] = contact;
      continue;
    }
    Pair& pair = search.PairAt(candidate.pair);
    pair.segment[0] = WispNeighbours::kNone;
    pair.slack = 0;
    if (candidate.resumed) {
      piece.lost.push_back(candidate.pair);
    } else if (candidate.followed) {
      piece.waking.push_back(candidate.pair);
    }
  }
  piece.candidates.resize(kept);
  piece.at.resize(kept);
}

// Where a pair is none any more, those of the same guides that waited for it are looked at again.
void WakeOthers(const Search& search, int32_t left) {
  const auto is = [&](int32_t k) {
    return std::ranges::any_of(search.piece.candidates,
                               [&](const Candidate& candidate) { return candidate.pair == k; });
  };
  const auto guide = [&](int32_t k) { return search.LinkAt(search.PairAt(k).second).guide; };
  const auto g = static_cast<size_t>(search.LinkAt(search.PairAt(left).first).guide);
  for (int32_t k = search.neighbours.first_of[g]; k < search.neighbours.first_of[g + 1]; ++k) {
    Pair& pair = search.PairAt(k);
    if (k == left || guide(k) != guide(left) || pair.slack == kUnknown || is(k)) continue;
    if (!(search.LinkAt(pair.first).reach > 0) || !(search.LinkAt(pair.second).reach > 0)) continue;
    pair.slack = kUnknown;
    search.piece.looks.push_back(LookAt(search, k));
  }
}

// Candidates of guides [begin, end) with later ones.
void FindCandidates(const Search& search, int32_t begin, int32_t end) {
  Piece& piece = search.piece;
  piece.candidates.clear(), piece.at.clear();
  piece.looks.clear(), piece.lost.clear(), piece.waking.clear();
  const auto& first_of = search.neighbours.first_of;
  for (const int32_t k : FindClose(search, first_of[static_cast<size_t>(begin)],
                                   first_of[static_cast<size_t>(end)])) {
    Visit(search, k);
  }
  KeepRoom(piece.looks);
  LookAtAll(search);
  Touch(search, 0);
  // Others of their segments may be nearer than what was followed.
  size_t known = piece.candidates.size();
  for (const int32_t k : piece.lost) {
    piece.looks.push_back(LookAt(search, k));
    piece.looks.back().followed = true;
  }
  LookAtAll(search);
  Touch(search, known);
  known = piece.candidates.size();
  for (size_t i = 0; i < piece.waking.size(); ++i) WakeOthers(search, piece.waking[i]);
  KeepRoom(piece.looks), KeepRoom(piece.waking);
  piece.waking.clear();
  LookAtAll(search);
  Touch(search, known);
  KeepRoom(piece.candidates), KeepRoom(piece.at), KeepRoom(piece.lost);
}

// What is not the nearest need not be looked at until it has moved by some part of its reach.
void Wait(const Search& search, int32_t candidate) {
  Pair& pair = search.PairAt(search.piece.candidates[static_cast<size_t>(candidate)].pair);
  pair.segment[0] = WispNeighbours::kNone;
  pair.slack = std::max(pair.slack, kPatience * search.Reach(pair));
}

// What is, is followed until then.
void Follow(const Search& search, int32_t i) {
  const Candidate& candidate = search.piece.candidates[static_cast<size_t>(i)];
  const Contact& contact = search.piece.at[static_cast<size_t>(i)];
  Pair& pair = search.PairAt(candidate.pair);
  if (!pair.known()) Wait(search, i);
  for (int k = 0; k < 2; ++k) {
    const int32_t first = search.LinkAt(candidate.link[k]).point;
    pair.segment[k] = static_cast<int8_t>(contact.origin[k] - first);
  }
}

// Orders the candidates by guides, then links.
void Order(const Search& search, int32_t begin) {
  Piece& piece = search.piece;
  piece.order.clear();
  for (size_t i = 0; i < piece.candidates.size(); ++i) {
    const Candidate& candidate = piece.candidates[i];
    const auto& guide = piece.at[i].guide;
    uint64_t key = static_cast<uint64_t>(guide[0] - begin) << 24 | static_cast<uint32_t>(guide[1]);
    for (int k = 0; k < 2; ++k) {
      const int32_t first_link = search.neighbours.first_link[static_cast<size_t>(guide[k])];
      key = key << 16 | static_cast<uint32_t>(candidate.link[k] - first_link);
    }
    piece.order.push_back({key, static_cast<int32_t>(i), false});
  }
  KeepRoom(piece.order);
  std::ranges::sort(piece.order, {}, &Ordered::key);
}

// Of a stretch of candidates of the same two guides keeps those that are nearer than all beside
// them: those of the same link of one guide, and of the same or the next link of the other. Of
// equally near ones, as of hair that lies alongside, the first is kept, and not what is beside it.
void KeepNearer(const Search& search, std::span<Ordered> order) {
  Piece& piece = search.piece;
  const auto candidate = [&](const Ordered& at) -> const Candidate& {
    return piece.candidates[static_cast<size_t>(at.candidate)];
  };
  std::ranges::sort(order, {},
                    [&](const Ordered& at) { return std::pair(candidate(at).distance, at.key); });
  const auto beside = [](const Candidate& a, const Candidate& b) {
    return std::abs(a.link[0] - b.link[0]) + std::abs(a.link[1] - b.link[1]) <= 1;
  };
  for (auto at = order.begin(); at != order.end(); ++at) {
    const Candidate& mine = candidate(*at);
    const float nearer = mine.distance - kAsNear * search.Reach(search.PairAt(mine.pair));
    at->kept = std::none_of(order.begin(), at, [&](const Ordered& other) {
      return beside(mine, candidate(other)) && (other.kept || candidate(other).distance < nearer);
    });
    if (at->kept) {
      piece.kept.push_back(at->candidate);
    } else {
      Wait(search, at->candidate);
    }
  }
}

// How far off a contact is for its link, by the reach.
float Rank(const Search& search, int32_t candidate) {
  const Contact& contact = search.piece.at[static_cast<size_t>(candidate)];
  // What passes through all counts by where it begins.
  const float apart = contact.distance + contact.start.norm();
  const bool followed = search.piece.candidates[static_cast<size_t>(candidate)].followed;
  return apart / SumOfRadii(search.points, contact.guide) - (followed ? kKept : 0);
}

// Of each first link's candidates among a guide's that are kept, keeps the `most` nearest.
void KeepNearest(const Search& search, size_t most) {
  Piece& piece = search.piece;
  const auto link = [&](int32_t i) { return piece.candidates[static_cast<size_t>(i)].link[0]; };
  const auto contact = [&](int32_t i) -> const Contact& {
    return piece.at[static_cast<size_t>(i)];
  };
  std::ranges::sort(piece.kept, {}, [&](int32_t i) {
    return std::tuple(link(i), Rank(search, i), contact(i).guide[1], contact(i).point[1]);
  });
  size_t kept = 0, of_link = 0;
  for (size_t k = 0; k < piece.kept.size(); ++k) {
    of_link = kept > 0 && link(piece.kept[kept - 1]) == link(piece.kept[k]) ? of_link + 1 : 0;
    if (of_link < most) {
      piece.kept[kept++] = piece.kept[k];
    } else {
      Wait(search, piece.kept[k]);
    }
  }
  piece.kept.resize(kept);
}

// Sorts contacts of one guide, from `begin` on, and drops what has walked to where another is.
void DropSame(size_t begin, std::vector<Contact>& contacts) {
  constexpr float kSame = 0.5f;  // Segments along the guides.
  const auto key = [](const Contact& contact) {
    return std::tie(contact.guide[1], contact.point[0], contact.point[1]);
  };
  const auto place = [](const Contact& contact, int k) {
    return static_cast<float>(contact.point[k]) + contact.fraction[k];
  };
  const auto same = [&](const Contact& a, const Contact& b) {
    return a.guide[1] == b.guide[1] && std::abs(place(a, 0) - place(b, 0)) <= kSame &&
           std::abs(place(a, 1) - place(b, 1)) <= kSame;
  };
  const auto first = contacts.begin() + static_cast<ptrdiff_t>(begin);
  std::sort(first, contacts.end(),
            [&](const Contact& a, const Contact& b) { return key(a) < key(b); });
  auto kept = first;
  for (auto next = first; next != contacts.end(); ++next) {
    bool is_new = true;
    for (auto k = kept; is_new && k != first && std::prev(k)->guide[1] == next->guide[1]; --k) {
      is_new = !same(*std::prev(k), *next);
    }
    if (is_new) *kept++ = *next;
  }
  contacts.erase(kept, contacts.end());
}

}  // namespace

std::span<const Contact> FindContacts(const WispPoints& points, const WispStep& step,
                                      const WispScratch& scratch, int begin, int end,
                                      WispNeighbours& neighbours) {
  thread_local Piece own;
  Piece& piece = own;
  const Search search{points, step, scratch, neighbours, piece};
  FindCandidates(search, begin, end);
  Order(search, begin);
  piece.contacts.clear();
  const auto links = static_cast<double>(neighbours.around.size());
  const auto most = static_cast<size_t>(Budget(kMostContacts, kMore, points) / links) + 1;
  const std::span<Ordered> order = piece.order;
  for (size_t at = 0; at < order.size();) {
    const uint64_t guide = order[at].key >> 56;
    piece.kept.clear();
    while (at < order.size() && order[at].key >> 56 == guide) {
      const uint64_t guides = order[at].key >> 32;
      const size_t first = at;
      while (at < order.size() && order[at].key >> 32 == guides) ++at;
      KeepNearer(search, order.subspan(first, at - first));
    }
    KeepRoom(piece.kept);
    if (piece.kept.size() > most) KeepNearest(search, most);
    const size_t of_guide = piece.contacts.size();
    for (const int32_t i : piece.kept) {
      Follow(search, i);
      piece.contacts.push_back(piece.at[static_cast<size_t>(i)]);
    }
    DropSame(of_guide, piece.contacts);
  }
  KeepRoom(piece.contacts);
  return piece.contacts;
}

}  // namespace mane::contact
