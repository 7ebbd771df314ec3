#include "tools/export/scene_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <set>
#include <stdexcept>

#include "rt/config/node.hpp"
#include "rt/registry/frames.hpp"
#include "sim/draw/annotate.hpp"
#include "tools/common/table.hpp"
#include "tools/export/predicted_contact.hpp"

namespace palpate::exporting {
namespace {

using draw::Colour;

constexpr int kSupersampling = 2;
constexpr double kFieldOfView = 0.45;    // rad
constexpr double kArrow = 0.35;          // of the object's size, for the largest force
constexpr double kSmallestForce = 0.02;  // N; smaller forces are noise and get no arrow

const Colour kPlain{0.36F, 0.56F, 0.82F, 1};
const Colour kEdge{0.05F, 0.07F, 0.12F, 0.35F};
const Colour kSharpEdge{0.03F, 0.05F, 0.10F, 0.75F};
const Colour kTruthWire{0.86F, 0.10F, 0.10F, 1};
const Colour kRest{0.45F, 0.48F, 0.52F, 0.16F};
const Colour kRestEdge{0.45F, 0.48F, 0.52F, 0.45F};
const Colour kClamp{0.35F, 0.37F, 0.40F, 1};
const Colour kForce{0.90F, 0.35F, 0.05F, 1};
const Colour kPredictedForce{0.10F, 0.60F, 0.60F, 1};
const Colour kTrueForce{0.60F, 0.07F, 0.07F, 1};
const Colour kUnknownForce{0.55F, 0.15F, 0.75F, 1};
const Colour kTarget{0.80F, 0.05F, 0.45F, 1};
const Colour kFeature{0.10F, 0.60F, 0.20F, 1};
const Colour kFloor{0.62F, 0.66F, 0.71F, 0.55F};

double radians(double degrees) { return degrees * M_PI / 180; }

/// The largest number of 1, 2 or 5 times a power of ten that is not above `value`.
double round_down(double value) {
  const double power = std::pow(10, std::floor(std::log10(value)));
  for (const double digit : {5.0, 2.0})
    if (digit * power <= value) return digit * power;
  return power;
}

/// The next larger number with two digits.
double round_up(double value) {
  const double step = std::pow(10, std::floor(std::log10(value)) - 1);
  return step * std::ceil(value / step - 1e-9);
}

Eigen::AlignedBox3d bounds_of(const Eigen::Matrix3Xd& points) {
  return {Eigen::Vector3d(points.rowwise().minCoeff()),
          Eigen::Vector3d(points.rowwise().maxCoeff())};
}

std::string text_of_kind(const std::uint8_t* bytes, std::size_t size) {
  return std::string(reinterpret_cast<const char*>(bytes),
                     strnlen(reinterpret_cast<const char*>(bytes), size));
}

}  // namespace

SceneDrawing::SceneDrawing(const DrawingOptions& options)
    : options_(options), renderer_(options.width, options.height, kSupersampling) {
  if (options_.configuration.empty()) return;
  const config::Node configuration = config::Node::load_file(options_.configuration);
  X_WO_ = registry::read_frames(configuration).X_WO;
  obstacles_ = ObstaclePainter(configuration);
  if (!options_.urdf.empty())
    arm_ = std::make_unique<drawing::RobotDrawing>(options_.urdf, "flange");
}

Eigen::Matrix3Xd SceneDrawing::in_world(const Eigen::Matrix3Xd& points_O) const {
  return log::transformed(X_WO_, points_O);
}

void SceneDrawing::measure(const Instant& instant) {
  const auto add = [this](const Eigen::Matrix3Xd& points_O) {
    if (!points_O.allFinite()) return;  // such a shape is not drawn
    const Eigen::Matrix3Xd points = in_world(points_O);
    for (Eigen::Index i = 0; i < points.cols(); ++i) bounds_W_.extend(points.col(i));
  };
  for (const ShapeEvaluator* evaluator : {instant.estimate_mesh, instant.truth_mesh}) {
    if (evaluator == nullptr) continue;
    add(evaluator->mesh().nodes);
    size_ = std::max(size_, evaluator->mesh().longest_side());
  }
  if (instant.estimate_mesh != nullptr) add(instant.estimate);
  if (instant.truth_mesh != nullptr) add(instant.truth);
  const Eigen::VectorXd values = values_at_nodes(instant, options_.quantity);
  if (values.size() > 0 && values.allFinite()) {
    largest_ = std::max(largest_, values.maxCoeff());
    any_value_ = true;
  }
  if (!instant.contacts) return;
  const Eigen::Matrix3Xd& x = instant.estimate_mesh ? instant.estimate : instant.truth;
  const Eigen::Vector3d middle = X_WO_ * x.rowwise().mean();
  for (int i = 0; i < std::min(instant.contacts->count, 8); ++i) {
    const Eigen::Map<const Eigen::Vector3d> force(instant.contacts->wrench[i]);
    if (!(force.norm() > kSmallestForce)) continue;
    largest_force_ = std::max(largest_force_, force.norm());
    // Room for the arrow, which points away from the centre.
    const Eigen::Vector3d at = X_WO_ * Eigen::Vector3d::Map(instant.contacts->location[i]);
    const Eigen::Vector3d along = kArrow * size_ * (X_WO_.linear() * force.normalized());
    bounds_W_.extend((at + along - middle).norm() > (at - along - middle).norm()
                         ? Eigen::Vector3d(at + along)
                         : Eigen::Vector3d(at - along));
  }
}

void SceneDrawing::check() const {
  if (any_value_ || options_.quantity == Quantity::kNone) return;
  switch (options_.quantity) {
    case Quantity::kDeviation:
      throw std::runtime_error(
          "the log holds no truth at the times asked for (TRUTH_SHAPE with TRUTH_MESH), and so no "
          "deviation from it");
    case Quantity::kUncertainty:
      throw std::runtime_error("the shapes of this log come without standard deviations");
    case Quantity::kStress:
      throw std::runtime_error(
          "stress needs a stiffness: the log of the control URL with ESTIMATE, or --stiffness (of "
          "a true shape, --truth-stiffness)");
    default:
      throw std::runtime_error("no shape lies in the times that were asked for");
  }
}

double SceneDrawing::high() const {
  if (options_.high > options_.low) return options_.high;
  return largest_ > 0 ? round_up(largest_) : 1;
}

draw::View SceneDrawing::view() const {
  const Eigen::Vector3d middle = bounds_W_.center();
  const double azimuth = radians(options_.azimuth), elevation = radians(options_.elevation);
  const Eigen::Vector3d towards(std::cos(elevation) * std::cos(azimuth),
                                std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
  // The corners of the bounds must lie in the image: half of its width and height at their depth.
  const math::Pose X_WC = draw::look_at(
      middle + towards, middle,
      std::abs(towards.z()) > 0.999 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ());
  const double tangent = std::tan(kFieldOfView / 2);
  const double aspect = static_cast<double>(options_.width) / options_.height;
  double distance = 0;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d p =
        X_WC.linear().transpose() *
        (bounds_W_.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)) - middle);
    distance = std::max({distance, std::abs(p.x()) / (tangent * aspect) - p.z(),
                         std::abs(p.y()) / tangent - p.z()});
  }
  // Room for title, legend and colour bar.
  distance *= (arm_ ? 1.5 : 1.2) / options_.zoom;
  return draw::make_view(
      middle + distance * towards, middle,
      std::abs(towards.z()) > 0.999 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ(),
      kFieldOfView, options_.width, options_.height);
}

const draw::Image& SceneDrawing::draw(const Instant& instant) {
  draws_truth_ = draws_force_ = draws_target_ = draws_feature_ = false;
  values_ = values_at_nodes(instant, options_.quantity);
  renderer_.begin(view());
  const ShapeEvaluator* solid =
      instant.estimate_mesh != nullptr ? instant.estimate_mesh : instant.truth_mesh;
  middle_W_ = in_world(instant.estimate_mesh != nullptr ? instant.estimate : instant.truth)
                  .rowwise()
                  .mean();
  if (arm_ && instant.robot) draw_arm(*instant.robot);
  draw_floor();
  draw_clamp(solid->mesh());
  draw_shape(instant);
  if (instant.estimate_mesh != nullptr && instant.truth_mesh != nullptr) draw_truth(instant);
  draw_forces(instant);
  draw_target(instant);
  draw_rest(solid->mesh());
  obstacles_.draw(instant, bounds_of(in_world(solid->mesh().nodes)), renderer_);
  image_ = renderer_.end();
  annotate(instant);
  return image_;
}

void SceneDrawing::draw_shape(const Instant& instant) {
  const bool is_estimate = instant.estimate_mesh != nullptr;
  const log::MeshMessage& mesh = (is_estimate ? instant.estimate_mesh : instant.truth_mesh)->mesh();
  const Eigen::Matrix3Xd x = in_world(is_estimate ? instant.estimate : instant.truth);
  draw::MeshStyle style;
  style.colour = kPlain;
  for (Eigen::Index i = 0; i < values_.size(); ++i)
    style.vertex_colours.push_back(
        draw::colour_map((values_(i) - options_.low) / (high() - options_.low)));
  renderer_.draw_mesh(x, mesh.triangles, style);
  draw_edges(x, surface_edges(mesh, Edges::kAll), 1, kEdge);
  draw_edges(x, surface_edges(mesh, Edges::kSharp), 2, kSharpEdge);
}

void SceneDrawing::draw_truth(const Instant& instant) {
  draws_truth_ = true;
  const Eigen::Matrix3Xd x = in_world(instant.truth);
  draw_edges(x, surface_edges(instant.truth_mesh->mesh(), Edges::kAll), 1.5, kTruthWire);
}

void SceneDrawing::draw_edges(const Eigen::Matrix3Xd& points_W, const Eigen::Matrix2Xi& edges,
                              double width, const Colour& colour) {
  for (Eigen::Index e = 0; e < edges.cols(); ++e)
    renderer_.draw_line(points_W.col(edges(0, e)), points_W.col(edges(1, e)), width, colour);
}

void SceneDrawing::draw_rest(const log::MeshMessage& mesh) {
  draw::MeshStyle style;
  style.colour = kRest;
  const Eigen::Matrix3Xd x = in_world(mesh.nodes);
  renderer_.draw_mesh(x, mesh.triangles, style);
  draw_edges(x, surface_edges(mesh, Edges::kSharp), 1.5, kRestEdge);
}

/// A plate behind the fixed nodes, if they lie in a plane of the rest shape.
void SceneDrawing::draw_clamp(const log::MeshMessage& mesh) {
  if (mesh.constrained.empty()) return;
  Eigen::AlignedBox3d held, all;
  for (const int node : mesh.constrained) held.extend(mesh.nodes.col(node));
  for (Eigen::Index i = 0; i < mesh.nodes.cols(); ++i) all.extend(mesh.nodes.col(i));
  for (int axis = 0; axis < 3; ++axis) {
    if (held.sizes()(axis) > 1e-6) continue;
    const bool is_lower = held.min()(axis) < all.center()(axis);
    const double thickness = 0.04 * size_;
    Eigen::Vector3d size = 1.6 * held.sizes(), middle = held.center();
    size(axis) = thickness;
    middle(axis) += (is_lower ? -0.5 : 0.5) * thickness;
    math::Pose X_OB = math::Pose::Identity();
    X_OB.translation() = middle;
    renderer_.draw_box(X_WO_ * X_OB, size, kClamp);
    return;
  }
}

void SceneDrawing::draw_arrow(const Eigen::Vector3d& at_O, const Eigen::Vector3d& force_O,
                              const Colour& colour) {
  if (!(force_O.norm() > kSmallestForce)) return;
  const double scale = kArrow * size_ / std::max(largest_force_, 10 * kSmallestForce);
  const double length = std::min(scale * force_O.norm(), 2 * kArrow * size_);
  const Eigen::Vector3d at = X_WO_ * at_O, along = length * (X_WO_.linear() * force_O.normalized());
  // The arrow starts or ends at its point of application: the variant that lies outside the body is
  // visible.
  const bool pulls = (at + along - middle_W_).norm() > (at - along - middle_W_).norm();
  const Eigen::Vector3d from = pulls ? at : Eigen::Vector3d(at - along);
  renderer_.draw_arrow(from, from + along, 0.010 * size_, colour);
  draws_force_ = true;
}

void SceneDrawing::draw_forces(const Instant& instant) {
  if (instant.contacts) {
    for (int i = 0; i < std::min(instant.contacts->count, 8); ++i)
      draw_arrow(Eigen::Map<const Eigen::Vector3d>(instant.contacts->location[i]),
                 Eigen::Map<const Eigen::Vector3d>(instant.contacts->wrench[i]), kForce);
    for (int i = 0; i < predicted_count(*instant.contacts); ++i) {
      const PredictedContact contact = predicted_contact(*instant.contacts, i);
      draw_arrow(contact.place, contact.force, kPredictedForce);
    }
  }
  if (instant.estimated)
    draw_arrow(Eigen::Map<const Eigen::Vector3d>(instant.estimated->unknown_contact_location),
               Eigen::Map<const Eigen::Vector3d>(instant.estimated->unknown_contact_force),
               kUnknownForce);
  if (!instant.contacts && instant.truth_contact)
    for (int i = 0; i < std::min(instant.truth_contact->grasp_count, 2); ++i)
      draw_arrow(Eigen::Map<const Eigen::Vector3d>(instant.truth_contact->grasp_position[i]),
                 Eigen::Map<const Eigen::Vector3d>(instant.truth_contact->grasp_wrench[i]),
                 kTrueForce);
}

void SceneDrawing::draw_ball(const Eigen::Vector3d& at_O, double radius, const Colour& colour) {
  math::Pose X_WB = math::Pose::Identity();
  X_WB.translation() = X_WO_ * at_O;
  renderer_.draw_sphere(X_WB, radius, colour);
}

void SceneDrawing::draw_target(const Instant& instant) {
  if (!instant.feature) return;
  const feature_t& feature = *instant.feature;
  const std::string kind = text_of_kind(feature.kind, sizeof feature.kind);
  int step = 0, count = 0;
  if (kind == "point") step = 3, count = 1;
  if (kind == "points") step = 3, count = std::min(feature.value_count, 32) / 3;
  if (kind == "pose") step = 7, count = 1;
  if (step * count > feature.value_count) return;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d value = Eigen::Map<const Eigen::Vector3d>(feature.value + step * i);
    draw_ball(value, 0.016 * size_, kFeature);
    draws_feature_ = true;
    if (feature.revision < 0) continue;
    const Eigen::Vector3d target = Eigen::Map<const Eigen::Vector3d>(feature.target + step * i);
    draw_ball(target, 0.02 * size_, kTarget);
    renderer_.draw_line(X_WO_ * value, X_WO_ * target, 3, kTarget);
    draws_target_ = true;
  }
}

/// A grid below everything, for depth perception.
void SceneDrawing::draw_floor() {
  const double cell = round_down(0.35 * size_);
  const double z = bounds_W_.min().z() - 0.15 * size_;
  const auto snapped = [cell](double value, int away) {
    return cell * (std::round(value / cell) + away);
  };
  constexpr int kCells = 4;
  const double left = snapped(bounds_W_.center().x(), -kCells),
               right = snapped(bounds_W_.center().x(), kCells),
               front = snapped(bounds_W_.center().y(), -kCells),
               back = snapped(bounds_W_.center().y(), kCells);
  for (int i = 0; i <= 2 * kCells; ++i) {
    renderer_.draw_line({left + i * cell, front, z}, {left + i * cell, back, z}, 1, kFloor);
    renderer_.draw_line({left, front + i * cell, z}, {right, front + i * cell, z}, 1, kFloor);
  }
}

void SceneDrawing::draw_arm(const robot_state_t& state) {
  if (arm_->arm_joint_count() != state.joint_count) return;
  link_poses_.clear();
  arm_->place(math::Pose::Identity(), state.q, state.joint_count, nullptr, 0, link_poses_);
  for (const drawing::LinkShape& shape : arm_->shapes()) {
    const float* at = link_poses_.data() + static_cast<std::size_t>(7) * shape.link;
    math::Pose X_WL = math::Pose::Identity();
    X_WL.translation() = Eigen::Vector3f::Map(at).cast<double>();
    X_WL.linear() = Eigen::Quaterniond(at[6], at[3], at[4], at[5]).normalized().toRotationMatrix();
    const math::Pose X_WV = X_WL * shape.X_LV;
    const Eigen::Vector3f c = shape.colour.cast<float>();
    const Colour colour{c.x(), c.y(), c.z(), 1};
    if (shape.kind == "box")
      renderer_.draw_box(X_WV, shape.size, colour);
    else if (shape.kind == "cylinder")
      renderer_.draw_cylinder(X_WV, shape.size.x(), shape.size.y(), colour);
    else
      renderer_.draw_sphere(X_WV, shape.size.x(), colour);
  }
}

void SceneDrawing::annotate(const Instant& instant) {
  const QuantityText text = text_of(options_.quantity);
  std::string title = options_.title + (options_.title.empty() ? "" : ", ") +
                      common::formatted("t = %.2f s", instant.time);
  if (values_.size() > 0) {
    title += common::formatted("   %s: mean %.3g, max %.3g %s", text.name.c_str(),
                               text.factor * values_.mean(), text.factor * values_.maxCoeff(),
                               text.unit.c_str());
  }
  if (instant.status == shape_t::STATUS_OLD) title += "   SHAPE IS OLD";
  if (instant.status == shape_t::STATUS_NOT_CONVERGED) title += "   NOT CONVERGED";
  draw::draw_title(image_, title);

  std::vector<draw::LegendEntry> legend;
  const bool is_estimate = instant.estimate_mesh != nullptr;
  const std::string shape = is_estimate ? "estimated shape" : "true shape";
  if (values_.size() > 0)
    legend.push_back({shape + " by " + text.name, draw::colour_map(0.5)});
  else
    legend.push_back({shape, kPlain});
  if (draws_truth_) legend.push_back({"true shape", kTruthWire});
  legend.push_back({"shape at rest", {0.78F, 0.80F, 0.83F, 1}});
  if (draws_force_) {
    const double length = kArrow * size_;
    legend.push_back(
        {common::formatted("force (%.2g N: %.0f mm)", std::max(largest_force_, 10 * kSmallestForce),
                           length * 1e3),
         instant.contacts ? kForce : kTrueForce});
  }
  if (draws_feature_) legend.push_back({"feature", kFeature});
  if (draws_target_) legend.push_back({"target of the feature", kTarget});
  if (!obstacles_.drawn().empty())
    legend.push_back({"obstacles: " + obstacles_.drawn(), ObstaclePainter::kColour});
  draw::draw_legend(image_, legend);
  if (options_.quantity != Quantity::kNone)
    draw::draw_colour_bar(image_, text.factor * options_.low, text.factor * high(), text.unit);
}

}  // namespace palpate::exporting
