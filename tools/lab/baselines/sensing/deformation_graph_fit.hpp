#pragma once

#include "tools/lab/baselines/sensing/cloud_estimator.hpp"
#include "tools/lab/baselines/sensing/deformation_graph.hpp"

namespace palpate::baselines {

/// Reference shape fitted to each cloud by a deformation graph: T. Han, X. Zhao, P. Sun and J. Pan,
/// "Robust shape estimation for 3D deformable object manipulation", 2018 (Sanchez 2019, Table 2.1
/// [42]).
///
/// Consumes: vision, mesh, clamp. No material, no pose of the hand. No probing motions. Kept:
/// tracking without a material model: graph nodes, each with a rotation and a translation, blended
/// over the surface; one Gauss-Newton step per cloud on distances of points along the normal and on
/// edges that stay as rigid as possible; unobserved parts follow their neighbours. Left out: the
/// second half, the update of the reference from depth images by a signed distance function, for
/// which a cloud of at most 256 points is too sparse: the reference is the mesh, held at the clamp;
/// also segmentation and rejection of points by colour. Based on summaries of the work.
class DeformationGraphFit final : public CloudEstimator {
 public:
  static constexpr int kMostNodes = 20;  // graph nodes

  struct Options : CloudEstimator::Options {
    int nodes = 16;           // graph nodes, 4 to kMostNodes
    double deviation = 2e-3;  // m, standard deviation of a point's distance from the surface
    double rigidity = 2e-3;   // m, standard deviation of the end position of a graph edge
    double memory = 1;        // weight of the last shape in units of observed points per node; >= 0
  };

  /// Throws std::invalid_argument if an option is out of range.
  DeformationGraphFit(const elasticity::Body& body, const mesh::Surface& surface,
                      const Options& options);

 private:
  static constexpr int kMost = 6 * kMostNodes;  // rotation and translation of each node
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1>;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMost, kMost>;

  void begin(const Eigen::Matrix3Xd& positions) noexcept override;
  void take(elasticity::DeformationModel& model) noexcept override;
  elasticity::StepReport advance(double dt, const estimation::EstimationInputs& inputs,
                                 elasticity::DeformationModel& model) noexcept override;
  /// Adds to the row the derivative of the motion of a mesh node along n, times `weight`.
  void add_slope(int mesh_node, double weight, const Eigen::Vector3d& n) noexcept;
  /// Adds the row, with the given residual, to the normal equations and clears it.
  void close_row(double residual) noexcept;
  void add_points() noexcept;
  void add_edges() noexcept;
  void add_clamp() noexcept;
  void add_memory() noexcept;

  Options options_;
  DeformationGraph graph_;
  Eigen::Matrix3Xd rest_, shape_;  // mesh nodes, m
  std::vector<int> fixed_;         // mesh nodes
  Vector row_, vector_;
  Square information_;
};

}  // namespace palpate::baselines
