#include "core/shape/curvature_feature.hpp"

#include "core/math/option_check.hpp"

namespace palpate::shape {

CurvatureFeature::CurvatureFeature(const mesh::ElementMesh& mesh, const Options& options)
    : MaterialFeature(mesh, checked_points("curvature", options.rest_points, 3, 5)),
      axis_(unit_axis("curvature", options.axis)) {
  math::check_option(point_count() != 4, "feature curvature: rest_points", point_count(), "3 or 5");
  set_dimension(1);
  Eigen::VectorXd value(1);
  evaluate(mesh.nodes, value);
  if (!is_defined_) {
    reject_points(
        "curvature", rest_points(),
        "points that are not on a straight line, or an axis about which the curvature has "
        "a sign");
  }
}

void CurvatureFeature::evaluate(const Eigen::Matrix3Xd& positions,
                                Eigen::Ref<Eigen::VectorXd> value) noexcept {
  const int triples = point_count() - 2;
  Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, 15> by_points;
  by_points.setZero(3 * point_count());
  value[0] = 0;
  is_defined_ = true;
  for (int i = 0; i < triples; ++i) {
    const Eigen::Vector3d middle = position(i + 1, positions);
    Triple& triple = triples_[i];
    is_defined_ &=
        measure(middle - position(i, positions), position(i + 2, positions) - middle, triple);
    value[0] += triple.curvature / triples;
    by_points.segment<3>(3 * i) -= triple.by_a / triples;
    by_points.segment<3>(3 * i + 3) += (triple.by_a - triple.by_b) / triples;
    by_points.segment<3>(3 * i + 6) += triple.by_b / triples;
  }
  chain(by_points);
}

bool CurvatureFeature::measure(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                               Triple& triple) const noexcept {
  const Eigen::Vector3d c = a + b;
  const double length_a = a.norm();
  const double length_b = b.norm();
  const double length_c = c.norm();
  if (!(length_a > kShortestEdge && length_b > kShortestEdge && length_c > kShortestEdge)) {
    return false;
  }
  const Eigen::Vector3d cross = a.cross(b);
  const bool bent = cross.norm() > kFlattest * length_a * length_b;
  if (axis_) {
    triple.normal = *axis_;
  } else if (bent) {
    triple.normal = cross.normalized();
  }
  const Eigen::Vector3d& m = triple.normal;
  const double factor = 2 / (length_a * length_b * length_c);
  triple.curvature = factor * m.dot(cross);
  // the line's own normal has no rotation component along itself and counts as fixed
  const Eigen::Vector3d shorter_c = c / (length_c * length_c);
  triple.by_a = factor * b.cross(m) - triple.curvature * (a / (length_a * length_a) + shorter_c);
  triple.by_b = factor * m.cross(a) - triple.curvature * (b / (length_b * length_b) + shorter_c);
  return bent || axis_;
}

bool CurvatureFeature::is_valid_target(const double* target, int count) const noexcept {
  return MaterialFeature::is_valid_target(target, count) && (axis_ || target[0] >= 0);
}

}  // namespace palpate::shape
