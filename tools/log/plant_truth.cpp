#include "tools/log/plant_truth.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include "core/mesh/point_locator.hpp"
#include "rt/bus/shape_chunks.hpp"

namespace palpate::log {
namespace {

constexpr int kHexahedronNodes = 27, kTetrahedronNodes = 4;

/// Value at s of the quadratic Lagrange polynomial on 0, 1/2, 1 that belongs to the node at `node`.
double lagrange(double node, double s) {
  if (node < 0.25) return 2 * (s - 0.5) * (s - 1);
  if (node > 0.75) return 2 * s * (s - 0.5);
  return 4 * s * (1 - s);
}

struct RestBox {
  Eigen::Vector3d lower, upper;
  double distance(const Eigen::Vector3d& p) const {
    return (lower - p).cwiseMax(p - upper).cwiseMax(0).norm();
  }
};

std::vector<RestBox> rest_boxes(const MeshMessage& mesh) {
  std::vector<RestBox> boxes;
  for (int e = 0; e < mesh.elements.cols(); ++e) {
    RestBox box{mesh.nodes.col(mesh.elements(0, e)), mesh.nodes.col(mesh.elements(0, e))};
    for (int i = 1; i < mesh.elements.rows(); ++i) {
      box.lower = box.lower.cwiseMin(mesh.nodes.col(mesh.elements(i, e)));
      box.upper = box.upper.cwiseMax(mesh.nodes.col(mesh.elements(i, e)));
    }
    boxes.push_back(box);
  }
  return boxes;
}

}  // namespace

double MeshMessage::longest_side() const {
  return (nodes.rowwise().maxCoeff() - nodes.rowwise().minCoeff()).maxCoeff();
}

MeshMessage mesh_of(const shape_mesh_t& whole) {
  MeshMessage mesh;
  mesh.hash = whole.mesh_hash;
  mesh.element_kind = whole.element_kind;
  mesh.nodes = Eigen::Matrix3Xf::Map(whole.rest_xyz.data(), 3, whole.node_count).cast<double>();
  mesh.elements =
      Eigen::MatrixXi::Map(whole.elements.data(), whole.element_size,
                           static_cast<Eigen::Index>(whole.elements.size()) / whole.element_size);
  mesh.triangles = Eigen::Matrix3Xi::Map(whole.triangles.data(), 3,
                                         static_cast<Eigen::Index>(whole.triangles.size()) / 3);
  mesh.constrained = whole.constrained;
  return mesh;
}

MeshMessage assemble(const std::vector<shape_mesh_t>& chunks) {
  bus::MeshAssembler assembler;
  for (const shape_mesh_t& chunk : chunks)
    if (assembler.add(chunk)) return mesh_of(*assembler.find(chunk.mesh_hash));
  throw std::runtime_error("the log holds no complete mesh (" + std::to_string(chunks.size()) +
                           " chunks, " + std::to_string(assembler.rejected()) +
                           " of them inconsistent)");
}

Eigen::Matrix3Xd transformed(const math::Pose& X_AB, const Eigen::Matrix3Xd& points) {
  return (X_AB.linear() * points).colwise() + X_AB.translation();
}

Eigen::Matrix3Xd positions(const shape_t& shape) {
  return Eigen::Map<const Eigen::Matrix3Xf>(shape.xyz.data(), 3, shape.xyz_count / 3)
      .cast<double>();
}

PlantPoints::PlantPoints(const MeshMessage& plant, const Eigen::Matrix3Xd& rest_points)
    : nodes_(plant.elements.rows(), rest_points.cols()),
      weights_(plant.elements.rows(), rest_points.cols()) {
  if (plant.element_kind == shape_mesh_t::QUADRATIC_HEXAHEDRA &&
      plant.elements.rows() == kHexahedronNodes) {
    place_in_boxes(plant, rest_points);
  } else if (plant.element_kind == shape_mesh_t::LINEAR_TETRAHEDRA &&
             plant.elements.rows() == kTetrahedronNodes) {
    place_in_tetrahedra(plant, rest_points);
  } else {
    throw std::runtime_error(
        "the plant's mesh is neither one of 27-node hexahedra nor of linear tetrahedra");
  }
}

void PlantPoints::place_in_tetrahedra(const MeshMessage& plant,
                                      const Eigen::Matrix3Xd& rest_points) {
  mesh::ElementMesh tetrahedra;
  tetrahedra.corner_count = static_cast<int>(plant.nodes.cols());
  tetrahedra.nodes = plant.nodes;
  tetrahedra.elements = plant.elements;
  const mesh::PointLocator locator(tetrahedra);
  for (int p = 0; p < rest_points.cols(); ++p) {
    const mesh::PointWeights found = locator.locate(rest_points.col(p));
    for (int i = 0; i < kTetrahedronNodes; ++i) {
      nodes_(i, p) = found.nodes[i];
      weights_(i, p) = found.weights[i];
    }
  }
}

void PlantPoints::place_in_boxes(const MeshMessage& plant, const Eigen::Matrix3Xd& rest_points) {
  const std::vector<RestBox> boxes = rest_boxes(plant);
  for (int p = 0; p < rest_points.cols(); ++p) {
    const Eigen::Vector3d point = rest_points.col(p);
    const auto nearest =
        std::min_element(boxes.begin(), boxes.end(), [&point](const RestBox& a, const RestBox& b) {
          return a.distance(point) < b.distance(point);
        });
    const int element = static_cast<int>(nearest - boxes.begin());
    const Eigen::Array3d size = (nearest->upper - nearest->lower).array();
    const Eigen::Array3d s = (point - nearest->lower).array() / size;
    nodes_.col(p) = plant.elements.col(element);
    for (int i = 0; i < kHexahedronNodes; ++i) {
      const Eigen::Array3d node = (plant.nodes.col(nodes_(i, p)) - nearest->lower).array() / size;
      weights_(i, p) =
          lagrange(node.x(), s.x()) * lagrange(node.y(), s.y()) * lagrange(node.z(), s.z());
    }
  }
}

Eigen::Matrix3Xd PlantPoints::at(const Eigen::Matrix3Xd& plant_positions) const {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, nodes_.cols());
  for (int p = 0; p < nodes_.cols(); ++p)
    for (int i = 0; i < nodes_.rows(); ++i)
      points.col(p) += weights_(i, p) * plant_positions.col(nodes_(i, p));
  return points;
}

PlantMotion::PlantMotion(const std::vector<shape_t>& truths) : truths_(&truths) {}

bool PlantMotion::at(std::int64_t utime, Eigen::Matrix3Xd& plant_positions) const {
  const auto after =
      std::lower_bound(truths_->begin(), truths_->end(), utime,
                       [](const shape_t& shape, std::int64_t time) { return shape.utime < time; });
  if (after == truths_->end()) return false;
  if (after->utime == utime) {
    plant_positions = positions(*after);
    return true;
  }
  if (after == truths_->begin()) return false;
  const auto before = after - 1;
  const double s = static_cast<double>(utime - before->utime) /
                   static_cast<double>(after->utime - before->utime);
  plant_positions = (1 - s) * positions(*before) + s * positions(*after);
  return true;
}

}  // namespace palpate::log
