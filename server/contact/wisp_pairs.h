#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "contact/wisp_kernels.h"
#include "contact/wisp_links.h"
#include "exec/worker_pool.h"

namespace mane::contact {

/// How the wisps around guides act on each other (contact.md, Hair against hair). What is given for
/// straight and for curly hair is interpolated by the mean curliness of the two.
struct WispSettings {
  /// The first of a guide takes no part [m], >= 0: wisps overlap where they leave the skin.
  double root_length = 0.02;
  /// Part of the sum of radii by which one contact is compressed under the weight of the lighter
  /// guide; [1e-3, 1]. Smaller is stiffer, and takes more passes where many lie on each other.
  double compression = 0.02;
  /// In which compressed wisps expand [s], >= 0. Shorter ones let piles of hair dance.
  double expansion_time = 0.2;
  double recovery_speed = 0.1;  ///< At which wisps that overlap part at most [m/s], >= 0.
  /// In which the distance that two wisps keep turns into that of the rest shape, where it is
  /// another: that at which they lay when the first step met them, or of where they slid from [s],
  /// > 0.
  double relaxation_time = 1;
  /// Part of the sum of radii within which wisps rub on and hold each other; [0, 1].
  double touch_range = 0.2;
  double sliding_rate_straight = 2;  ///< Viscous resistance to sliding, by mass [1/s], >= 0.
  double sliding_rate_curly = 60;
  double friction_straight = 0.1;  ///< Coulomb's mu, >= 0.
  double friction_curly = 0.6;
  /// Viscous resistance to parting, by mass [1/s], where both are tightly curled; else by the
  /// product of their curliness; >= 0.
  double cohesion_rate = 100;
};

/// Two wisps where they are closest, or will be within the step.
struct WispPair {
  int32_t guide[2];         ///< guide[0] < guide[1].
  int32_t point[2];         ///< First point of the segment of each.
  float fraction[2];        ///< On the segment, in [0, 1]: where they touch.
  Eigen::Vector3f normal;   ///< Unit vector from the second to the first, on the side it came from.
  float reference;          ///< Distance that they keep [m].
  float gap;                ///< At the start of the step: distance along the normal less that [m];
  float passing_gap;        ///< what it is at the end where they nearly pass through [m].
  Eigen::Vector3f impulse;  ///< On the first; the second receives the opposite [kg m/s].

  float inverse_mass[2];  ///< Of each side's two points, by the pairs that share them [1/kg], (H6).
  float normal_mass;      ///< Of both, as heavy as their strands make them, along the normal
  float sliding_mass;     ///< and across [kg], (H11).
  float past_push[2];     ///< Of the last step and the one before, along the normal [kg m/s].

  Eigen::Vector3f held;  ///< What the last step held it with, where it stuck [kg m/s].

  float target;      ///< Relative velocity along the normal that is asked for [m/s], (H7).
  float resistance;  ///< S of (H7) [kg].
  float viscosity;   ///< kappa of (H9),
  float friction;    ///< its mu,
  float cohesion;    ///< and kappa of (H10); the last two for wisps that touch.
  float leaving;     ///< Speed at which what was pushed may leave [m/s],
  float rebound;     ///< and the most that holds it back [kg m/s], (H10).
  float nearness;    ///< 1 where the wisps touch, 0 out of range.
  float impact;      ///< Approach from which on the first pass tells the mass [m/s], (H11).
  float fastest;     ///< Largest relative speed seen in this step [m/s].
  std::array<Eigen::Vector3f, 2> velocity;       ///< Of each side in this pass,
  std::array<Eigen::Vector3f, 2> last_velocity;  ///< in the last one [m/s],
  Eigen::Vector3f last_impulse;                  ///< and the impulse that led to it [kg m/s].
};

/// How many times heavier a strand is than its points alone, where wisps push it and where they rub
/// on it (H11); 1 to 64.
struct Heaviness {
  float normal = 1, sliding = 1;
};

/// Memory of the steps of one head; grows to what it has seen and is reused.
struct WispScratch {
  /// Where two wisps touch.
  struct Contact {
    int32_t guide[2];
    int32_t point[2];
    int32_t origin[2];  ///< The segments from which a walk led to those.
    float fraction[2] = {0, 0};
    float distance = 0;  ///< The least within the step [m].
    /// From the second to the first at the start of the step [m],
    Eigen::Vector3f start = Eigen::Vector3f::Zero();
    /// and where they first touch, or come closest.
    Eigen::Vector3f approach = Eigen::Vector3f::Zero();
  };
  /// A link near the one that is searched for.
  struct Near {
    float apart;  ///< Their least distance may be [m].
    int32_t link;
  };
  /// What a step looked at; counts that do not depend on the machine.
  struct Work {
    int64_t compared = 0;    ///< Links whose boxes overlap that of one which is searched for,
    int64_t neighbours = 0;  ///< and pairs of links that are neighbours.
  };
  /// What a piece of guides finds.
  struct Piece {
    int64_t compared = 0;  ///< Work::compared of this step.
    std::vector<WispNeighbours::Pair> neighbours;
    std::vector<WispPair> pairs;
  };
  /// A pair at one of its segments.
  struct End {
    int32_t pair, side;
  };

  std::vector<int32_t> guide_of;  ///< Guide of the segment from each point; -1 where none is.
  std::vector<float> guide_mass;  ///< Of the points beyond the root [kg].
  std::vector<Eigen::Vector3f> last_place;  ///< WispNeighbours::place, of the last step,
  std::vector<Eigen::Vector3f> sweep;       ///< and what points will move in the frame [m].
  std::vector<Eigen::Vector3f> start;       ///< Points at the start of the step [m].
  std::vector<WispLink> links;
  std::vector<LinkMotion> motions;  ///< Of links.
  std::vector<SegmentBox> boxes;    ///< Of links.
  std::vector<uint8_t> moved;       ///< Whether a link's neighbours are searched anew.
  /// WispNeighbours::Around's, as a search leaves them; the first at least what it is before [m].
  std::vector<float> spare, widest;
  SegmentGrid grid;
  std::vector<WispNeighbours::Pair> found;       ///< By the search,
  std::vector<WispNeighbours::Pair> neighbours;  ///< and all before it;
  std::vector<WispNeighbours::Pair> ended;       ///< those that touched where a link changed.
  static constexpr int kGuidesAPiece = 8;
  std::vector<Piece> pieces;
  Work work;
  std::vector<WispPair> pairs;     ///< Of the last step.
  std::vector<uint8_t> followed;   ///< Which of them have gone on.
  std::vector<int32_t> first_end;  ///< By first point of a segment, and their number.
  std::vector<End> ends;
  std::vector<int32_t> first_point;  ///< By guide, and their number.
  std::vector<float> share;          ///< By how many pairs a point is pressed, (H6).
  /// A pair that would nearly pass, and by how much it would be nearer than that [m].
  struct Passing {
    float by;
    int32_t pair;
  };
  std::vector<float> passing_by;     ///< By pair; 0 where none would.
  std::vector<Passing> passing;      ///< Those that RevisePassing revises,
  std::vector<int32_t> revised;      ///< the guides of those,
  std::vector<Heaviness> heaviness;  ///< and how heavy they are for it.
};

/// Keeps track of where the wisps of a head touch, and finds the impulses between them.
///
/// A step is: Begin; then passes, each of which solves every strand with the impulses at hand; and
/// Revise between two passes. Impulses of a pair are equal and opposite, so that they keep
/// momentum. Every method's results are the same bits for any number of workers; nothing is
/// allocated once warm. Any numbers may come in: points that are not finite, and segments longer
/// than 0.25 m, take no part, and impulses are bounded (H12).
///
/// A value: a copy goes on as the original does. One thread at a time.
class WispTracker {
 public:
  explicit WispTracker(const WispSettings& settings = {},
                       const WispKernels& kernels = WispKernelsFor(simd::Best()))
      : settings_(settings), kernels_(&kernels) {}

  /// Finds the pairs of a step of `dt` [s] and with what impulses its first pass starts.
  /// Guides keep their numbers from step to step.
  ///
  /// @param impulses  set at every point.
  void Begin(const WispPoints& points, double dt, WispScratch& scratch, exec::WorkerPool& pool,
             const ImpulseSpans& impulses);

  /// Finds the impulses of the next pass from the velocities that the last one gave.
  ///
  /// @param scratch  as Begin left it.
  /// @param impulses  set at every point.
  void Revise(const VelocitySpans& velocities, WispScratch& scratch, exec::WorkerPool& pool,
              const ImpulseSpans& impulses);

  /// The same, only of the pairs that would nearly pass through each other by what the last pass
  /// gave, the worst where they are many: for passes beyond those that all strands take part in.
  /// Other impulses stay (H18).
  ///
  /// @return the guides, rising, on which impulses have changed; good until the next step.
  [[nodiscard]] std::span<const int32_t> RevisePassing(const VelocitySpans& velocities,
                                                       WispScratch& scratch, exec::WorkerPool& pool,
                                                       const ImpulseSpans& impulses);

  /// Forgets all, for a head that is put to rest.
  void Clear() {
    pairs_.clear();
    heaviness_.clear();
    neighbours_.first.clear();
    last_dt_ = 0;
  }

  /// By the first guide, the second, and the place on the first.
  [[nodiscard]] std::span<const WispPair> pairs() const { return pairs_; }
  [[nodiscard]] const WispSettings& settings() const { return settings_; }

 private:
  WispSettings settings_;
  const WispKernels* kernels_;
  WispNeighbours neighbours_;
  std::vector<WispPair> pairs_;
  std::vector<Heaviness> heaviness_;  // By guide.
  double last_dt_ = 0;                // Of the last step [s].
  int passes_ = 0;                    // Of this step.
};

}  // namespace mane::contact
