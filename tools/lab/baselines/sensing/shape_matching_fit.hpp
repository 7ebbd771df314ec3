#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "tools/lab/baselines/sensing/cloud_estimator.hpp"

namespace palpate::baselines {

/// Position-based dynamics with one fitted parameter: P. Gueler, K. Pauwels, A. Pieropan, H.
/// Kjellstroem and D. Kragic, "Estimating the deformability of elastic materials using optical flow
/// and position-based dynamics", Humanoids 2015; the same with ground truth from finite elements,
/// IROS 2017 (Sanchez 2019, Table 2.1 [34], [39]).
///
/// Consumes: vision, pose of the hand (in the papers the contact point of the manipulator), mesh,
/// clamp. No material. No dedicated probing motions: the motion of the hand is the experiment.
/// Kept: meshless shape matching, goal (beta A + (1 - beta) R) q + t with A the best linear map and
/// R the best rotation, as its only mechanics; grasped material is prescribed; the deformability
/// beta minimises the distance between predicted and observed shape. Left out: optical flow, from
/// which the papers obtain their points (the input consists of points, not pixels); here points are
/// compared with the predicted surface along its normal. The search over beta runs concurrently on
/// equally spaced candidates, and the recently best one is reported. Regions: slabs along the
/// longest side, each overlapping its neighbours by half (the papers: one or a few).
class ShapeMatchingFit final : public CloudEstimator {
 public:
  struct Options : CloudEstimator::Options {
    Options() { hand = true; }
    int regions = 6;
    int candidates = 5;  // values of beta, from 0 to 0.98
    int iterations = 2;  // iterations of all regions per tick
    /// Fraction of the distance to its goals by which a node moves per iteration.
    double rigidity = 0.9;
    double memory = 1;  // s, averaging time of the compared distances
  };

  /// Throws std::invalid_argument if an option is out of range.
  ShapeMatchingFit(const elasticity::Body& body, const mesh::Surface& surface,
                   const Options& options);

  double deformability() const noexcept { return candidates_[best_].beta; }

 private:
  struct Member {
    int node;
    double weight;         // weight of the region among those of the node
    Eigen::Vector3d rest;  // m, relative to the region's centre
  };
  struct Region {
    std::vector<Member> members;
    Eigen::Matrix3d inverse_moment;  // 1/m^2
  };
  struct Candidate {
    double beta = 0;
    double squared = 0;  // m^2, recent mean
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
  double since_ = 0;  // s, since the last cloud
  Eigen::Matrix3Xd rest_, goal_;
  std::vector<int> fixed_;
};

}  // namespace palpate::baselines
