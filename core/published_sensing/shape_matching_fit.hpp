#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "core/published_sensing/cloud_estimator.hpp"

namespace palpate::published_sensing {

/// Position-based dynamics with one fitted parameter: P. Gueler, K. Pauwels, A. Pieropan,
/// H. Kjellstroem and D. Kragic, "Estimating the deformability of elastic materials using optical
/// flow and position-based dynamics", Humanoids 2015; the same with ground truth from finite
/// elements, IROS 2017 (thesis [34], [39]).
///
/// Consumes: vision, the hand's pose (the papers know where the manipulator touches), mesh, clamp.
/// No material. No probes of its own: what the hand does anyway is the experiment.
/// Kept: meshless shape matching, goal (beta A + (1 - beta) R) q + t with A the best linear and R
/// the best rotation, as its only mechanics; material that the hand holds is prescribed; the
/// deformability beta is the one under which the predicted shape is nearest to what is seen.
/// Left out: optical flow (the port gives points, not pixels), by which the papers get their
/// points; instead points compare with the predicted surface along its normal. The search over beta
/// runs as equally spaced candidates beside each other, and the best of late is told. Regions:
/// slabs along the longest side, each overlapping its neighbours by half (the papers: one or a
/// few).
class ShapeMatchingFit final : public CloudEstimator {
 public:
  struct Options : CloudEstimator::Options {
    Options() { hand = true; }
    int regions = 6;
    int candidates = 5;     // of beta, from 0 to 0.98
    int iterations = 2;     // of all regions in a tick
    double rigidity = 0.9;  // share of the way to its goals that a node goes in an iteration
    double memory = 1;      // s, over which distances are compared
  };

  /// Throws std::invalid_argument where an option is out of range.
  ShapeMatchingFit(const elasticity::Body& body, const mesh::Surface& surface,
                   const Options& options);

  double deformability() const noexcept { return candidates_[best_].beta; }

 private:
  struct Member {
    int node;
    double weight;         // of the region's among those of the node
    Eigen::Vector3d rest;  // from the region's centre, m
  };
  struct Region {
    std::vector<Member> members;
    Eigen::Matrix3d inverse_moment;  // 1/m^2
  };
  struct Candidate {
    double beta = 0;
    double squared = 0;  // m^2, mean of late
    Eigen::Matrix3Xd x;
    std::vector<Eigen::Quaterniond> rotations;
  };
  void begin(const Eigen::Matrix3Xd& positions) noexcept override;
  void take(elasticity::DeformationModel& model) noexcept override;
  elasticity::StepReport advance(double dt, const estimation::EstimationInputs& inputs,
                                 elasticity::DeformationModel& model) noexcept override;
  void match(Candidate& candidate) noexcept;

  Options options_;
  std::vector<Region> regions_;
  std::vector<Candidate> candidates_;
  int best_ = 0;
  double since_ = 0;  // s, from the last cloud
  Eigen::Matrix3Xd rest_, goal_;
  std::vector<int> fixed_;
};

}  // namespace palpate::published_sensing
