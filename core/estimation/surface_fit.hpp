#pragma once

#include "core/contact/surface_edges.hpp"
#include "core/estimation/estimator.hpp"
#include "core/estimation/patch_motion.hpp"
#include "core/estimation/shape_history.hpp"
#include "core/estimation/virtual_loads.hpp"

namespace palpate::estimation {

/// Turns points that were seen on the surface, nobody knows where on it, into what they tell of the
/// states that the shape follows: the sum over points of h h^T / s^2 and h z / s^2, where h is the
/// derivative by the states of the surface's motion along its normal at the nearest point, z what
/// is measured of h x and s the deviation (point to plane, Chen and Medioni 1992). The work of one
/// message is spread over ticks. Nothing allocates after construction.
class SurfaceFit {
 public:
  struct Options {
    double lag = 0.064;            // s, from when points are seen until they arrive
    double lag_deviation = 0.005;  // s: what moves is seen less exactly
    /// m, what mesh and calibration may be wrong by at a place. It is the same for all points near
    /// it, a `places`-th of them, and for about `correlation` seconds, so that neither more points
    /// nor more messages tell more of it. The correlation must be long: where the points tell
    /// little, as of motion along the surface, what repeats itself would be believed in the end.
    double surface = 5e-4;
    /// Beside an edge the noise of the points themselves is such an error: it decides of which side
    /// a point is taken to be, and who thins a cloud chooses among both sides.
    double beside = 1.5;  // in distances between points seen
    /// Nearer than this to an edge, in deviations of the points, their noise has a mean: a point
    /// outside of a convex edge is off along some normal whichever side it is taken to be of, 0.6
    /// deviations at a right angle. Such points are left out, unless most are such.
    double edge = 2;
    int places = 20;
    double correlation = 3;  // s
    double gate = 3;         // deviations: points beyond are of something else, a hand or a table,
    double reach = 0.02;     // m: and beyond this, whatever else is uncertain
    int points_per_tick = 16;
  };
  struct Information {
    WrenchFilter::ShapeMatrix matrix;
    WrenchFilter::ShapeState vector;
    int used = 0;      // points
    int rejected = 0;  // of something else
  };
  /// What the derivatives follow from.
  struct Basis {
    const elasticity::Sensitivity* sensitivity = nullptr;
    std::array<bool, 2> held{};
    const PatchMotion* motion = nullptr;
    const WrenchFilter* filter = nullptr;
  };

  /// Throws std::invalid_argument where an option is out of range.
  /// `rest`: nodes, 3 x n, m.
  SurfaceFit(const Eigen::Matrix3Xd& rest, const mesh::Surface& surface, const Options& options);

  void reset() noexcept;
  /// A new message; what was left of the one before is dropped. False where nothing is known of the
  /// shape when it was seen.
  bool begin(const ObservationInput& seen, const ShapeHistory& history) noexcept;
  bool is_busy() const noexcept { return next_ < points_.cols(); }
  /// The next points. True when these were the last: then information() is whole.
  bool advance(const Basis& basis, double dt) noexcept;
  /// Each tick in which there is nothing to do.
  void wait(double dt) noexcept { since_ += dt; }
  const Information& information() const noexcept { return information_; }

  using NodeRows = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, WrenchFilter::kMostShape>;
  /// Adds a share of the derivative of a node's position by the patches' motions, log E and virtual
  /// loads, 3 x shape_size(): times PatchMotion::by_state() it is that by the states.
  static void add_node(const Basis& basis, int node, double weight, NodeRows& rows) noexcept;

 private:
  void take(const Eigen::Vector3d& p, const Basis& basis) noexcept;
  void close_message() noexcept;

  Options options_;
  contact::SurfaceMatcher matcher_;
  contact::SurfaceEdges edges_;
  ShapeHistory::Moment moment_;
  ObservationInput::Points points_;
  Eigen::Index next_ = 0;
  double deviation_ = 0;
  double since_ = 0;     // s, from the beginning of the last message
  double interval_ = 0;  // s, between messages
  double beside_ = 0;    // m, from an edge
  double alike_ = 1;     // readings of the same error while it lasts
  double scale_ = -1;  // m, robust deviation of the last message's residuals; below zero: none yet
  std::array<double, ObservationInput::kMostPoints> residuals_{};
  int residual_count_ = 0;
  int edge_count_ = 0;         // of this message, nearer to an edge than Options::edge
  bool spares_edges_ = false;  // they are left out: most of the last message were not
  NodeRows rows_;
  Information information_;
};

}  // namespace palpate::estimation
