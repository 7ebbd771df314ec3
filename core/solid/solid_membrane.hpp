#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <array>
#include <memory>
#include <vector>

namespace palpate::solid {

/// What a membrane's behaviour depends on, by index of a parameter vector. Stress is per length of
/// the membrane's edge: thickness alone cannot be told.
enum MembraneParameter {
  kShear,       // N/m: shear modulus times thickness, at no strain
  kStiffening,  // b of W = shear / (2 b) (exp(b (I1 - 3)) - 1) (Fung; Demiray 1972)
  kFibre,       // N/m: fibres in it, which add fibre / 8 (I4 - 1)^2, I4 = |F a|^2
  kAngle,       // rad, from x towards y: their direction a
  kFoundation,  // N/m^3: pressure along the membrane of what it lies on, by its displacement u
  kGrip,        // m: that pressure is foundation u / sqrt(1 + u^2 / grip^2), which gives way
  kMembraneParameters,
};
using MembraneVector = Eigen::Matrix<double, kMembraneParameters, 1>;

/// Stress and tangent by F (2 x 2), column by column, per length.
struct MembraneResponse {
  double energy = 0;
  Eigen::Matrix2d stress;
  Eigen::Matrix4d tangent;
  Eigen::Matrix<double, 4, kMembraneParameters> by_parameter;  // of the stress
};

/// Plane stress of an incompressible solid, I1 = tr C + 1 / det C at F.
/// False where det F is not positive.
bool membrane_response(const Eigen::Matrix2d& F, const MembraneVector& p,
                       MembraneResponse& response);

/// Rectangle with sides along the axes, m.
struct Rectangle {
  Eigen::Vector2d least, greatest;
};

/// A rectangular membrane of nine-node elements at large strain whose outer edge is fixed, with
/// rigid pads stuck to it. Constant after construction: threads may share it. Off line.
class SolidMembrane {
 public:
  /// Lines of the grid along x and y, m, rising; edges of pads must be among them. Throws
  /// std::invalid_argument.
  SolidMembrane(std::vector<double> x, std::vector<double> y, std::vector<Rectangle> pads);

  /// Where nodes have gone, and by parameter (x and y of each node behind each other).
  struct State {
    Eigen::VectorXd u;  // m; empty: not moved yet
    Eigen::Matrix<double, Eigen::Dynamic, kMembraneParameters> slopes;
    std::vector<Eigen::Vector2d> forces;  // N, on the membrane, by pad
    std::vector<Eigen::Matrix<double, 2, kMembraneParameters>> force_slopes;
  };

  /// Equilibrium with the pads displaced by `motions`, found from state.u on, in several steps
  /// where one does not do; slopes are written where asked for. False where there is none.
  bool solve(const MembraneVector& p, const std::vector<Eigen::Vector2d>& motions, State& state,
             bool with_slopes) const;

  /// A point of the membrane at rest as a weighted sum of nodes. Throws std::invalid_argument
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
  std::vector<int> unknown_, pad_;  // by coordinate: -1 where given; by node: -1 where on none
  int pad_count_ = 0;
  std::vector<Element> elements_;
};

}  // namespace palpate::solid
