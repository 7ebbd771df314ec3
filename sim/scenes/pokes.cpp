#include "sim/scenes/pokes.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/constants.hpp"

namespace palpate::scenes {
namespace {

using math::kPi;

Eigen::Vector3d read_force(const config::Node& poke, const Eigen::Vector3d& gravity_O) {
  if (!poke.has("mass")) return poke.vector3({"force", "N", "in O; or mass"}, {-1e3, 1e3});
  if (poke.has("force")) poke.fail("mass", "given together with force; allowed: one of them");
  return poke.number({"mass", "kg", "that hangs there"}, {0, 100}) * gravity_O;
}

}  // namespace

double Poke::share(double time) const {
  const double inside = std::min(time - at, at + duration - time);
  if (inside <= 0) return 0;
  const double ramp = std::min(kRamp, duration / 2);
  return inside < ramp ? 0.5 * (1 - std::cos(kPi * inside / ramp)) : 1;
}

std::vector<Poke> read_pokes(const config::Node& scene, const Eigen::Vector3d& size,
                             const Eigen::Vector3d& gravity_O) {
  std::vector<Poke> pokes;
  for (const config::Node& item : scene.list({"pokes", "", "forces that nothing measures"})) {
    Poke poke;
    poke.at = item.number({"at", "s", "simulated time"}, {0, 1e5});
    poke.duration = item.number({"duration", "s", "of the push, its ramps included"}, {0.01, 1e5});
    poke.point = item.vector3({"point", "m", "of the rest shape, in O"});
    poke.force = read_force(item, gravity_O);
    if ((poke.point.array() < 0).any() || (poke.point.array() > size.array()).any())
      item.fail("point", "lies outside the object");
    pokes.push_back(poke);
  }
  return pokes;
}

void Pokes::apply(double time, object::Plant& plant) noexcept {
  if (applied_) plant.clear_forces();
  applied_ = false;
  for (const Poke& poke : pokes_) {
    const double share = poke.share(time);
    if (share == 0) continue;
    plant.push(poke.point, share * poke.force);
    applied_ = true;
  }
}

}  // namespace palpate::scenes
