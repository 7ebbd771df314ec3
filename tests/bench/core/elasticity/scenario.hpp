#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/elasticity/corotational_model.hpp"
#include "tests/support/refactor.hpp"

namespace palpate::bench {

/// A bar of 0.20 x 0.05 x 0.05 m, divided into cells along x, y, z and each cell into six
/// tetrahedra.
struct BarMesh {
  mesh::ElementOrder order = mesh::ElementOrder::kQuadratic;
  std::array<int, 3> cells{9, 2, 2};

  int node_count() const;
  std::string text() const;  // e.g. "quadratic 475"
};

/// The sizes for which figures are quoted, by ascending node count.
std::vector<BarMesh> bar_meshes(mesh::ElementOrder order);
/// The one of `nodes` nodes; throws std::invalid_argument naming the available sizes.
BarMesh bar_of(mesh::ElementOrder order, int nodes);

/// Motion and load of the bar, whose end x = 0 is a grasped patch and whose end x = L bears a
/// uniform traction of resultant F. Forces are for E = 1e5 Pa and scale with E.
enum class Motion {
  kStep,   // S: F = 0.1 N at once, the clamp stays
  kLarge,  // L: F = 1 N rotates at 1 Hz; the clamp swings by 60 degrees about two axes and moves by
           // 50 mm
  kBend,   // B: F = 2 N within 50 ms, the clamp stays
};
/// "S", "L" or "B".
Motion motion_of(const std::string& letter);
std::string letter_of(Motion motion);

enum class Mechanics { kDynamic, kQuasistatic };

class Scenario {
 public:
  /// `law`: of elasticity::stretch_laws(), with plausible constants; empty: the linear law.
  Scenario(const BarMesh& mesh, Motion motion, double young_modulus = 1e5,
           const std::string& law = "");

  /// Nothing fixed; grasp 0 is the clamp.
  const elasticity::Body& body() const { return body_; }

  math::Pose clamp_pose(double t) const;      // X_OG, t in s
  Eigen::Vector3d tip_force(double t) const;  // N
  /// Holds the clamp and sets the loads of time t, without allocation.
  void apply(double t, elasticity::DeformationModel& model) const;

 private:
  Motion motion_;
  double force_scale_;
  elasticity::Body body_;
  Eigen::VectorXd tip_shares_;  // of the traction, by node; they sum to 1
};

/// Prepared, with its clamp held and the factorisation for that installed.
std::unique_ptr<elasticity::CorotationalModel> make_model(const elasticity::Body& body,
                                                          Mechanics mechanics,
                                                          const elasticity::SolverOptions& options);

}  // namespace palpate::bench
