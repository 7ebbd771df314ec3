#include "tools/fit/experiments/ball.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <stdexcept>
#include <tuple>

#include "core/solid/solid_indentation.hpp"
#include "tools/fit/experiments/hertz.hpp"
#include "tools/fit/recording.hpp"

namespace palpate::fit {
namespace {

/// Parameters of the dimensionless curve.
struct Layer {
  double thickness = 0;  // relative to the ball's radius
  double poisson_ratio = 0;
  double mooney = 0;
  double stiffening = 0;

  bool operator<(const Layer& other) const {
    return std::tie(thickness, poisson_ratio, mooney, stiffening) <
           std::tie(other.thickness, other.poisson_ratio, other.mooney, other.stiffening);
  }
};

/// Force relative to Hertz', by the square root of the depth over R.
Spline compute(const Layer& layer) {
  const solid::SolidCoefficients c =
      solid::make_solid_material(1, layer.poisson_ratio, layer.mooney, layer.stiffening)
          .coefficients;
  const solid::IndentationCurve curve = solid::indent_layer(c, layer.thickness);
  if (curve.depth.size() < 4) {
    throw std::runtime_error("a ball in a layer " + std::to_string(layer.thickness) +
                             " radii thick: no equilibrium at small depth");
  }
  const double plane = 1 - layer.poisson_ratio * layer.poisson_ratio;
  // The first depths, with few elements in contact, are less accurate than Hertz.
  const Eigen::Index skipped = 1, count = curve.depth.size() - skipped;
  Eigen::VectorXd roots(count + 1), ratios(count + 1);
  roots[0] = 0;
  ratios[0] = 1;
  roots.tail(count) = curve.depth.tail(count).cwiseSqrt();
  ratios.tail(count) =
      0.75 * plane * curve.force.tail(count).array() / curve.depth.tail(count).array().pow(1.5);
  return Spline(roots, ratios);
}

std::shared_ptr<const Spline> curve_of(const Layer& layer) {
  static std::mutex mutex;
  static std::map<Layer, std::shared_ptr<const Spline>> known;
  const std::lock_guard<std::mutex> lock(mutex);
  std::shared_ptr<const Spline>& curve = known[layer];
  if (!curve) curve = std::make_shared<Spline>(compute(layer));
  return curve;
}

class Indentation final : public Experiment {
 public:
  /// `half_space` has read everything except the layer.
  Indentation(std::unique_ptr<Experiment> half_space, const config::Node& node)
      : half_space_(std::move(half_space)), parameters_(half_space_->parameters()) {
    const config::Node geometry = node.child({"geometry", "", "of ball and layer"});
    radius_ =
        read_quantity(geometry, {"radius", "", "of the ball"}, Dimension::kLength, {1e-6, 10});
    const double thickness =
        read_quantity(geometry, {"thickness", "", "of the layer, 0.2 to 500 radii"},
                      Dimension::kLength, {1e-7, 5e3});
    if (thickness < 0.2 * radius_ || thickness > 500 * radius_)
      geometry.fail("thickness", "is out of range; allowed: 0.2 to 500 times the radius");
    poisson_ratio_ = node.number({"poisson_ratio", "", "known, not sought"}, {0, 0.4999}, 0.49);
    material_ = node.choice({"material", "", "law of the layer"}, {"neo_hookean", "mooney_rivlin"},
                            "neo_hookean");
    const double mooney = material_ == "mooney_rivlin" ? 0.5 : 0;
    const double stiffening =
        node.number({"stiffening", "", "c20 of Yeoh's law by the shear modulus"}, {0, 100}, 0);
    curve_ = curve_of({thickness / radius_, poisson_ratio_, mooney, stiffening});
    parameters_[1] = {"poisson_ratio", "", poisson_ratio_, poisson_ratio_, poisson_ratio_};
  }

  const std::string& name() const override { return half_space_->name(); }
  const std::vector<Series>& series() const override { return half_space_->series(); }
  const std::vector<Parameter>& parameters() const override { return parameters_; }
  std::string material() const override { return material_; }
  std::array<double, 2> strain_range() const override { return half_space_->strain_range(); }

  bool predict(const Eigen::VectorXd& parameters, Eigen::VectorXd& prediction,
               Eigen::MatrixXd* jacobian) const override {
    const double E = parameters[0];
    const double hertz = 4.0 / 3 * E / (1 - poisson_ratio_ * poisson_ratio_) * radius_ * radius_;
    const Eigen::VectorXd& depth = series().front().x;
    prediction.resize(depth.size());
    if (jacobian) jacobian->setZero(depth.size(), 3);
    for (Eigen::Index i = 0; i < depth.size(); ++i) {
      const double root = std::sqrt(std::max(depth[i] - parameters[2], 0.0) / radius_);
      const Spline::Point ratio = curve_->at(root);
      prediction[i] = hertz * std::pow(root, 3) * ratio.value;
      if (!jacobian) continue;
      (*jacobian)(i, 0) = prediction[i] / E;
      (*jacobian)(i, 2) = -hertz * (3 * ratio.value + root * ratio.slope) * root / (2 * radius_);
    }
    return true;
  }

 private:
  std::unique_ptr<Experiment> half_space_;
  std::vector<Parameter> parameters_;
  double radius_ = 0, poisson_ratio_ = 0;
  std::string material_;
  std::shared_ptr<const Spline> curve_;
};

}  // namespace

Spline::Spline(Eigen::VectorXd x, Eigen::VectorXd y) : x_(std::move(x)), y_(std::move(y)) {
  const Eigen::Index n = x_.size();
  if (n < 2 || y_.size() != n) throw std::invalid_argument("a spline needs two points or more");
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(n, n);
  bend_ = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 1; i + 1 < n; ++i) {
    const double left = x_[i] - x_[i - 1], right = x_[i + 1] - x_[i];
    A.row(i).segment<3>(i - 1) << left / 6, (left + right) / 3, right / 6;
    bend_[i] = (y_[i + 1] - y_[i]) / right - (y_[i] - y_[i - 1]) / left;
  }
  bend_ = A.partialPivLu().solve(bend_).eval();
}

Spline::Point Spline::at(double x) const {
  const Eigen::Index n = x_.size();
  const double inside = std::clamp(x, x_[0], x_[n - 1]);
  const Eigen::Index above = std::clamp<Eigen::Index>(
      std::upper_bound(x_.data(), x_.data() + n, inside) - x_.data(), 1, n - 1);
  const Eigen::Index k = above - 1;
  const double h = x_[above] - x_[k], b = (inside - x_[k]) / h, a = 1 - b;
  Point point;
  point.value = a * y_[k] + b * y_[above] +
                ((a * a * a - a) * bend_[k] + (b * b * b - b) * bend_[above]) * h * h / 6;
  point.slope = (y_[above] - y_[k]) / h +
                ((3 * b * b - 1) * bend_[above] - (3 * a * a - 1) * bend_[k]) * h / 6;
  point.value += point.slope * (x - inside);
  return point;
}

std::unique_ptr<Experiment> make_indentation(const config::Node& node,
                                             const std::filesystem::path& folder) {
  return std::make_unique<Indentation>(make_hertz(node, folder), node);
}

}  // namespace palpate::fit
