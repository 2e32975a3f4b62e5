#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <vector>

#include "styling/constraint.h"

namespace mane::styling {

/// How a constraint went: met + missed = selected at the end.
struct ConstraintReport {
  int selected = 0;  ///< Wisps.
  int met = 0;
  int missed = 0;  ///< Their length ended first.
};

/// What every wisp is constrained by while wisps grow ([CK05] 4).
///
/// A wisp works on the constraints of its queue one after the other. Who has met a point or
/// trajectory waits, without growing, until none of the selection is still on its way there or to
/// such a constraint before it; a direction, or a weight of 0, makes nobody wait. A wisp that ends
/// has missed what it has not met, and blocks nobody, so that somebody always grows.
///
/// Met are: a point, when a segment comes within its radius; a trajectory, when a joint that has
/// followed it has no more than max(radius, segment) to its end, or a segment comes within the
/// radius of its end; a direction, when a wisp that was within its influence leaves it, or goes
/// past the path's end.
///
/// Threads: Grown and PullOf of different wisps may run at once, nothing else.
class Styler {
 public:
  /// What pulls at a wisp: weight and Psi, and whether hair makes room for it.
  struct Pull {
    double w = 0;                                   ///< Of (7); 0 for none.
    Eigen::Vector3d psi = Eigen::Vector3d::Zero();  ///< Unit.
    bool pressed = false;                           ///< Hair is compressed (D9).
  };

  /// @param queues    valid; must outlive this.
  /// @param selected  wisps of each queue, a wisp in one at most.
  Styler(const std::vector<ConstraintQueue>& queues,
         const std::vector<std::vector<uint32_t>>& selected, int wisps, double segment_length);

  /// The wisp's first joint is there; before anything else about it.
  void Begin(uint32_t wisp, const Eigen::Vector3d& root);

  [[nodiscard]] bool Waits(uint32_t wisp) const { return state_[wisp].met; }
  /// What pulls at its newest joint, `x`.
  [[nodiscard]] Pull PullOf(uint32_t wisp, const Eigen::Vector3d& x) const;
  /// It has grown a segment.
  void Grown(uint32_t wisp, const Eigen::Vector3d& from, const Eigen::Vector3d& to);
  /// It grows no more. After Grown.
  void Ended(uint32_t wisp) { state_[wisp].ended = true; }
  /// Every wisp that does not wait has grown: counts, and lets those go on that need not wait.
  ///
  /// @param joint  newest joint of a wisp [m], called with its number.
  template <typename Joint>
  void EndRound(const Joint& joint) {
    for (size_t q = 0; q < queues_.size(); ++q) {
      while (Release(q)) {
        for (const uint32_t wisp : selected_[q]) {
          if (state_[wisp].starts) Start(wisp, joint(wisp));
        }
      }
    }
  }

  /// Per queue and constraint; complete once all wisps have ended.
  [[nodiscard]] std::vector<std::vector<ConstraintReport>> Report() const;

 private:
  struct State {
    int32_t queue = -1;
    int32_t phase = 0;    // Which of the queue's constraints; their number after the last.
    bool met = false;     // The current one.
    bool inside = false;  // Has been within the current one's radius.
    bool starts = false;  // The current one, in this round.
    bool ended = false;
    PathPlace place;  // Nearest to the newest joint.
  };

  [[nodiscard]] const Constraint& Of(const State& state) const {
    return queues_[static_cast<size_t>(state.queue)].constraints[static_cast<size_t>(state.phase)];
  }
  [[nodiscard]] bool Working(const State& state) const;
  void Start(uint32_t wisp, const Eigen::Vector3d& joint);
  void FindPlace(State* state, const Eigen::Vector3d& x) const;
  [[nodiscard]] bool Meets(const State& state, const Eigen::Vector3d& from,
                           const Eigen::Vector3d& to) const;
  bool Release(size_t queue);

  const std::vector<ConstraintQueue>& queues_;
  const std::vector<std::vector<uint32_t>>& selected_;
  std::vector<std::vector<Path>> paths_;  // Of each queue's constraints.
  std::vector<State> state_;              // Of wisps.
  double segment_length_;
};

}  // namespace mane::styling
