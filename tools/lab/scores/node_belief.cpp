#include "tools/lab/scores/node_belief.hpp"

#include "tools/lab/scores/truth_points.hpp"

namespace palpate::scores {

void NodeBelief::add(const shape_t& shape, const Eigen::RowVectorXd& error) {
  for (int i = 0; i < shape.node_count; ++i) {
    const double deviation = shape.deviation[static_cast<std::size_t>(i)];
    if (!(deviation > 0)) continue;
    inside_ += error[i] <= kBall * deviation ? 1 : 0;
    squares_ += error[i] * error[i] / (3 * deviation * deviation);
    deviations_ += deviation;
    ++count_;
  }
}

void visit_node_errors(const log::RunLog& run, const math::Pose& X_OP,
                       const std::function<void(const shape_t&, const Eigen::RowVectorXd&)>& take) {
  const log::MeshMessage estimate = log::assemble(run.shape_chunks),
                         plant = log::assemble(run.truth_chunks);
  const TruthPoints points(plant, estimate, estimate.nodes, X_OP);
  const log::PlantMotion motion(run.truths);
  Eigen::Matrix3Xd truth;
  for (const shape_t& shape : run.shapes) {
    if (shape.mesh_hash != estimate.hash || shape.node_count != estimate.nodes.cols()) continue;
    if (shape.deviation_count != shape.node_count || !motion.at(shape.utime, truth)) continue;
    take(shape, (log::positions(shape) - points.at(truth)).colwise().norm());
  }
}

}  // namespace palpate::scores
