#include "tools/lab/shapes/sagging_cylinder.hpp"

#include <cmath>

#include "core/mesh/point_locator.hpp"
#include "core/mesh/round_mesh.hpp"
#include "rt/config/node.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/cases/case_face.hpp"
#include "tools/lab/cases/case_problem.hpp"
#include "tools/lab/shapes/weight_statics.hpp"

namespace palpate::shapes {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kGoal = 4;       // mm, of the end face's centre
constexpr int kAxisSamples = 60;  // of the drawn axis

struct Division {
  int rings, layers;
};
constexpr Division kCoarse{1, 12}, kFine{2, 24};

cases::CaseProblem problem_of(const SaggingCylinder& cylinder, const mesh::MeshWithGroups& mesh) {
  cases::CaseFile c;
  c.name = cylinder.name;
  c.material = {cylinder.young_modulus, kRubberPoisson, cylinder.density};
  c.gravity = cylinder.gravity;
  c.fixed = cases::CaseRegion{"fixed", {}};
  return cases::make_problem(c, mesh, mesh::ElementOrder::kQuadratic);
}

/// Curve of the axis in the plane of sag: along the axis at rest, and against gravity, mm.
Eigen::Matrix2Xd drawn_axis(const SaggingCylinder& cylinder, const mesh::ElementMesh& mesh,
                            const Matrix3Xd& positions) {
  const mesh::PointLocator locator(mesh);
  Eigen::Matrix2Xd curve(2, kAxisSamples + 1);
  const Vector3d along = Vector3d::Unit(cylinder.axis), up = -cylinder.gravity.normalized();
  for (int i = 0; i <= kAxisSamples; ++i) {
    const Vector3d rest = along * (cylinder.length * i / kAxisSamples);
    const Vector3d p = locator.locate(rest).interpolate(positions) / kMm;
    curve.col(i) << along.dot(p), up.dot(p);
  }
  return curve;
}

ShapeResult predict(const SaggingCylinder& cylinder, Law law, const Division& division) {
  const mesh::MeshWithGroups mesh = mesh_of(cylinder, division.rings, division.layers);
  const cases::CaseProblem problem = problem_of(cylinder, mesh);
  const Matrix3Xd positions = rest_under_weight(problem, law, cylinder.mooney);
  const mesh::ElementMesh& elements = problem.body.mesh;

  ShapeResult result;
  result.recording = cylinder.name;
  result.model = std::string(name_of(law)) + ", " + std::to_string(division.rings) + " rings x " +
                 std::to_string(division.layers) + " layers";
  result.material =
      "E " + common::number(1e-3 * cylinder.young_modulus, 1) + " kPa of the recording";
  result.nodes = elements.node_count();
  if (law == Law::kCorotational)
    result.incremental_deviation = incremental_deviation(problem, positions);

  const Vector3d along = Vector3d::Unit(cylinder.axis), up = -cylinder.gravity.normalized();
  const Vector3d centre =
      mesh::PointLocator(elements).locate(cylinder.length * along).interpolate(positions);
  const Vector3d error = (centre - cylinder.marker) / kMm;
  const double deviation = cylinder.marker_deviation / kMm;
  result.scores = {{"end face's centre from the marker", "mm", error.norm(), deviation, kGoal},
                   {"along the axis at rest", "mm", along.dot(error), deviation, {}},
                   {"height", "mm", up.dot(error), deviation, {}}};
  const SectionErrors section = section_errors(cylinder, mesh.mesh);
  result.notes.push_back("mesh: volume " + common::formatted("%+.2f", 100 * section.volume) +
                         " %, second moment of area " +
                         common::formatted("%+.2f", 100 * section.second_moment) + " %");
  const cases::SurfacePatch tip(elements, mesh.groups.at("tip").triangles);
  double lowest = up.dot(centre);
  for (const int node : tip.nodes()) lowest = std::min(lowest, up.dot(positions.col(node)));
  result.notes.push_back(
      "the recording does not state which point of the end face was marked; "
      "its lowest point is predicted " +
      common::number((up.dot(centre) - lowest) / kMm, 1) + " mm below its centre");
  const Eigen::Vector2d marked(along.dot(cylinder.marker) / kMm, up.dot(cylinder.marker) / kMm);
  result.outlines = {{"axis, predicted", drawn_axis(cylinder, elements, positions), false, true},
                     {"marker, measured", marked, true, false}};
  return result;
}

}  // namespace

SaggingCylinder read_sagging_cylinder(const std::filesystem::path& file) {
  const config::Node node = config::Node::load_file(file.string());
  SaggingCylinder c;
  c.name = std::filesystem::absolute(file).parent_path().filename().string();
  constexpr config::Range kLength{1e-3, 1e6};  // mm
  c.length = kMm * node.number("length_mm", kLength);
  c.radius = kMm * node.number("radius_mm", kLength);
  const std::vector<std::string> axes{"x", "y", "z"};
  c.axis = node.choice("axis", axes)[0] - 'x';
  c.gravity = node.vector3("gravity_m_s2", {-100, 100});
  if (c.gravity.norm() < 1e-9) node.fail("gravity_m_s2", "is zero");
  c.density = node.number("density_kg_m3", {1e-3, 1e5});
  const std::vector<double> mooney = node.numbers("mooney_rivlin_Pa", 2, {0, 1e12}, {0, 0});
  const double sum = mooney[0] + mooney[1];
  if (sum > 0) c.mooney = mooney[1] / sum;
  constexpr config::Range kModulus{1e-3, 1e12};
  c.young_modulus = sum > 0 ? node.number("young_modulus_Pa", kModulus, 6 * sum)
                            : node.number("young_modulus_Pa", kModulus);
  c.marker = kMm * node.vector3("measured_tip_mm", {-1e6, 1e6});
  c.marker_deviation = kMm * node.number("measured_tip_tolerance_mm", {0, 1e6}, 0);
  return c;
}

mesh::MeshWithGroups mesh_of(const SaggingCylinder& cylinder, int rings, int layers) {
  mesh::MeshWithGroups mesh =
      mesh::make_cylinder(cylinder.radius, cylinder.length, rings, layers, mesh::RoundSides::kFull);
  Eigen::Matrix3d turned;  // cyclic, such that x becomes the recording's axis
  for (int i = 0; i < 3; ++i) turned.col(i) = Vector3d::Unit((i + cylinder.axis) % 3);
  mesh.mesh.nodes = turned * mesh.mesh.nodes;
  mesh.groups["fixed"] = mesh.groups.at("x_min");
  mesh.groups["tip"] = mesh.groups.at("x_max");
  return mesh;
}

SectionErrors section_errors(const SaggingCylinder& cylinder, const mesh::TetrahedralMesh& mesh) {
  double volume = 0, moment = 0;  // m^3; m^5, of both transverse coordinates together
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) {
    const double v = mesh::volume(mesh, t);
    volume += v;
    for (int k = 1; k < 3; ++k) {
      const int transverse = (cylinder.axis + k) % 3;
      double sum = 0, squares = 0;
      for (int a = 0; a < 4; ++a) {
        const double y = mesh.nodes(transverse, mesh.tetrahedra(a, t));
        sum += y;
        squares += y * y;
      }
      moment += v / 20 * (squares + sum * sum);  // exact for a tetrahedron
    }
  }
  const double area = M_PI * cylinder.radius * cylinder.radius;
  const double second = area * cylinder.radius * cylinder.radius / 4;
  return {volume / (area * cylinder.length) - 1, moment / 2 / (second * cylinder.length) - 1};
}

std::vector<ShapeResult> score_sagging_cylinder(const SaggingCylinder& cylinder) {
  return {predict(cylinder, Law::kCorotational, kCoarse),
          predict(cylinder, Law::kCorotational, kFine),
          predict(cylinder, Law::kHyperelastic, kFine)};
}

}  // namespace palpate::shapes
