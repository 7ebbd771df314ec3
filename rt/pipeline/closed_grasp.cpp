#include "rt/pipeline/closed_grasp.hpp"

#include <Eigen/SVD>
#include <sstream>
#include <vector>

namespace palpate::pipeline {
namespace {

constexpr double kNarrowest = 1e-3;  // width of the held nodes, relative to the extent of the jaws

std::vector<int> nodes_between(const registry::Box& jaws, const math::Pose& X_OG,
                               const Eigen::Matrix3Xd& positions) {
  const math::Pose X_GO = X_OG.inverse();
  std::vector<int> nodes;
  for (int i = 0; i < positions.cols(); ++i) {
    const Eigen::Array3d p_G = X_GO * Eigen::Vector3d(positions.col(i));
    if ((p_G >= jaws.lower.array()).all() && (p_G <= jaws.upper.array()).all()) nodes.push_back(i);
  }
  return nodes;
}

/// The second of the extents of points along their principal axes, m.
double width(const Eigen::Matrix3Xd& points) {
  const Eigen::Matrix3Xd centred = points.colwise() - points.rowwise().mean();
  return Eigen::JacobiSVD<Eigen::Matrix3Xd>(centred).singularValues()[1] /
         std::sqrt(static_cast<double>(points.cols()));
}

}  // namespace

std::string found_grasp(const registry::Object& object, const ClosedGrasp& grasp,
                        const Eigen::Matrix3Xd& positions) {
  const registry::Box& jaws = object.jaws.at(grasp.hand).value();
  elasticity::Body body;
  body.mesh = object.body.mesh;
  body.grasps.resize(1);
  std::vector<int>& nodes = body.grasps[0].nodes;
  nodes = nodes_between(jaws, grasp.X_OG, positions);
  const std::string prefix = grasp.hand == 0 ? "" : "second_";
  if (nodes.size() < 3 ||
      width(positions(Eigen::all, nodes)) < kNarrowest * (jaws.upper - jaws.lower).maxCoeff()) {
    throw config::Error("object." + prefix +
                        "grasp_jaws: between the jaws of the closed hand are " +
                        std::to_string(nodes.size()) +
                        " nodes of the object; needed are three that are not on a line");
  }
  // With G at rest in O, its pose follows the nodes.
  const math::Pose X_OG_rest = elasticity::grasp_pose(body, 0, positions).inverse() * grasp.X_OG;
  const Eigen::Vector3d p = X_OG_rest.translation();
  const Eigen::Quaterniond q(X_OG_rest.linear());
  std::ostringstream text;
  text.precision(17);
  text << "{" << prefix << "grasp_nodes: [";
  for (std::size_t i = 0; i < nodes.size(); ++i) text << (i == 0 ? "" : ", ") << nodes[i];
  text << "], " << prefix << "grasp_at_rest: {position: [" << p.x() << ", " << p.y() << ", "
       << p.z() << "], quaternion: [" << q.w() << ", " << q.x() << ", " << q.y() << ", " << q.z()
       << "]}}";
  return text.str();
}

}  // namespace palpate::pipeline
