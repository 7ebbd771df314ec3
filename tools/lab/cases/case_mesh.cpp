#include "tools/lab/cases/case_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "core/mesh/mesh_formats.hpp"
#include "core/mesh/surface.hpp"
#include "rt/config/node.hpp"
#include "tools/common/table.hpp"

namespace palpate::cases {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

constexpr double kTolerance = 1e-9;  // m

/// Planes along an axis that must be cell borders, ascending.
std::vector<double> forced_planes(const CaseFile& c, int axis) {
  AlignedBox3d body;
  for (const AlignedBox3d& box : c.boxes) body.extend(box);
  std::vector<AlignedBox3d> boxes = c.boxes;
  for (const MaterialOverride& o : c.overrides) boxes.push_back(o.box);
  if (c.fixed) boxes.push_back(c.fixed->box);
  if (c.grasp) boxes.push_back(c.grasp->region.box);
  for (const CaseLoad& load : c.loads) boxes.push_back(load.region.box);
  std::vector<double> planes;
  for (const AlignedBox3d& box : boxes) {
    if (box.isEmpty()) continue;
    for (const double place : {box.min()[axis], box.max()[axis]})
      planes.push_back(std::clamp(place, body.min()[axis], body.max()[axis]));
  }
  std::sort(planes.begin(), planes.end());
  const auto same = [](double a, double b) { return b - a < kTolerance; };
  planes.erase(std::unique(planes.begin(), planes.end(), same), planes.end());
  return planes;
}

/// Distributes `cells` over the intervals between the planes so that the widest cell is as narrow
/// as possible.
std::vector<double> divide(const std::vector<double>& planes, int cells) {
  const int intervals = static_cast<int>(planes.size()) - 1;
  std::vector<int> counts(intervals, 1);
  const auto width = [&](int i) { return (planes[i + 1] - planes[i]) / counts[i]; };
  for (int spent = intervals; spent < cells; ++spent) {
    int widest = 0;
    for (int i = 1; i < intervals; ++i)
      if (width(i) > width(widest) + kTolerance) widest = i;
    ++counts[widest];
  }
  std::vector<double> divided;
  for (int i = 0; i < intervals; ++i)
    for (int k = 0; k < counts[i]; ++k)
      divided.push_back(planes[i] + (planes[i + 1] - planes[i]) * k / counts[i]);
  divided.push_back(planes.back());
  return divided;
}

/// The same with cells uniform in s, where a plane's distance from the clamp is proportional to
/// s^grading.
std::vector<double> divide_graded(std::vector<double> planes, int cells, double clamp,
                                  double grading) {
  const double from =
      clamp - planes.front() < planes.back() - clamp ? planes.front() : planes.back();
  const double length = (planes.front() + planes.back() - 2 * from);
  const auto map = [&](double power) {
    return [=](double x) { return from + length * std::pow((x - from) / length, power); };
  };
  std::transform(planes.begin(), planes.end(), planes.begin(), map(1 / grading));
  std::vector<double> divided = divide(planes, cells);
  std::transform(divided.begin(), divided.end(), divided.begin(), map(grading));
  return divided;
}

mesh::MeshGroup surface_in(const AlignedBox3d& box, const mesh::TetrahedralMesh& mesh,
                           const Eigen::Matrix3Xi& surface) {
  const auto inside = [&](int node) {
    return (mesh.nodes.col(node).array() >= box.min().array() - kTolerance).all() &&
           (mesh.nodes.col(node).array() <= box.max().array() + kTolerance).all();
  };
  mesh::MeshGroup group;
  for (int t = 0; t < surface.cols(); ++t) {
    if (!inside(surface(0, t)) || !inside(surface(1, t)) || !inside(surface(2, t))) continue;
    group.triangles.conservativeResize(3, group.triangles.cols() + 1);
    group.triangles.rightCols<1>() = surface.col(t);
    for (int i = 0; i < 3; ++i) group.nodes.push_back(surface(i, t));
  }
  std::sort(group.nodes.begin(), group.nodes.end());
  group.nodes.erase(std::unique(group.nodes.begin(), group.nodes.end()), group.nodes.end());
  return group;
}

}  // namespace

mesh::MeshWithGroups read_case_mesh(const CaseFile& c, const std::string& name) {
  const auto file = c.meshes.find(name);
  if (file == c.meshes.end()) {
    std::string known;
    for (const auto& [other, path] : c.meshes) known += (known.empty() ? "" : ", ") + other;
    c.fail("files.mesh_" + name, "is missing; allowed: " + known);
  }
  std::ifstream in(file->second);
  if (!in) c.fail("files.mesh_" + name, file->second.string() + " cannot be read");
  try {
    mesh::MeshWithGroups result = mesh::read_gmsh(in, file->second.string());
    mesh::orient(result.mesh);
    return result;
  } catch (const mesh::ParseError& error) {
    throw config::Error(error.what());
  }
}

std::string CaseGrid::text() const {
  std::string text;
  for (const int n : cells) text += (text.empty() ? "" : "x") + std::to_string(n);
  if (cut == mesh::CellCut::kSix) text += "k";
  return grading == 1 ? text : text + "^" + common::number(grading, 1);
}

mesh::MeshWithGroups make_case_mesh(const CaseFile& c, const CaseGrid& grid) {
  if (c.boxes.empty()) c.fail("geometry.boxes", "is missing: own meshes are made of boxes");
  mesh::GridPlanes planes;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double> forced = forced_planes(c, axis);
    // A clamped face is flat along the axis that points away from it.
    const bool away = grid.grading != 1 && c.fixed && !c.fixed->box.isEmpty() &&
                      c.fixed->box.sizes()[axis] < kTolerance;
    planes[axis] =
        away ? divide_graded(forced, grid.cells[axis], c.fixed->box.min()[axis], grid.grading)
             : divide(forced, grid.cells[axis]);
  }
  mesh::MeshWithGroups result;
  result.mesh = mesh::make_grid(planes, grid.cut, [&c](const Vector3d& centre) {
    return std::any_of(c.boxes.begin(), c.boxes.end(),
                       [&centre](const AlignedBox3d& box) { return box.contains(centre); });
  });
  const Eigen::Matrix3Xi surface =
      mesh::extract_surface(mesh::make_element_mesh(result.mesh, mesh::ElementOrder::kLinear))
          .triangles;
  const auto add = [&](const CaseRegion& region, const std::string& key) {
    if (region.box.isEmpty()) c.fail(key + ".box", "is missing: own meshes need it");
    result.groups[region.group] = surface_in(region.box, result.mesh, surface);
  };
  if (c.fixed) add(*c.fixed, "fixed");
  if (c.grasp) add(c.grasp->region, "grasp");
  for (std::size_t i = 0; i < c.loads.size(); ++i)
    add(c.loads[i].region, "loads." + std::to_string(i));
  return result;
}

}  // namespace palpate::cases
