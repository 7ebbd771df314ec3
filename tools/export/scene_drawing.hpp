#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/math/rigid.hpp"
#include "sim/draw/renderer.hpp"
#include "tools/drawing/robot_drawing.hpp"
#include "tools/export/element_gradients.hpp"
#include "tools/export/obstacle_painter.hpp"
#include "tools/export/shape_follower.hpp"

namespace palpate::exporting {

struct DrawingOptions {
  Quantity quantity = Quantity::kDisplacement;
  double low = 0, high = 0;  // ends of the colour scale, SI; if equal: range of the drawn shapes
  double azimuth = -60;      // deg, azimuth of the camera, from +x about z
  double elevation = 20;     // deg above the horizon
  double zoom = 1;           // 2: everything at twice the size
  int width = 1280, height = 800;
  std::string title;          // empty: generated from the time
  std::string configuration;  // of palpated, YAML; gives the pose of the object in W, and the
                              // obstacles. Empty: drawn in O, without obstacles
  std::string urdf;           // of the arm, drawn if there is a configuration
};

/// Draws instants of a log off-screen: the shape coloured by a quantity, the truth as a wireframe
/// over it, forces as arrows, feature and target, clamp, and arm and obstacles if a configuration
/// gives their poses. All elements keep their position in the image from instant to instant.
class SceneDrawing {
 public:
  /// Throws std::runtime_error without OSMesa, config::Error for a wrong configuration.
  explicit SceneDrawing(const DrawingOptions& options);

  /// Must be called first with all instants that will be drawn: they determine the camera and, if
  /// not given, the colour scale.
  void measure(const Instant& instant);

  /// Throws std::runtime_error if none of the measured instants provides the quantity.
  void check() const;

  const draw::Image& draw(const Instant& instant);

 private:
  void draw_shape(const Instant& instant);
  void draw_truth(const Instant& instant);
  void draw_rest(const log::MeshMessage& mesh);
  void draw_edges(const Eigen::Matrix3Xd& points_W, const Eigen::Matrix2Xi& edges, double width,
                  const draw::Colour& colour);
  void draw_clamp(const log::MeshMessage& mesh);
  void draw_forces(const Instant& instant);
  void draw_arrow(const Eigen::Vector3d& at_O, const Eigen::Vector3d& force_O,
                  const draw::Colour& colour);
  void draw_target(const Instant& instant);
  void draw_floor();
  void draw_arm(const robot_state_t& state);
  void draw_ball(const Eigen::Vector3d& at_O, double radius, const draw::Colour& colour);
  draw::View view() const;
  double high() const;
  void annotate(const Instant& instant);
  Eigen::Matrix3Xd in_world(const Eigen::Matrix3Xd& points_O) const;

  DrawingOptions options_;
  draw::Renderer renderer_;
  draw::Image image_;
  math::Pose X_WO_ = math::Pose::Identity();
  std::unique_ptr<drawing::RobotDrawing> arm_;
  ObstaclePainter obstacles_;
  std::vector<float> link_poses_;  // position and quaternion x, y, z, w of each link of arm_, in W
  Eigen::AlignedBox3d bounds_W_;   // of all shapes
  Eigen::Vector3d middle_W_ = Eigen::Vector3d::Zero();  // of the shape that is drawn
  Eigen::VectorXd values_;    // of the quantity, of the instant that is drawn
  double size_ = 0;           // m, of the object
  double largest_ = 0;        // of the quantity
  double largest_force_ = 0;  // N
  bool any_value_ = false;
  bool draws_truth_ = false, draws_force_ = false, draws_target_ = false, draws_feature_ = false;
};

}  // namespace palpate::exporting
