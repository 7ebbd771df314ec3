#include "tools/export/obstacle_painter.hpp"

#include <cmath>
#include <string>

#include "rt/bus/text.hpp"
#include "sim/draw/solids.hpp"

namespace palpate::exporting {

namespace {

constexpr const draw::Colour& kObstacle = ObstaclePainter::kColour;

constexpr double kInfiniteLength = 10;  // m, of an infinite cylinder
constexpr double kPlateSide = 2.2;      // of a half-space, relative to the object's diagonal

/// About z; `length`: of the segment.
draw::TriangleMesh make_capsule(double radius, double length) {
  constexpr int kRings = 12, kSegments = 48;  // rings of each end
  Eigen::Matrix2Xd profile(2, 2 * (kRings + 1));
  for (int i = 0; i <= kRings; ++i) {
    // The first circle lies so close to the pole that the closing disc is not visible.
    const double latitude = std::fmin(M_PI_2 * (kRings - i) / kRings, M_PI_2 - 1e-3);
    const double r = radius * std::cos(latitude), z = 0.5 * length + radius * std::sin(latitude);
    profile.col(i) << r, -z;
    profile.col(2 * kRings + 1 - i) << r, z;
  }
  return draw::make_revolution(profile, kSegments);
}

void draw_surface(const math::Pose& X_WB, const Eigen::Matrix3Xd& points,
                  const Eigen::Matrix3Xi& triangles, draw::Renderer& renderer) {
  draw::MeshStyle style;
  style.colour = kObstacle;
  renderer.draw_mesh(log::transformed(X_WB, points), triangles, style);
}

/// The part of the plane that is nearest to the object.
void draw_plate(math::Pose X_WB, const Eigen::AlignedBox3d& object_W, draw::Renderer& renderer) {
  const Eigen::Vector3d normal = X_WB.linear().col(2);
  const double size = object_W.diagonal().norm(), side = kPlateSide * size;
  const double height = normal.dot(object_W.center() - X_WB.translation());
  X_WB.translation() = object_W.center() - height * normal;
  const Eigen::Vector3d foot = X_WB * Eigen::Vector3d(0.25 * side, 0.25 * side, 0);
  renderer.draw_arrow(foot, foot + 0.2 * size * normal, 0.005 * size, kObstacle);
  const double thickness = 1e-3 * side;
  X_WB.translation() -= 0.5 * thickness * normal;
  renderer.draw_box(X_WB, {side, side, thickness}, kObstacle);
}

void draw_obstacle(const drawing::ObstacleDrawing& obstacle, const math::Pose& X_WB,
                   const Eigen::AlignedBox3d& object_W, draw::Renderer& renderer) {
  const Eigen::Vector3d& size = obstacle.size;
  if (obstacle.kind == "half_space") {
    draw_plate(X_WB, object_W, renderer);
  } else if (obstacle.kind == "box") {
    renderer.draw_box(X_WB, size, kObstacle);
  } else if (obstacle.kind == "sphere") {
    renderer.draw_sphere(X_WB, size.x(), kObstacle);
  } else if (obstacle.kind == "cylinder") {
    renderer.draw_cylinder(X_WB, size.x(), size.y() > 0 ? size.y() : kInfiniteLength, kObstacle);
  } else if (obstacle.kind == "capsule") {
    const draw::TriangleMesh capsule = make_capsule(size.x(), size.y());
    draw_surface(X_WB, capsule.points, capsule.triangles, renderer);
  } else {
    draw_surface(X_WB, obstacle.surface.points, obstacle.surface.triangles, renderer);
  }
}

drawing::PlacingMessages messages_on(const std::string& obstacle, const Instant& instant) {
  drawing::PlacingMessages messages;
  if (instant.obstacles) messages.published = &*instant.obstacles;
  if (instant.robot && instant.robot->joint_count <= 16) messages.robot = &*instant.robot;
  for (const world_state_t& message : instant.moved)
    if (obstacle == bus::get_text(message.name)) messages.moved = &message;
  return messages;
}

}  // namespace

void ObstaclePainter::draw(const Instant& instant, const Eigen::AlignedBox3d& object_W,
                           draw::Renderer& renderer) {
  drawn_.clear();
  for (const drawing::ObstacleDrawing& obstacle : obstacles_) {
    const auto X_WB = drawing::pose_in_world(obstacle, messages_on(obstacle.name, instant));
    if (!X_WB) continue;
    draw_obstacle(obstacle, *X_WB, object_W, renderer);
    drawn_ += (drawn_.empty() ? "" : ", ") + obstacle.name;
  }
}

}  // namespace palpate::exporting
