#include "styling/stylist.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "base/clock.h"
#include "groom/range.h"
#include "styling/colour.h"
#include "styling/equal.h"
#include "styling/force_field.h"
#include "styling/map.h"
#include "styling/masters.h"
#include "styling/members.h"
#include "styling/region.h"
#include "styling/roots.h"
#include "styling/selection.h"

namespace mane::styling {
namespace {

// Streams of a style's seed that stages draw from; strands and wisps count on from them.
enum SeedOf : uint64_t { kRootSeed = 1, kMasterSeed, kMemberSeed, kColourSeed };

uint64_t StageSeed(uint64_t seed, SeedOf stage) { return seed * 8 + stage; }

// What a stage was made of, the stages that it builds on among them by their version.
using RootsKey = std::tuple<uint64_t, ScalpMap, ScalpMap, std::vector<Cut>, int, int>;
using MastersKey =
    std::tuple<int, uint64_t, double, Synthesis, std::vector<Style::RegionalSynthesis>,
               Distribution, std::vector<double>>;
using DeformationKey = std::tuple<int, ScalpMap, std::vector<FieldTerm>, std::vector<double>,
                                  std::vector<ConstraintQueue>, std::vector<double>>;
using MembersKey = std::tuple<int, uint64_t, Distribution, std::vector<double>, double>;
using ColoursKey = std::tuple<int, uint64_t, Colouring>;

// A stage's outcome with what it was made of. Who needs it anew gets a higher version.
template <typename Key>
struct Stage {
  std::optional<Key> key;
  int version = 0;

  // Whether it must be made; then it counts as made of `wanted`, unless Fail follows.
  bool Renew(Key wanted) {
    if (key && *key == wanted) return false;
    key = std::move(wanted);
    ++version;
    return true;
  }
  void Fail() { key.reset(); }
};

// Measures a stage.
class Watch {
 public:
  explicit Watch(double* seconds) : seconds_(seconds), begin_(base::SteadySeconds()) {}
  ~Watch() { *seconds_ = base::SteadySeconds() - begin_; }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

 private:
  double* seconds_;
  const double begin_;
};

}  // namespace

struct Stylist::Kept {
  std::shared_ptr<Hairstyle> style = std::make_shared<Hairstyle>();
  Masters undeformed;
  Stage<RootsKey> roots;
  Stage<MastersKey> masters;
  Stage<DeformationKey> deformation;
  Stage<MembersKey> members;
  Stage<ColoursKey> colours;
};
