#pragma once

#include <vector>

#include "core/elasticity/element.hpp"
#include "core/elasticity/point_kernel.hpp"

namespace palpate::elasticity {

/// All elements of a body of one material, linear or quadratic, in one contiguous piece. Positions
/// x and forces are 3 x n, in O. Constant after construction, so threads may share it; what changes
/// from one evaluation to the next is in a State.
class ElementSet {
 public:
  using State = std::vector<PointState>;

  /// Throws std::invalid_argument where an element has no positive volume.
  ElementSet(const mesh::ElementMesh& mesh, const Material& material);

  int element_count() const { return static_cast<int>(mesh_.element_count()); }
  int nodes_per_element() const { return mesh_.nodes_per_element(); }
  const mesh::ElementMesh& mesh() const { return mesh_; }
  double volume() const { return volume_; }  // m^3, at rest

  /// State of the rest shape.
  State make_state() const { return State(quadratic_.size() + linear_.size()); }

  /// Adds dEnergy/dx (N: the force that the nodes must be given from outside) to `forces` and
  /// returns the energy in J. `viscous` > 0 adds the potential of Rayleigh damping since
  /// begin_step: stiffness factor over time step.
  double add_forces(const Eigen::Matrix3Xd& x, double viscous, State& state,
                    Eigen::Matrix3Xd& forces) const noexcept;

  /// Stretches of the last evaluation become those at the beginning of a step.
  static void begin_step(State& state) noexcept;

  /// Symmetric tangent of one element, 3 N x 3 N, plus `viscous` times its warped stiffness.
  void stiffness(int element, const Eigen::Matrix3Xd& x, Tangent kind, double viscous,
                 Eigen::MatrixXd& K) const;

  /// Consistent mass of one element, N x N, kg (one for all three axes).
  void mass(int element, Eigen::MatrixXd& M) const;

  /// Integral of the shape function of each node times the density, kg: times g the body force.
  const Eigen::VectorXd& nodal_mass() const { return nodal_mass_; }

 private:
  struct QuadraticBlock {
    std::array<int, 10> nodes;
    std::array<Lanes, 27> gradients;  // 9 nodes x 3 axes; node 0 takes what is left
    Lanes weight;                     // m^3
  };
  struct LinearBlock {
    std::array<std::array<int, 4>, 4> nodes;  // of each of four elements
    std::array<Lanes, 9> gradients;
    Lanes weight;
  };

  template <class Block>
  double add_block_forces(const std::vector<Block>& blocks, const Eigen::Matrix3Xd& x,
                          double viscous, State& state, Eigen::Matrix3Xd& forces) const noexcept;
  static void deformation(const QuadraticBlock& b, const Eigen::Matrix3Xd& x, LaneMatrix& F);
  static void deformation(const LinearBlock& b, const Eigen::Matrix3Xd& x, LaneMatrix& F);
  static void scatter(const QuadraticBlock& b, const LaneMatrix& P, Eigen::Matrix3Xd& forces);
  static void scatter(const LinearBlock& b, const LaneMatrix& P, Eigen::Matrix3Xd& forces);

  template <int kNodes>
  void element_stiffness(int element, const Eigen::Matrix3Xd& x, Tangent kind, double viscous,
                         Eigen::MatrixXd& K) const;
  Eigen::Matrix<double, 3, 4> rest_corners(int element) const;

  mesh::ElementMesh mesh_;
  Lame lame_;
  double density_ = 0;
  double volume_ = 0;
  Eigen::VectorXd nodal_mass_;
  std::vector<QuadraticBlock> quadratic_;
  std::vector<LinearBlock> linear_;
};

}  // namespace palpate::elasticity
