#pragma once

#include "core/contact/surface_match.hpp"
#include "core/estimation/estimator.hpp"
#include "core/estimation/step_watch.hpp"

namespace palpate::published_sensing {

/// A Gaussian process over places of a surface, of the logarithm of how far each gives way by a
/// newton: mean 0 about `mean`, squared-exponential kernel. Room for a fixed number of touches.
class ComplianceProcess {
 public:
  static constexpr int kMost = 48;
  struct Options {
    double length = 0.03;  // m, over which compliance is alike
    double deviation = 1;  // of its logarithm, prior
    double noise = 0.15;   // of the logarithm of one touch
    double mean = 1e-3;    // m/N, prior
  };
  struct Prediction {
    double compliance = 0;  // m/N, the median
    double deviation = 0;   // of its logarithm
  };

  /// Throws std::invalid_argument where an option is not positive.
  explicit ComplianceProcess(const Options& options);
  void clear() noexcept { count_ = 0; }
  int count() const noexcept { return count_; }
  /// A touch at `place` (rest, m) that found `compliance` (m/N, > 0). Where the room is full, or
  /// one was felt within a tenth of the kernel's length, the nearest one is replaced by the mean of
  /// both.
  void add(const Eigen::Vector3d& place, double compliance) noexcept;
  Prediction at(const Eigen::Vector3d& place) const noexcept;
  /// Of `places`, 3 x n, the one that is known least: where to touch next.
  Eigen::Index least_known(const Eigen::Matrix3Xd& places) const noexcept;

 private:
  using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1>;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMost, kMost>;
  double kernel(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const noexcept;
  void factor() noexcept;

  Options options_;
  std::array<Eigen::Vector3d, kMost> places_;
  std::array<double, kMost> values_{};
  int count_ = 0;
  Square lower_;    // Cholesky factor of the kernel's matrix with noise
  Column weights_;  // its inverse times the values
};

/// A map of how a surface gives way: S. Caccamo, P. Gueler, H. Kjellstroem and D. Kragic, "Active
/// perception and modeling of deformable surfaces using Gaussian processes and position-based
/// dynamics", Humanoids 2016 (thesis [35]).
///
/// Consumes: force and place of touches by fingertips (or by hand), which are its probes; mesh. No
/// camera here (see below), no material.
/// Kept: each touch gives a local deformability; a Gaussian process over the surface interpolates
/// it and says where it is known least, which is where to touch next; the map predicts how the
/// surface deforms under a further touch.
/// Left out: the RGB-D camera that gives the paper its surface (the mesh at rest is known here);
/// position-based dynamics, whose parameter the paper fits at each touch: here a touch gives way by
/// its compliance, and the surface about it by a Gaussian as wide as `footprint`. The choice of the
/// next touch is told, not made: the robot belongs to the controller.
class ComplianceMap final : public estimation::Estimator {
 public:
  struct Options {
    ComplianceProcess::Options process;
    double footprint = 0.015;  // m
    double least_force = 0.1;  // N, below which a touch tells nothing
    double every = 0.1;        // s, between two of a touch
  };

  /// Throws std::invalid_argument where an option is not positive.
  ComplianceMap(const elasticity::Body& body, const mesh::Surface& surface, const Options& options);

  const ComplianceProcess& process() const noexcept { return process_; }

  void activate(elasticity::DeformationModel& model) noexcept override;
  sensing::UpdateResult update(const estimation::EstimationInputs& inputs,
                               elasticity::DeformationModel& model,
                               estimation::Estimate& estimate) noexcept override;
  void reset() noexcept override;

 private:
  Options options_;
  ComplianceProcess process_;
  contact::SurfaceMatcher matcher_;
  Eigen::Matrix3Xd rest_, shape_, still_;
  std::vector<int> fixed_;
  double since_ = 0;  // s
  estimation::StepGuard step_guard_;
};

}  // namespace palpate::published_sensing
