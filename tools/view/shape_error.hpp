#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <palpate/shape_mesh_t.hpp>
#include <palpate/shape_t.hpp>

#include "tools/log/plant_truth.hpp"

namespace palpate::view {

/// Compares shapes with the true positions of their nodes' material, interpolated between the two
/// truths around a shape's time. Ground truth is published only by a simulator.
class ShapeError {
 public:
  struct Distances {  // of the nodes, m
    double mean, rms, largest;
    /// The senders' clocks differ: compared with the truth that was received last.
    bool by_arrival;
  };

  /// The last shape and truth received, each of its mesh; the same ones again have no effect.
  void take(const shape_mesh_t& mesh, const shape_t& shape, const shape_mesh_t& truth_mesh,
            const shape_t& truth);
  /// Of the last shape for which the truth is known; empty before.
  const std::optional<Distances>& last() const { return last_; }

 private:
  struct Moment {
    std::int64_t session, utime;
    Eigen::Matrix3Xd nodes;  // of the estimate's mesh, m, in O
  };
  void set_meshes(const shape_mesh_t& mesh, const shape_mesh_t& truth_mesh);
  void compare(const Moment& shape, double part);

  std::int64_t hash_ = 0, truth_hash_ = 0;
  std::optional<log::PlantPoints> points_;  // empty: not comparable
  std::deque<Moment> waiting_;              // shapes that are newer than the last truth
  std::optional<Moment> before_, after_;    // the last two truths
  std::optional<Distances> last_;
};

}  // namespace palpate::view
