#include "tools/lab/cases/case_face.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

namespace palpate::cases {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;

std::pair<int, int> edge(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

struct FacePoint {
  Vector3d place;  // barycentric
  double weight;   // share of the area
};

/// Seven points, exact for degree 5 (Radon 1948): more than a linear traction on quadratic faces
/// needs.
std::vector<FacePoint> face_points() {
  std::vector<FacePoint> points{{Vector3d::Constant(1.0 / 3), 9.0 / 40}};
  const double root = std::sqrt(15.0);
  for (const double sign : {-1.0, 1.0}) {
    const double a = (6 + sign * root) / 21;
    for (int i = 0; i < 3; ++i) {
      Vector3d place = Vector3d::Constant(a);
      place[i] = 1 - 2 * a;
      points.push_back({place, (155 + sign * root) / 1200});
    }
  }
  return points;
}

VectorXd shapes(const Vector3d& b, int count) {
  if (count == 3) return b;
  VectorXd n(6);
  for (int i = 0; i < 3; ++i) {
    n[i] = b[i] * (2 * b[i] - 1);
    n[3 + i] = 4 * b[i] * b[(i + 1) % 3];
  }
  return n;
}

}  // namespace

SurfacePatch::SurfacePatch(const mesh::ElementMesh& mesh, const Eigen::Matrix3Xi& triangles)
    : mesh_(mesh) {
  const bool quadratic = mesh.order == mesh::ElementOrder::kQuadratic;
  faces_.resize(quadratic ? 6 : 3, triangles.cols());
  faces_.topRows<3>() = triangles;
  if (!quadratic) return;
  std::map<std::pair<int, int>, int> midside;
  for (int e = 0; e < mesh.element_count(); ++e) {
    for (int m = 0; m < 6; ++m) {
      const auto& [a, b] = mesh::kTetrahedronEdges[m];
      midside[edge(mesh.elements(a, e), mesh.elements(b, e))] = mesh.elements(4 + m, e);
    }
  }
  for (int f = 0; f < faces_.cols(); ++f) {
    for (int i = 0; i < 3; ++i) {
      const auto found = midside.find(edge(triangles(i, f), triangles((i + 1) % 3, f)));
      if (found == midside.end())
        throw std::invalid_argument("a surface triangle is no face of the mesh");
      faces_(3 + i, f) = found->second;
    }
  }
}

std::vector<int> SurfacePatch::nodes() const {
  const std::set<int> sorted(faces_.data(), faces_.data() + faces_.size());
  return {sorted.begin(), sorted.end()};
}

void SurfacePatch::integrate(const Visit& visit) const {
  static const std::vector<FacePoint> kPoints = face_points();
  for (int f = 0; f < faces_.cols(); ++f) {
    const Vector3d a = mesh_.nodes.col(faces_(0, f));
    const Vector3d ab = mesh_.nodes.col(faces_(1, f)) - a, ac = mesh_.nodes.col(faces_(2, f)) - a;
    const double area = 0.5 * ab.cross(ac).norm();
    for (const FacePoint& point : kPoints)
      visit(area * point.weight, shapes(point.place, static_cast<int>(faces_.rows())), f);
  }
}

Eigen::VectorXd SurfacePatch::nodal_areas() const {
  VectorXd areas = VectorXd::Zero(mesh_.node_count());
  integrate([&](double weight, const VectorXd& n, int f) {
    for (int a = 0; a < faces_.rows(); ++a) areas[faces_(a, f)] += n[a] * weight;
  });
  return areas;
}

double SurfacePatch::area() const { return nodal_areas().sum(); }

Vector3d SurfacePatch::mean(const Matrix3Xd& u) const { return u * nodal_areas() / area(); }

Matrix3Xd SurfacePatch::nodal_forces(
    const std::function<Vector3d(const Vector3d&)>& traction) const {
  Matrix3Xd forces = Matrix3Xd::Zero(3, mesh_.node_count());
  integrate([&](double weight, const VectorXd& n, int f) {
    Vector3d place = Vector3d::Zero();
    for (int a = 0; a < faces_.rows(); ++a) place += n[a] * mesh_.nodes.col(faces_(a, f));
    const Vector3d force = weight * traction(place);
    for (int a = 0; a < faces_.rows(); ++a) forces.col(faces_(a, f)) += n[a] * force;
  });
  return forces;
}

double SurfacePatch::twist(const Matrix3Xd& positions) const {
  const VectorXd areas = nodal_areas();
  const Vector3d rest_centre = mean(mesh_.nodes), centre = mean(positions);
  Eigen::Matrix3d moved = Eigen::Matrix3d::Zero(), rest = moved;
  for (const int node : nodes()) {
    const Vector3d from = mesh_.nodes.col(node) - rest_centre;
    moved += areas[node] * (positions.col(node) - centre) * from.transpose();
    rest += areas[node] * from * from.transpose();
  }
  // The patch is thinnest along its normal.
  int axis = 0;
  rest.diagonal().minCoeff(&axis);
  const int p = (axis + 1) % 3, q = (axis + 2) % 3;
  return std::atan2(moved(q, p) - moved(p, q), moved(p, p) + moved(q, q));
}

}  // namespace palpate::cases
