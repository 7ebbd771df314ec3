#include "tools/lab/studies/discrepancy_intervals.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/common/output_files.hpp"
#include "tools/log/plant_truth.hpp"

namespace palpate::studies {
namespace {

constexpr int kGrid[] = {8, 3, 3};  // points along the sides, on the faces as well
constexpr int kInstants = 20;

/// Nodes next to a grid of points that is the same for all meshes of an object.
class PointGrid {
 public:
  explicit PointGrid(const log::MeshMessage& mesh) {
    const Eigen::Vector3d lower = mesh.nodes.rowwise().minCoeff(),
                          size = mesh.nodes.rowwise().maxCoeff() - lower;
    for (int i = 0; i < kGrid[0]; ++i)
      for (int j = 0; j < kGrid[1]; ++j)
        for (int k = 0; k < kGrid[2]; ++k) {
          PointBelief point;
          point.place = Eigen::Vector3d(i, j, k).cwiseQuotient(
              Eigen::Vector3d(kGrid[0] - 1, kGrid[1] - 1, kGrid[2] - 1));
          const Eigen::Vector3d p = lower + size.cwiseProduct(point.place);
          Eigen::Index nearest = 0;
          (mesh.nodes.colwise() - p).colwise().squaredNorm().minCoeff(&nearest);
          nodes_.push_back(nearest);
          points_.push_back(std::move(point));
        }
  }

  void add(const shape_t& shape, const Eigen::RowVectorXd& error) {
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double deviation = shape.deviation[static_cast<std::size_t>(nodes_[i])];
      if (!(deviation > 0)) continue;
      points_[i].errors.push_back(error[nodes_[i]]);
      points_[i].radii.push_back(scores::kBall * deviation);
    }
  }

  /// Those that a deviation was reported of.
  std::vector<PointBelief> points() const {
    std::vector<PointBelief> reported;
    for (const PointBelief& point : points_)
      if (!point.errors.empty()) reported.push_back(point);
    return reported;
  }

 private:
  std::vector<PointBelief> points_;
  std::vector<Eigen::Index> nodes_;
};

}  // namespace

IntervalScore score_intervals(const log::RunLog& log, const math::Pose& X_OP, double young_modulus,
                              std::int64_t from) {
  IntervalScore score;
  PointGrid grid(log::assemble(log.shape_chunks));
  const std::int64_t until = log.shapes.back().utime, step = (until - from) / kInstants;
  std::int64_t next = from + step / 2;
  scores::visit_node_errors(log, X_OP, [&](const shape_t& shape, const Eigen::RowVectorXd& error) {
    if (shape.utime < from) return;
    score.nodes.add(shape, error);
    if (shape.utime < next) return;
    next += step;
    grid.add(shape, error);
  });
  score.points = grid.points();
  score.wrench = wrench_belief(log.truth_contacts, log.estimates, X_OP, from, until);
  if (!log.estimates.empty() && log.estimates.back().log_young_modulus_deviation > 0) {
    score.log_young_error = log.estimates.back().log_young_modulus - std::log(young_modulus);
    score.log_young_deviation = log.estimates.back().log_young_modulus_deviation;
  }
  return score;
}

nlohmann::json to_json(const IntervalScore& score) {
  nlohmann::json points = nlohmann::json::array();
  const auto millimetres = [](const std::vector<double>& values) {
    std::vector<double> rounded;
    for (const double value : values) rounded.push_back(1e-3 * std::round(1e6 * value));
    return rounded;
  };
  for (const PointBelief& point : score.points)
    points.push_back({{"place", {point.place.x(), point.place.y(), point.place.z()}},
                      {"error_mm", millimetres(point.errors)},
                      {"radius_mm", millimetres(point.radii)}});
  return {{"nodes", score.nodes.count()},
          {"nodes_inside", score.nodes.inside()},
          {"nees", common::or_null(score.nodes.normalised_square())},
          {"points", points},
          {"wrench_components", score.wrench.count},
          {"wrench_inside_percent", 100 * score.wrench.share_inside},
          {"wrench_nees", score.wrench.normalised_square},
          {"log_young_modulus_error", common::or_null(score.log_young_error)},
          {"log_young_modulus_deviation", common::or_null(score.log_young_deviation)}};
}

}  // namespace palpate::studies
