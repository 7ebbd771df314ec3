#include "rt/pipeline/jaw_watch.hpp"

namespace palpate::pipeline {

JawWatch::JawWatch(const registry::Object& object) {
  for (std::size_t i = 0; i < hands_.size(); ++i) hands_[i].has_jaws = object.jaws[i].has_value();
}

UpdateResult JawWatch::update(estimation::EstimationInputs& inputs) noexcept {
  UpdateResult result;
  for (int i = 0; i < inputs.grasp_count; ++i) {
    Hand& hand = hands_[i];
    estimation::GraspInput& input = inputs.grasps[i];
    if (!hand.has_jaws || input.pose_freshness == Freshness::kNoData) continue;
    if (!input.holding) {
      hand.state = State::kOpen;
      continue;
    }
    if (hand.state == State::kKnown) continue;
    if (hand.state == State::kOpen) {
      hand.state = State::kClosed;
      hand.X_OG = input.X_OG;
    }
    input.holding = false;
    result = {Status::kDegraded, hand.state == State::kNotFound
                                     ? "the closed hand holds no known part of the object"
                                     : "what the closed hand holds is being determined"};
  }
  return result;
}

std::optional<ClosedGrasp> JawWatch::wanted() const noexcept {
  for (std::size_t i = 0; i < hands_.size(); ++i)
    if (hands_[i].state == State::kClosed) return ClosedGrasp{static_cast<int>(i), hands_[i].X_OG};
  return {};
}

void JawWatch::end(int hand, bool found) noexcept {
  State& state = hands_[hand].state;
  // It may have opened since.
  if (state == State::kBeingFound) state = found ? State::kKnown : State::kNotFound;
}

}  // namespace palpate::pipeline
