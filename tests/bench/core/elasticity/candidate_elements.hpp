#pragma once

#include <vector>

#include "core/elasticity/element.hpp"
#include "core/factor/block_matrix.hpp"

namespace palpate::bench {

/// Averaging of the strain tr(R^T F - I) in the volumetric part of the energy.
enum class Volumetric {
  kAtPoints,  // each quadrature point separately: the elements of the product
  kAveraged,  // means over the elements around each node, weighted by a quarter of each element's
              // volume (averaged nodal pressure, Bonet and Burton 1998), separately for each
              // material
};

/// Elements under study, written for plainness and not for speed. Geometry is isoparametric, so
/// that quadratic elements are curved where their midside nodes stand off the straight edge. With
/// pressure groups g of volume V_g, to which point p gives the share s_gp of its volume w_p,
///   E = sum_p w_p mu |R^T F - I|^2 + sum_g V_g lambda / 2 t_g^2,  t_g = sum_p s_gp t_p / V_g,
/// t_p = tr(R^T F - I); elements of the product have one group for each point.
class CandidateElements {
 public:
  /// Throws std::invalid_argument if a quadrature point has no positive volume.
  CandidateElements(const elasticity::Body& body, Volumetric volumetric);

  /// Energy (J) at positions x (3 x n); its derivative into `forces` (N).
  double evaluate(const Eigen::Matrix3Xd& x, Eigen::Matrix3Xd& forces);

  /// Adds the second derivative of the energy at the last positions to a matrix over stencils().
  /// Unless `exact`, negative eigenvalues are removed.
  void add_tangent(bool exact, factor::BlockMatrix& matrix) const;

  /// Coupled nodes, one column each; short ones repeat their first node.
  const Eigen::MatrixXi& stencils() const { return stencils_; }
  double volume() const;  // m^3

 private:
  struct Point {
    int element, stencil;
    double weight;               // m^3
    Eigen::Matrix3Xd gradients;  // 1/m
    elasticity::Lame lame;
    // At the last positions:
    Eigen::Matrix3d F;
    Eigen::Matrix3Xd h;   // rotated gradients, the derivative of the trace
    double trace = 0;     // of R^T F - I
    double pressure = 0;  // Pa, mean of lambda t over its groups
  };
  struct Member {
    int point;
    double share;  // m^3
  };
  struct Group {
    std::vector<Member> members;
    double volume = 0, lambda = 0, trace = 0;
    int stencil = 0;
  };

  void add_points(const elasticity::Body& body);
  void group_by_point();
  void group_by_node();

  Eigen::MatrixXi elements_, stencils_;
  std::vector<Point> points_;
  std::vector<Group> groups_;
};

}  // namespace palpate::bench
