#pragma once

#include <array>
#include <optional>

#include "core/estimation/estimator.hpp"
#include "core/math/update_result.hpp"
#include "rt/pipeline/closed_grasp.hpp"

namespace palpate::pipeline {

/// Hands that open and close on the object again. What a closed hand holds is not known before its
/// grasp has been found, outside the loop; until then it counts as open. Hands without jaws hold
/// the grasp of the configuration. Nothing allocates.
class JawWatch {
 public:
  /// Watches the hands of which the object has jaws.
  explicit JawWatch(const registry::Object& object);

  /// Once per tick, before the estimator: hides the holds that are not known yet. Degraded while
  /// there are any.
  UpdateResult update(estimation::EstimationInputs& inputs) noexcept;

  /// The grasp to be found next, until begin() of its hand.
  std::optional<ClosedGrasp> wanted() const noexcept;
  void begin(int hand) noexcept { hands_[hand].state = State::kBeingFound; }
  /// `found`: the model has it; otherwise the hand holds nothing known until it has opened.
  void end(int hand, bool found) noexcept;

 private:
  enum class State { kKnown, kOpen, kClosed, kBeingFound, kNotFound };
  struct Hand {
    bool has_jaws = false;
    State state = State::kKnown;
    math::Pose X_OG = math::Pose::Identity();
  };
  std::array<Hand, 2> hands_;
};

}  // namespace palpate::pipeline
