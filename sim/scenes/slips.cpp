#include "sim/scenes/slips.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/constants.hpp"

namespace palpate::scenes {

using math::kPi;

double Slip::share(double time) const {
  return 0.5 * (1 - std::cos(kPi * std::clamp((time - at) / duration, 0.0, 1.0)));
}

double Slip::rate(double time) const {
  return 0.5 * kPi / duration * std::sin(kPi * std::clamp((time - at) / duration, 0.0, 1.0));
}

std::vector<Slip> read_slips(const config::Node& scene, int hands) {
  std::vector<Slip> slips;
  for (const config::Node& item :
       scene.list({"slips", "", "scripted slips of a hand, which nothing measures"})) {
    if (hands == 0) scene.fail("slips", "need a hand that holds the object: object.grasp_box");
    Slip slip;
    slip.at = item.number({"at", "s", "simulated time"}, {0, 1e5});
    slip.duration = item.number({"duration", "s", "of the slip"}, {0.01, 1e5});
    slip.hand = item.integer({"hand", "", "0, or 1 of a second arm"}, {0, hands - 1.0}, 0);
    slip.translation =
        item.vector3({"translation", "m", "of the hand along the object, in its G"}, {-0.5, 0.5});
    slips.push_back(slip);
  }
  return slips;
}

void Slips::apply(double time, object::Plant& plant) const noexcept {
  if (slips_.empty()) return;
  for (int hand = 0; hand < plant.grasp_count(); ++hand) {
    Eigen::Vector3d displacement = Eigen::Vector3d::Zero(), rate = Eigen::Vector3d::Zero();
    for (const Slip& slip : slips_) {
      if (slip.hand != hand) continue;
      displacement += slip.share(time) * slip.translation;
      rate += slip.rate(time) * slip.translation;
    }
    plant.slide_hand(hand, displacement, rate);
  }
}

}  // namespace palpate::scenes
