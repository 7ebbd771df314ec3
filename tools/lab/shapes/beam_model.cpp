#include "tools/lab/shapes/beam_model.hpp"

#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <stdexcept>

#include "core/mesh/point_locator.hpp"
#include "tools/lab/cases/case_mesh.hpp"

namespace palpate::shapes {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kAnyModulus = 200e3;  // Pa, replaced before every solution
const cases::CaseGrid kGrid{{12, 4, 2}, mesh::CellCut::kFive, 1};  // cells of about 15 mm

cases::CaseFile case_of(const HangingBeams& beams, const std::vector<BeamPart>& parts) {
  cases::CaseFile c;
  c.name = "beam";
  c.boxes = {beams.bar, beams.block};
  c.material = {kAnyModulus, kRubberPoisson, beams.density};
  c.gravity = beams.gravity;
  Eigen::AlignedBox3d face = beams.bar, body = beams.bar;
  face.min().x() = face.max().x();
  body.extend(beams.block);
  c.fixed = cases::CaseRegion{"fixed", face};
  if (parts.size() > 1) {
    for (const BeamPart& part : parts) {
      Eigen::AlignedBox3d box = body;
      box.min().x() = part.lower;
      box.max().x() = part.upper;
      c.overrides.push_back({box, c.material});
    }
  }
  return c;
}

Matrix3Xd corners_of(const Eigen::AlignedBox3d& box) {
  Matrix3Xd corners(3, 8);
  for (int i = 0; i < 8; ++i)
    corners.col(i) = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i));
  return corners;
}

}  // namespace

BeamModel::BeamModel(const HangingBeams& beams, const std::vector<BeamPart>& parts)
    : block_corners_(corners_of(beams.block)) {
  const cases::CaseFile c = case_of(beams, parts);
  problem_ =
      cases::make_problem(c, cases::make_case_mesh(c, kGrid), mesh::ElementOrder::kQuadratic);
  if (!problem_.body.element_materials.empty()) {
    const mesh::ElementMesh& mesh = problem_.body.mesh;
    for (int e = 0; e < mesh.element_count(); ++e) {
      double x = 0;
      for (int a = 0; a < 4; ++a) x += mesh.nodes(0, mesh.elements(a, e)) / 4;
      part_of_.push_back(x > parts[0].lower ? 0 : 1);
    }
  }
  const mesh::Surface surface = mesh::extract_surface(problem_.body.mesh);
  const int count = static_cast<int>(surface.triangle_nodes.size());
  triangles_.resize(3, 4 * count);
  constexpr int kQuarters[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};
  for (int t = 0; t < count; ++t) {
    const std::vector<int>& nodes = surface.triangle_nodes[t];
    bool is_end = true;
    for (const int node : nodes)
      is_end = is_end && problem_.body.mesh.nodes(0, node) < beams.block.min().x() + 1e-9;
    for (int q = 0; q < 4; ++q) {
      for (int i = 0; i < 3; ++i) triangles_(i, 4 * t + q) = nodes[kQuarters[q][i]];
      is_end_.push_back(is_end);
    }
  }
}

cases::CaseProblem BeamModel::problem(const std::vector<double>& moduli) const {
  cases::CaseProblem problem = problem_;
  problem.body.material.young_modulus = moduli.at(0);
  for (std::size_t e = 0; e < part_of_.size(); ++e)
    problem.body.element_materials[e].young_modulus = moduli.at(part_of_[e]);
  return problem;
}

BlockPose BeamModel::block_pose(const Matrix3Xd& positions) const {
  const Matrix3Xd moved = at(block_corners_, positions);
  const Eigen::Matrix4d X = Eigen::umeyama(block_corners_, moved, false);
  return {moved.rowwise().mean().head<2>(), std::atan2(X(1, 0), X(0, 0))};
}

Matrix3Xd BeamModel::at(const Matrix3Xd& rest, const Matrix3Xd& positions) const {
  const mesh::PointLocator locator(problem_.body.mesh);
  Matrix3Xd places(3, rest.cols());
  for (int i = 0; i < rest.cols(); ++i)
    places.col(i) = locator.locate(rest.col(i)).interpolate(positions);
  return places;
}

DropFit fit_to_drop(const BeamModel& model, double height, double height_deviation, Law law) {
  constexpr double kGuess = 200e3, kFactor = 1.5, kLeast = 1e3, kMost = 1e9;  // Pa
  const auto height_at = [&](double modulus) {
    if (modulus < kLeast || modulus > kMost)
      throw std::runtime_error("no Young's modulus between 1 kPa and 1 GPa gives the block's drop");
    return model.block_pose(model.rest({modulus}, law)).centre.y();
  };
  std::uintmax_t iterations = 60;
  const auto [below, above] = boost::math::tools::bracket_and_solve_root(
      [&](double modulus) { return height_at(modulus) - height; }, kGuess, kFactor, true,
      boost::math::tools::eps_tolerance<double>(16), iterations);
  DropFit fit;
  fit.young_modulus = (below + above) / 2;
  const double step = 0.02 * fit.young_modulus;
  const double slope =
      (height_at(fit.young_modulus + step) - height_at(fit.young_modulus - step)) / (2 * step);
  fit.deviation = height_deviation / slope;
  return fit;
}

}  // namespace palpate::shapes
