#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>

#include "rt/config/node.hpp"
#include "tools/fit/experiment.hpp"

namespace palpate::fit {

/// Natural cubic spline, linear outside its ends.
class Spline {
 public:
  /// x rising, at least two.
  Spline(Eigen::VectorXd x, Eigen::VectorXd y);

  double value(double x) const { return at(x).value; }
  double slope(double x) const { return at(x).slope; }

  struct Point {
    double value = 0;
    double slope = 0;
  };
  Point at(double x) const;

 private:
  Eigen::VectorXd x_, y_, bend_;  // second derivatives
};

/// Kind `hertz`: a rigid ball pressed into a half space. Force as a function of depth:
///    F = 4/3 E / (1 - nu^2) sqrt(R) max(d - d0, 0)^(3/2)
/// (Johnson, Contact Mechanics, 1985, eq. 4.23), or with `model: linear` that of a spring with the
/// stiffness of Hertz' chord to the largest fitted depth h: sqrt(R h) (d - d0) instead of the
/// power.
///
/// Columns: `depth` and `force` (both positive in compression), or the ball's centre at first
/// contact `centre_x|y|z`, outward normal `normal_x|y|z`, ball's centre `position_x|y|z` and force
/// on the object's surroundings `force_x|y|z`, from which depth and force are taken along the
/// normal. Keys: geometry.radius; poisson_ratio (0.5), which is not identifiable together with E
/// from force alone; contact_offset: free | none; deviation (0.01 of the range). Parameters:
/// young_modulus, poisson_ratio (known), NAME.contact_offset (m).
std::unique_ptr<Experiment> make_hertz(const config::Node& node,
                                       const std::filesystem::path& folder);

/// Kind `indentation`: a rigid ball pressed into a layer, frictionless, at large strain, by finite
/// elements (core/solid/solid_indentation.hpp). By similarity
///    F = E R^2 f((d - d0) / R; thickness / R, nu, model),
/// so that f is computed once for all recordings with equal parameters after the semicolon. Between
/// the computed depths f / (Hertz' half space) is a natural cubic spline of sqrt(d / R), which
/// begins at 1; beyond the last one it is continued linearly.
///
/// Columns, geometry.radius, contact_offset and deviation as for kind `hertz`, which reads them; in
/// addition geometry.thickness, poisson_ratio (0.49, at most 0.4999), material: neo_hookean |
/// mooney_rivlin (half of the shear modulus each) and stiffening (0: Yeoh's second constant over
/// the shear modulus), all known. Parameters: young_modulus, poisson_ratio (known),
/// NAME.contact_offset (m).
std::unique_ptr<Experiment> make_indentation(const config::Node& node,
                                             const std::filesystem::path& folder);

}  // namespace palpate::fit
