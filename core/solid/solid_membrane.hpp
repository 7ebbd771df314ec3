#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <array>
#include <memory>
#include <vector>

namespace palpate::solid {

/// Parameters of a membrane, indices of a parameter vector. Stress is per length of the membrane's
/// edge, because the thickness is not identifiable separately.
enum MembraneParameter {
  kShear,       // N/m: shear modulus times thickness, at zero strain
  kStiffening,  // b of W = shear / (2 b) (exp(b (I1 - 3)) - 1) (Fung; Demiray 1972)
  kFibre,       // N/m: stiffness of embedded fibres, energy fibre / 8 (I4 - 1)^2, I4 = |F a|^2
  kAngle,       // rad, from x towards y: direction a of the fibres
  kFoundation,  // N/m^3: tangential traction of the supporting foundation per displacement u
  kGrip,        // m: the traction is foundation u / sqrt(1 + u^2 / grip^2), which saturates
  kMembraneParameters,
};
using MembraneVector = Eigen::Matrix<double, kMembraneParameters, 1>;

/// Stress and tangent with respect to F (2 x 2), column by column, per length.
struct MembraneResponse {
  double energy = 0;
  Eigen::Matrix2d stress;
  Eigen::Matrix4d tangent;
  Eigen::Matrix<double, 4, kMembraneParameters> by_parameter;  // derivative of the stress
};

/// Plane stress of an incompressible solid, I1 = tr C + 1 / det C at F. False if det F is not
/// positive.
bool membrane_response(const Eigen::Matrix2d& F, const MembraneVector& p,
                       MembraneResponse& response);

/// Rectangle with axis-parallel sides, m.
struct Rectangle {
  Eigen::Vector2d least, greatest;
};

/// Rectangular membrane of nine-node elements at large strain with a fixed outer edge and rigid
/// pads bonded to it. Constant after construction, therefore shareable between threads. Offline.
class SolidMembrane {
 public:
  /// Grid lines along x and y, m, ascending; they must include the edges of the pads. Throws
  /// std::invalid_argument.
  SolidMembrane(std::vector<double> x, std::vector<double> y, std::vector<Rectangle> pads);

  /// Node displacements, and their derivatives by parameter (x and y of each node in succession).
  struct State {
    Eigen::VectorXd u;  // m; empty: zero
    Eigen::Matrix<double, Eigen::Dynamic, kMembraneParameters> slopes;
    std::vector<Eigen::Vector2d> forces;  // N, force on the membrane, by pad
    std::vector<Eigen::Matrix<double, 2, kMembraneParameters>> force_slopes;
  };

  /// Equilibrium with the pads displaced by `motions`, starting from state.u, in several steps if
  /// one fails; with derivatives on request. False if none is found.
  bool solve(const MembraneVector& p, const std::vector<Eigen::Vector2d>& motions, State& state,
             bool with_slopes) const;

  /// Point of the membrane at rest as a weighted sum of nodes. Throws std::invalid_argument if
  /// outside.
  struct Place {
    std::array<int, 9> nodes;
    std::array<double, 9> weights;
  };
  Place locate(const Eigen::Vector2d& point) const;

  int node_count() const { return static_cast<int>(rest_.cols()); }

 private:
  using Strain = Eigen::Matrix<double, 4, 18>;
  struct Point {
    Strain strain;
    Eigen::Matrix<double, 9, 1> shape;
    double area = 0;
  };
  struct Element {
    std::array<int, 9> nodes;
    std::array<Point, 9> points;
  };
  struct System;

  bool press_on(const MembraneVector& p, const std::vector<Eigen::Vector2d>& motions, State& state,
                bool with_slopes) const;
  double evaluate(const Eigen::VectorXd& u, const MembraneVector& p, System& system,
                  bool with_tangent, bool with_slopes) const;

  std::vector<double> x_, y_;
  int across_ = 0, size_ = 0;
  Eigen::Matrix2Xd rest_;
  std::vector<int> unknown_, pad_;  // by coordinate: -1 if prescribed; by node: -1 if on no pad
  int pad_count_ = 0;
  std::vector<Element> elements_;
};

}  // namespace palpate::solid
