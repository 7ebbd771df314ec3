#pragma once

#include "core/contact/surface_match.hpp"
#include "core/estimation/estimator.hpp"
#include "core/estimation/patch_motion.hpp"
#include "core/estimation/shape_history.hpp"
#include "core/estimation/virtual_loads.hpp"

namespace palpate::estimation {

/// Converts observed surface points, whose correspondence to material points is unknown, into
/// information on the states that influence the shape: the sums over points of h h^T / s^2 and h z
/// / s^2, where h is the derivative of the surface's motion along its normal at the nearest point
/// with respect to the states, z the measurement of h x, and s the standard deviation
/// (point-to-plane distance, Chen and Medioni 1992). The work of one message is spread over several
/// ticks. Nothing allocates after construction.
class SurfaceFit {
 public:
  struct Options {
    double lag = 0.064;            // s, latency from acquisition to arrival of the points
    double lag_deviation = 0.005;  // s, its standard deviation: moving surfaces are weighted less
    /// m, standard deviation of the local error of mesh and calibration. It is common to all
    /// neighbouring points, one `places`-th of the total, for about `correlation` seconds, so that
    /// neither more points nor more messages reduce it. The correlation time must be long: in
    /// poorly observed directions, such as motion along the surface, a repeated error would
    /// otherwise be accepted eventually.
    double surface = 5e-4;
    /// Near an edge the noise of the points acts as such an error: it decides to which face a point
    /// is assigned, and the thinning of a point cloud selects among points of both faces.
    double edge_band = 1.5;  // in units of the distance between observed points
    /// Nearer than this to an edge, in standard deviations of the points, their noise has a
    /// non-zero mean: a point outside a convex edge lies off the face it is assigned to, whichever
    /// face that is, by 0.6 standard deviations at a right angle. Such points are omitted unless
    /// most points are of this kind.
    double edge = 2;
    int places = 20;
    double correlation = 3;  // s
    /// Distance, in standard deviations, beyond which a point is attributed to another object (a
    /// hand or a table).
    double gate = 3;
    double reach = 0.02;  // m, the same as an absolute distance, whatever the uncertainty
    int points_per_tick = 16;
  };
  struct Information {
    WrenchFilter::ShapeMatrix matrix;
    WrenchFilter::ShapeState vector;
    int used = 0;      // points
    int rejected = 0;  // assigned to other objects
  };
  /// Quantities that the derivatives depend on.
  struct Basis {
    const elasticity::Sensitivity* sensitivity = nullptr;
    std::array<bool, 2> held{};
    const PatchMotion* motion = nullptr;
    const WrenchFilter* filter = nullptr;
  };

  /// Throws std::invalid_argument if an option is out of range. `rest`: rest positions of the
  /// nodes, 3 x n, m.
  SurfaceFit(const Eigen::Matrix3Xd& rest, const mesh::Surface& surface, const Options& options);

  void reset() noexcept;
  /// Starts a new message; the remainder of the previous one is dropped. False if the shape at the
  /// acquisition time is not available.
  bool begin(const ObservationInput& seen, const ShapeHistory& history) noexcept;
  bool is_busy() const noexcept { return next_ < points_.cols(); }
  /// Processes the next points. Returns true when they were the last; information() is then
  /// complete.
  bool advance(const Basis& basis, double dt) noexcept;
  /// Call in each tick without work.
  void wait(double dt) noexcept { since_ += dt; }
  const Information& information() const noexcept { return information_; }

  using NodeRows = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, WrenchFilter::kMostShape>;
  /// Adds `weight` times the derivative of a node's position with respect to the patches' motions,
  /// log E, obstacles and virtual loads, 3 x shape_size(). Multiplied by PatchMotion::by_state() it
  /// is the derivative with respect to the states.
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
  double since_ = 0;      // s since the last message began
  double interval_ = 0;   // s, between messages
  double edge_band_ = 0;  // m, distance from an edge within which the noise acts as a common error
  double common_count_ = 1;  // number of measurements that share one realisation of the error
  /// m, robust standard deviation of the residuals of the last message; negative: none yet
  double scale_ = -1;
  std::array<double, ObservationInput::kMostPoints> residuals_{};
  int residual_count_ = 0;
  int edge_count_ = 0;  // points of this message nearer to an edge than Options::edge
  /// Such points are omitted, because most points of the last message were not of this kind.
  bool spares_edges_ = false;
  NodeRows rows_;
  Information information_;
};

}  // namespace palpate::estimation
