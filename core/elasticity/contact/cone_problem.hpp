#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/elasticity/contact/compliance_columns.hpp"

namespace palpate::elasticity {

/// Contact point of the cone problem. All vectors in the axes of its place in the table.
struct ConePoint {
  int place = 0;                                      // in the table of compliances
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit vector, out of the obstacle
  double friction = 0;
  /// m, without any change of force: along the normal the gap, across it the slip since the point
  /// stuck last.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N, on the object: first guess and result
};

struct ConeOptions {
  int sweeps = 30;          // maximum number
  double tolerance = 1e-8;  // m, largest displacement by the last change of a force
};

/// Signorini's and Coulomb's laws at many points of an elastic body: with the force r of each point
/// and the gap and slip e = offset + u, u = sum of compliances times changes of force,
///   0 <= r_n, 0 <= e_n, r_n e_n = 0,  |r_t| <= friction r_n,  e_t = 0 or r_t = -friction r_n
///   e_t / |e_t|.
/// Solved by block projected Gauss-Seidel (Jourdan, Alart and Jean 1998; Duriez et al. 2006): a
/// point that can stick takes the exact solution of its block, others project normal and tangential
/// force in turn, or, where friction times the coupling between these is too large for that, take
/// the exact solution as well (slip direction, Bonnefon and Daviet 2011). Sweeps run to and fro, so
/// that the order of the points matters less, and are combined as conjugate gradients
/// (Silcowitz-Hansen, Niebe and Erleben 2010). Because compliances weight errors of force by the
/// displacement that they cause, displacements converge much faster than the distribution of
/// forces. Nothing allocates after construction.
class ConeProblem {
 public:
  /// `most`: largest number of points.
  explicit ConeProblem(int most);

  /// To be called when compliances in the table have changed: those of the last points are kept for
  /// as long as the points are the same.
  void forget_compliances() noexcept { gathered_.clear(); }

  /// Changes the forces of `points`. Returns the number of sweeps.
  int solve(const ComplianceColumns& table, const ConeOptions& options,
            std::vector<ConePoint>& points) noexcept;

 private:
  /// What relaxing a point needs of its own compliance.
  struct Block {
    Eigen::Matrix3d own, inverse;
    double normal, tangential;  // m/N, along the normal; bound across it
    double coupling;            // motion across the normal over that along it, by a normal force
  };
  void gather(const ComplianceColumns& table, const std::vector<ConePoint>& points) noexcept;
  double sweep(std::vector<ConePoint>& points, bool forward) noexcept;
  double relax(int k, ConePoint& point) noexcept;
  static Eigen::Vector3d slide(const ConePoint& point, const Block& block,
                               Eigen::Vector3d error) noexcept;
  static bool slide_exactly(const ConePoint& point, const Block& block,
                            const Eigen::Vector3d& error, Eigen::Vector3d& force) noexcept;

  int size_ = 0;                  // three per point
  Eigen::MatrixXf compliance_;    // among the points
  Eigen::VectorXf displacement_;  // u by point
  // Of the last sweep: u before it and its change; N, forces before it and their change.
  Eigen::VectorXf displacement_before_;
  Eigen::VectorXd before_;
  // Conjugate direction, N, and the displacement along it.
  Eigen::VectorXd direction_;
  Eigen::VectorXf along_;
  std::vector<Block> blocks_;
  std::vector<int> gathered_;  // places of the points whose compliances are held
};

}  // namespace palpate::elasticity
