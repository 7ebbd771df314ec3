#include "tools/fit/simulators/soft_object.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>

#include "core/elasticity/static_solver.hpp"
#include "core/mesh/subdivision.hpp"
#include "rt/registry/object.hpp"

namespace palpate::fit {
namespace {

constexpr int kMostNodes = 200000;  // beyond which other simulators need hours for a step

using Nodes = std::set<int>;

Nodes set_of(const std::vector<int>& nodes) { return {nodes.begin(), nodes.end()}; }

/// Adds the middles of edges both of whose ends belong to a part.
void add_middles(const mesh::ElementMesh& quadratic, Nodes& part) {
  for (int e = 0; e < quadratic.element_count(); ++e) {
    for (int k = 0; k < 6; ++k) {
      const auto* edge = mesh::kTetrahedronEdges[k];
      if (part.count(quadratic.elements(edge[0], e)) != 0 &&
          part.count(quadratic.elements(edge[1], e)) != 0)
        part.insert(quadratic.elements(4 + k, e));
    }
  }
}

std::vector<int> eightfold(const std::vector<int>& of) {
  std::vector<int> result;
  for (const int value : of) result.insert(result.end(), 8, value);
  return result;
}

bool is_same(const elasticity::Material& a, const elasticity::Material& b) {
  return a.young_modulus == b.young_modulus && a.poisson_ratio == b.poisson_ratio &&
         a.density == b.density;
}

void list_materials(const elasticity::Body& body, SoftObject& object) {
  for (int e = 0; e < body.mesh.element_count(); ++e) {
    const elasticity::Material& material = body.material_of(e);
    const auto known =
        std::find_if(object.materials.begin(), object.materials.end(),
                     [&](const elasticity::Material& other) { return is_same(material, other); });
    object.material_of.push_back(static_cast<int>(known - object.materials.begin()));
    if (known == object.materials.end()) object.materials.push_back(material);
  }
}

/// In O; with the parts' nodes and each tetrahedron's material.
mesh::TetrahedralMesh divide(const elasticity::Body& body, int refinements, Nodes& fixed,
                             Nodes& grasped, std::vector<int>& material_of) {
  mesh::TetrahedralMesh mesh;
  if (body.mesh.order == mesh::ElementOrder::kQuadratic) {
    mesh = mesh::subdivide(body.mesh);
    material_of = eightfold(material_of);
  } else {
    mesh.nodes = body.mesh.nodes;
    mesh.tetrahedra = body.mesh.elements;
  }
  for (int i = 0; i < refinements; ++i) {
    const mesh::ElementMesh quadratic =
        mesh::make_element_mesh(mesh, mesh::ElementOrder::kQuadratic);
    if (quadratic.node_count() > kMostNodes)
      throw config::Error("--refine " + std::to_string(refinements) +
                          ": the mesh would have more than " + std::to_string(kMostNodes) +
                          " nodes; allowed: at most " + std::to_string(i));
    add_middles(quadratic, fixed);
    add_middles(quadratic, grasped);
    mesh = mesh::subdivide(quadratic);
    material_of = eightfold(material_of);
  }
  return mesh;
}

/// With a rigid grasp, as the files have it.
Eigen::Matrix3Xd positions_under_weight(elasticity::Body body, bool is_held) {
  elasticity::HeldPoses held;
  for (std::size_t g = 0; g < body.grasps.size(); ++g) {
    body.grasps[g].compliance.setZero();
    body.grasps[g].object_compliance.setZero();
    if (is_held) held[g] = body.grasps[g].X_OG_rest;
  }
  const Eigen::Matrix3Xd loads = Eigen::Matrix3Xd::Zero(3, body.mesh.node_count());
  const elasticity::StaticSolution solution = elasticity::solve_static(body, loads, held);
  if (!solution.converged)
    throw std::runtime_error("the object's weight has no equilibrium that Newton's method finds");
  return solution.positions;
}

std::vector<std::string> list_left_out(const registry::Object& object, bool is_held) {
  std::vector<std::string> left_out;
  for (const registry::ConfiguredObstacle& obstacle : object.obstacles)
    left_out.push_back("obstacle " + obstacle.limited.body.name);
  const bool has_pads =
      std::any_of(object.body.grasps.begin(), object.body.grasps.end(),
                  [](const elasticity::GraspRegion& grasp) { return !grasp.compliance.isZero(0); });
  if (is_held && has_pads) left_out.emplace_back("compliance of the hand's pads");
  return left_out;
}

}  // namespace

Eigen::VectorXd SoftObject::masses() const {
  Eigen::VectorXd masses = Eigen::VectorXd::Zero(mesh.node_count());
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) {
    const double quarter = materials[material_of[t]].density * mesh::volume(mesh, t) / 4;
    for (const int node : mesh.tetrahedra.col(t)) masses[node] += quarter;
  }
  return masses;
}

int SoftObject::farthest_node() const {
  int farthest = 0;
  (at_rest - mesh.nodes.leftCols(at_rest.cols())).colwise().norm().maxCoeff(&farthest);
  return farthest;
}

Eigen::Vector3d SoftObject::largest_displacement() const {
  const int node = farthest_node();
  return at_rest.col(node) - mesh.nodes.col(node);
}

SoftObject read_soft_object(const config::Node& configuration, const std::string& file,
                            const ExportOptions& options) {
  const registry::Frames frames = registry::read_frames(configuration);
  const registry::Object read = registry::read_object(configuration, frames);
  const bool is_held = options.grasp == ExportedGrasp::kHeld;
  SoftObject object;
  object.configuration = file;
  object.X_WO = frames.X_WO;
  object.damping = read.body.damping;
  object.gravity_W = frames.X_WO.linear() * read.body.gravity_O;
  object.left_out = list_left_out(read, is_held);
  list_materials(read.body, object);
  Nodes fixed = set_of(read.body.fixed_nodes), grasped;
  for (const elasticity::GraspRegion& grasp : read.body.grasps)
    grasped.insert(grasp.nodes.begin(), grasp.nodes.end());
  if (is_held && grasped.empty())
    throw config::Error(file + ": object: has no grasp, which --grasp held needs");
  if (fixed.empty() && !is_held)
    throw config::Error(file +
                        ": object: nothing is fixed, so that it would fall; allowed with "
                        "--grasp held");
  object.mesh = divide(read.body, options.refinements, fixed, grasped, object.material_of);
  object.mesh.nodes = frames.X_WO * object.mesh.nodes;
  if (is_held) fixed.insert(grasped.begin(), grasped.end());
  object.fixed.assign(fixed.begin(), fixed.end());
  object.grasped.assign(grasped.begin(), grasped.end());
  object.at_rest = frames.X_WO * positions_under_weight(read.body, is_held);
  return object;
}

}  // namespace palpate::fit
