#include "tools/lab/shapes/sponge_model.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "core/mesh/grid_mesh.hpp"

namespace palpate::shapes {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kStep = 20e-3;  // s
constexpr int kSettlingSteps = 25;
constexpr int kRenewal = 4;  // steps after which a new factor, with its sensitivity, is worth it
constexpr double kDensity =
    25;                         // kg/m^3, soft polyurethane: the weight is a hundredth of the force
constexpr double kEdge = 1e-9;  // of the unit square
enum Obstacle { kTable, kFinger };

/// Pixels, y downward, to x and z in O.
Vector3d in_space(const Vector2d& pixels, double y = 0) {
  return {kPixel * pixels.x(), y, -kPixel * pixels.y()};
}

/// Position along the border of the unit square, counter-clockwise from its lower left corner, in
/// 0 to 4; negative inside.
double along_border(const Vector2d& at) {
  if (at.y() < kEdge) return at.x();
  if (at.x() > 1 - kEdge) return 1 + at.y();
  if (at.y() > 1 - kEdge) return 3 - at.x();
  return at.x() < kEdge ? 4 - at.y() : -1;
}

math::Pose pose_of_finger(const Vector2d& centre) {
  const Matrix3d along_y = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitX()).toRotationMatrix();
  return math::make_pose(along_y, in_space(centre, kThickness / 2));
}

collision::Obstacle table_of(const PushedSponge& sponge) {
  const Vector3d left = in_space(sponge.corners.col(3)), right = in_space(sponge.corners.col(2));
  const Vector3d normal = (right - left).cross(Vector3d::UnitY()).normalized();
  const Matrix3d R = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(),
                                                        normal.z() < 0 ? Vector3d(-normal) : normal)
                         .toRotationMatrix();
  return {"table", collision::HalfSpace{}, math::make_pose(R, left), kFriction};
}

elasticity::SolverOptions solver_options(const PushedSponge& sponge, const math::Pose& finger) {
  elasticity::SolverOptions options;
  options.time_step = kStep;
  options.iterations = 6;
  options.contact.obstacles = {
      table_of(sponge),
      {"finger", collision::Cylinder{kFingerRadius * kPixel, 1}, finger, kFriction}};
  options.contact.most = 400;
  options.contact.sweeps = 40;
  options.contact.columns = options.contact.most;  // time does not matter: all in one step
  options.contact.reach = options.contact.imminent = 1e-3;
  return options;
}

void step(elasticity::CorotationalModel& model, int count) {
  elasticity::Refactorisation* job =
      count % kRenewal == 0 ? model.wanted_refactorisation() : nullptr;
  if (job != nullptr) {
    job->run();
    model.install(*job);
  }
  if (model.step(kStep).status == elasticity::StepStatus::kFailed)
    throw std::runtime_error("the model of the pushed sponge failed");
}

}  // namespace

SpongeModel::SpongeModel(const PushedSponge& sponge, std::array<int, 2> cells) : sponge_(sponge) {
  mesh::TetrahedralMesh unit = mesh::make_grid(
      mesh::even_planes(Vector3d::Zero(), {1, kThickness, 1}, {cells[0], 1, cells[1]}),
      mesh::CellCut::kSix);
  mesh_ = mesh::make_element_mesh(unit, mesh::ElementOrder::kQuadratic);
  std::map<double, int> ordered;
  for (int n = 0; n < nodes(); ++n) {
    const Vector3d at = mesh_.nodes.col(n);
    const double place = along_border({at.x(), at.z()});
    if (at.y() < kEdge && place >= 0) ordered.emplace(place, n);
    const auto& c = sponge.corners;  // bilinear between the corners
    const Vector2d top = (1 - at.x()) * c.col(0) + at.x() * c.col(1);
    const Vector2d bottom = (1 - at.x()) * c.col(3) + at.x() * c.col(2);
    mesh_.nodes.col(n) = in_space((1 - at.z()) * bottom + at.z() * top, at.y());
  }
  for (const auto& [place, node] : ordered) border_.push_back(node);
}

PredictedSponge SpongeModel::observe(const elasticity::CorotationalModel& model) const {
  PredictedSponge seen;
  seen.outline.resize(2, static_cast<Eigen::Index>(border_.size()));
  for (std::size_t i = 0; i < border_.size(); ++i) {
    const Vector3d at = model.positions().col(border_[i]) / kPixel;
    seen.outline.col(i) << at.x(), -at.z();
  }
  for (const elasticity::SurfaceContact& contact : model.contacts())
    if (contact.obstacle == kFinger) seen.force -= contact.force.z();
  return seen;
}

std::vector<PredictedSponge> SpongeModel::predict(const SpongeParameters& parameters,
                                                  int last) const {
  elasticity::Body body;
  body.mesh = mesh_;
  body.material = {kModulus, parameters.poisson_ratio, kDensity};
  body.damping = {5, 0.02};
  body.gravity_O = {0, 0, -9.81};
  // the finger is as far from the sponge as its height says: the camera sees it nearer to itself
  const auto& corners = sponge_.corners;
  const auto& frames = sponge_.frames;
  const auto finger = [&](const Vector2d& recorded) {
    const double share = (recorded.x() - corners(0, 0)) / (corners(0, 1) - corners(0, 0));
    const double top = corners(1, 0) + share * (corners(1, 1) - corners(1, 0));
    return Vector2d(recorded.x(), recorded.y() - parameters.contact_height + top - kFingerRadius);
  };
  Vector2d at = finger(frames.front().finger);
  elasticity::CorotationalDynamic model(body, solver_options(sponge_, pose_of_finger(at)));
  model.prepare();
  model.set_gravity(body.gravity_O);
  for (int i = 0; i < kSettlingSteps; ++i) step(model, i);
  std::vector<PredictedSponge> predicted{observe(model)};
  for (int k = 1; k <= last; ++k) {
    const Vector2d next = finger(frames[k].finger);
    const double duration = frames[k].time - frames[k - 1].time;
    const int steps = std::max(1, static_cast<int>(std::lround(duration / kStep)));
    collision::Placement placement;
    placement.V_O_B.linear = (in_space(next) - in_space(at)) / duration;
    for (int i = 1; i <= steps; ++i) {
      placement.X_OB = pose_of_finger(at + (next - at) * i / steps);
      model.place_obstacle(kFinger, placement);
      step(model, i);
    }
    at = next;
    predicted.push_back(observe(model));
  }
  return predicted;
}

}  // namespace palpate::shapes
