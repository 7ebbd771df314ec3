#include "tools/view/obstacles.hpp"

#include <algorithm>
#include <array>

#include "core/math/constants.hpp"
#include "rt/bus/text.hpp"
#include "tools/view/encode.hpp"

namespace palpate::view {
namespace {

using nlohmann::json;
using CarrierKind = registry::ObstacleCarrier::Kind;

const char* name_of(CarrierKind kind) {
  switch (kind) {
    case CarrierKind::kLink:
      return "link";
    case CarrierKind::kMessages:
      return "messages";
    case CarrierKind::kFixed:
      break;
  }
  return "fixed";
}

std::vector<ObstacleCorrection> corrections_in(const obstacles_t& published,
                                               const std::string& name) {
  std::vector<ObstacleCorrection> corrections;
  for (int i = 0; i < std::min(published.count, static_cast<int>(obstacles_t::MOST)); ++i) {
    if (name != bus::get_text(published.name[i])) continue;
    for (int axis = 0; axis < 6; ++axis) {
      if (published.deviation[i][axis] > 0)
        corrections.push_back(
            {axis, published.displacement[i][axis], published.deviation[i][axis]});
    }
  }
  return corrections;
}

json describe(const std::vector<ObstacleCorrection>& corrections) {
  constexpr double kMillimetres = 1e3;
  constexpr std::array<const char*, 6> kAxes{"along x", "along y", "along z",
                                             "about x", "about y", "about z"};
  json list = json::array();
  for (const ObstacleCorrection& correction : corrections) {
    const double scale = correction.axis < 3 ? kMillimetres : 1 / math::kDegree;
    list.push_back({{"axis", kAxes.at(static_cast<std::size_t>(correction.axis))},
                    {"unit", correction.axis < 3 ? "mm" : "°"},
                    {"displacement", scale * correction.displacement},
                    {"deviation", scale * correction.deviation}});
  }
  return list;
}

}  // namespace

ObstaclePlace place_of(const drawing::ObstacleDrawing& obstacle, const Scene& scene) {
  constexpr std::int64_t kLate = 500'000;  // us
  const Latest<robot_state_t>& robot = scene.robot[0];
  const MovedObstacle* moved = scene.moved(obstacle.name);
  drawing::PlacingMessages messages{scene.obstacles.get(), robot.get(), nullptr};
  if (moved) messages.moved = &moved->message;
  const CarrierKind kind = obstacle.carrier.kind;
  ObstaclePlace place;
  if (kind == CarrierKind::kLink && messages.robot) place.time_us = robot.time_us;
  if (kind == CarrierKind::kMessages && moved) place.time_us = moved->time_us;
  // Of a daemon that has ended.
  if (place.time_us && *place.time_us - scene.obstacles.time_us > kLate)
    messages.published = nullptr;
  place.X_WB = drawing::pose_in_world(obstacle, messages);
  if (messages.published) place.corrections = corrections_in(*messages.published, obstacle.name);
  return place;
}

std::string encode_obstacle(int index, const drawing::ObstacleDrawing& obstacle) {
  const Eigen::Vector3d& size = obstacle.size;
  serve::Parcel parcel({{"type", "obstacle"},
                        {"index", index},
                        {"name", obstacle.name},
                        {"kind", obstacle.kind},
                        {"size", {size.x(), size.y(), size.z()}},
                        {"carrier", name_of(obstacle.carrier.kind)},
                        {"timeout_ms", 1e3 * obstacle.carrier.timeout}});
  std::vector<float> points;
  std::vector<std::int32_t> triangles;
  for (const double x : obstacle.surface.points.reshaped()) points.push_back(static_cast<float>(x));
  for (const int i : obstacle.surface.triangles.reshaped()) triangles.push_back(i);
  if (!triangles.empty()) {
    parcel.add("points", points);
    parcel.add("triangles", triangles);
  }
  return parcel.finish();
}

json describe_places(const std::vector<drawing::ObstacleDrawing>& obstacles, const math::Pose& X_WO,
                     const Scene& scene, std::int64_t shown_us, std::vector<float>& poses) {
  json list = json::array();
  for (const drawing::ObstacleDrawing& obstacle : obstacles) {
    const ObstaclePlace place = place_of(obstacle, scene);
    Eigen::Matrix<float, 7, 1> pose = Eigen::Matrix<float, 7, 1>::Zero();
    if (place.X_WB) {
      const math::Pose X_OB = X_WO.inverse() * *place.X_WB;
      pose.head<3>() = X_OB.translation().cast<float>();
      pose.tail<4>() = Eigen::Quaterniond(X_OB.linear()).coeffs().cast<float>();
    }
    poses.insert(poses.end(), pose.begin(), pose.end());
    json age;  // null
    if (place.time_us) age = std::max<std::int64_t>(shown_us - *place.time_us, 0) / 1000;
    list.push_back({{"placed", place.X_WB.has_value()},
                    {"age_ms", age},
                    {"corrections", describe(place.corrections)}});
  }
  return list;
}

}  // namespace palpate::view
