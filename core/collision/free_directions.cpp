#include "core/collision/free_directions.hpp"

#include "core/math/option_check.hpp"

namespace palpate::collision {

std::vector<FreeDirection> free_directions(const std::vector<Obstacle>& obstacles) {
  std::vector<FreeDirection> directions;
  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    for (int axis = 0; axis < 6; ++axis) {
      const double deviation = obstacles[o].pose_deviation[axis];
      if (deviation > 0) directions.push_back({static_cast<int>(o), axis, deviation});
    }
  }
  math::check_option(directions.size() <= kMostFreeDirections, "free directions of the obstacles",
                     directions.size(), "at most " + std::to_string(kMostFreeDirections));
  return directions;
}

void displace(const std::vector<FreeDirection>& directions, const FreeMotion& motion,
              std::vector<Placement>& placements) noexcept {
  for (std::size_t k = 0; k < directions.size();) {
    const int obstacle = directions[k].obstacle;
    math::Vector6d change = math::Vector6d::Zero();
    for (; k < directions.size() && directions[k].obstacle == obstacle; ++k)
      change[directions[k].axis] = motion[k];
    math::Pose& X_OB = placements[static_cast<std::size_t>(obstacle)].X_OB;
    X_OB = X_OB * math::make_pose(math::exp_rotation(change.tail<3>()), change.head<3>());
  }
}

}  // namespace palpate::collision
