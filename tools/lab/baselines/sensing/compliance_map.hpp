#pragma once

#include "core/contact/surface_match.hpp"
#include "tools/lab/baselines/learning/shape_predictor.hpp"

namespace palpate::baselines {

/// Gaussian process over surface points for the logarithm of the local compliance: mean
/// log(`mean`), squared-exponential kernel. Fixed capacity of contacts.
class ComplianceProcess {
 public:
  static constexpr int kMost = 48;
  struct Options {
    double length = 0.03;  // m, correlation length of the compliance
    double deviation = 1;  // of the logarithm, prior standard deviation
    double noise = 0.15;   // of the logarithm of one contact's measurement
    double mean = 1e-3;    // m/N, prior
  };
  struct Prediction {
    double compliance = 0;  // m/N, the median
    double deviation = 0;   // standard deviation of its logarithm
  };

  /// Throws std::invalid_argument if an option is not positive.
  explicit ComplianceProcess(const Options& options);
  void clear() noexcept { count_ = 0; }
  int count() const noexcept { return count_; }
  /// Adds a contact at `place` (rest position, m) with measured `compliance` (m/N, > 0). If the
  /// capacity is reached, or a contact within a tenth of the kernel's length exists, the nearest
  /// one is replaced by the mean of both.
  void add(const Eigen::Vector3d& place, double compliance) noexcept;
  Prediction at(const Eigen::Vector3d& place) const noexcept;
  /// Column of `places`, 3 x n, with the largest uncertainty: the next contact point.
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
  Square lower_;    // Cholesky factor of the kernel matrix with noise
  Column weights_;  // inverse of that matrix times the values
};

/// Map of the compliance of a surface: S. Caccamo, P. Gueler, H. Kjellstroem and D. Kragic, "Active
/// perception and modeling of deformable surfaces using Gaussian processes and position-based
/// dynamics", Humanoids 2016 (Sanchez 2019, Table 2.1 [35]).
///
/// Consumes: force and location of contacts of fingertips (or by hand), which are its probing
/// motions; mesh. No camera here (see below), no material. Kept: each contact yields a local
/// compliance; a Gaussian process over the surface interpolates it and provides its uncertainty,
/// which determines the next contact point; the map predicts the deformation under a further
/// contact. Left out: the RGB-D camera that measures the surface in the paper (here the rest mesh
/// is known); position-based dynamics, whose parameter the paper fits at each contact: here a
/// contact yields by its compliance, and the surrounding surface by a Gaussian of width
/// `footprint`. The next contact point is reported, not approached: the controller commands the
/// robot.
class ComplianceMap final : public ShapePredictor {
 public:
  struct Options {
    ComplianceProcess::Options process;
    double footprint = 0.015;  // m
    double least_force = 0.1;  // N, minimum force of a usable contact
    double every = 0.1;        // s, between two measurements of a contact
  };

  /// Throws std::invalid_argument if an option is not positive.
  ComplianceMap(const elasticity::Body& body, const mesh::Surface& surface, const Options& options);

  const ComplianceProcess& process() const noexcept { return process_; }

  void reset() noexcept override;

 private:
  UpdateResult predict(const estimation::EstimationInputs& inputs, double step,
                       Eigen::Matrix3Xd& shape, estimation::Estimate& estimate) noexcept override;

  Options options_;
  ComplianceProcess process_;
  contact::SurfaceMatcher matcher_;
  std::vector<int> fixed_;
  double since_ = 0;  // s
};

}  // namespace palpate::baselines
