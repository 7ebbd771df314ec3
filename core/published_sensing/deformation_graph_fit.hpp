#pragma once

#include "core/published_sensing/cloud_estimator.hpp"
#include "core/published_sensing/deformation_graph.hpp"

namespace palpate::published_sensing {

/// A reference shape that a deformation graph lays over each cloud: T. Han, X. Zhao, P. Sun and
/// J. Pan, "Robust shape estimation for 3D deformable object manipulation", 2018 (thesis [42]).
///
/// Consumes: vision, mesh, clamp. No material, not the hand's pose. No probes.
/// Kept: tracking without a model of the material: nodes of a graph, each with a rotation and a
/// translation, that blend over the surface; one step of Gauss and Newton a cloud over distances of
/// points along the normal and edges that are to stay as rigid as possible; what is not seen goes
/// along with its neighbours.
/// Left out: the other half, the reference's upgrade from depth pictures by a signed distance
/// function, for which a cloud of at most 256 points is too thin: the reference is the mesh, which
/// is asked to stay where it is clamped. With it segmentation and the rejection of points by
/// colour. Written from summaries of the work.
class DeformationGraphFit final : public CloudEstimator {
 public:
  static constexpr int kMostNodes = 20;  // of the graph

  struct Options : CloudEstimator::Options {
    int nodes = 16;           // of the graph, 4 to kMostNodes
    double deviation = 2e-3;  // m, of a point from the surface
    double rigidity = 2e-3;   // m, by which the end of an edge of the graph may be missed
    double memory = 1;        // of the last shape, as so many points seen at each node; >= 0
  };

  /// Throws std::invalid_argument where an option is out of range.
  DeformationGraphFit(const elasticity::Body& body, const mesh::Surface& surface,
                      const Options& options);

 private:
  static constexpr int kMost = 6 * kMostNodes;  // turn and shift of each node
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1>;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMost, kMost>;

  void begin(const Eigen::Matrix3Xd& positions) noexcept override;
  void take(elasticity::DeformationModel& model) noexcept override;
  elasticity::StepReport advance(double dt, const estimation::EstimationInputs& inputs,
                                 elasticity::DeformationModel& model) noexcept override;
  /// Into the row: how far a node of the mesh moves along n, `weight` times.
  void add_slope(int mesh_node, double weight, const Eigen::Vector3d& n) noexcept;
  /// Takes the row, whose residual is to become zero, into the normal equations and empties it.
  void close_row(double residual) noexcept;
  void add_points() noexcept;
  void add_edges() noexcept;
  void add_clamp() noexcept;
  void add_memory() noexcept;

  Options options_;
  DeformationGraph graph_;
  Eigen::Matrix3Xd rest_, shape_;  // of the mesh, m
  std::vector<int> fixed_;         // nodes of the mesh
  Vector row_, vector_;
  Square information_;
};

}  // namespace palpate::published_sensing
