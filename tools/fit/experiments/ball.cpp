#include "tools/fit/experiments/ball.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <stdexcept>
#include <tuple>

#include "core/solid/solid_indentation.hpp"
#include "tools/fit/recording.hpp"

namespace palpate::fit {
namespace {

constexpr double kLargestPoisson = 0.5;

struct HertzData {
  Eigen::VectorXd depth;  // m
  Eigen::VectorXd force;  // N
};

std::vector<WantedColumn> wanted_columns(bool has_depth) {
  if (has_depth)
    return {{"depth", Dimension::kLength, "of the ball below the surface"},
            {"force", Dimension::kForce, "of the ball"}};
  std::vector<WantedColumn> wanted;
  for (const char* axis : {"x", "y", "z"}) {
    wanted.push_back({std::string("centre_") + axis, Dimension::kLength,
                      "instead of a depth: of the ball where it touches"});
    wanted.push_back(
        {std::string("normal_") + axis, Dimension::kRatio, "of the surface, outwards"});
    wanted.push_back({std::string("position_") + axis, Dimension::kLength, "of the ball"});
    wanted.push_back({std::string("force_") + axis, Dimension::kForce, "on the ball"});
  }
  return wanted;
}

HertzData read_indentation(const Recording& recording) {
  if (recording.has("depth")) return {recording.column("depth"), recording.column("force")};
  HertzData result;
  result.depth = result.force = Eigen::VectorXd::Zero(recording.rows());
  for (const std::string axis : {"x", "y", "z"}) {
    const Eigen::VectorXd& normal = recording.column("normal_" + axis);
    result.depth -= (recording.column("position_" + axis) - recording.column("centre_" + axis))
                        .cwiseProduct(normal);
    result.force += recording.column("force_" + axis).cwiseProduct(normal);
  }
  return result;
}

class Hertz final : public Experiment {
 public:
  Hertz(const config::Node& node, const std::filesystem::path& folder) {
    const Recording recording(
        node, folder,
        wanted_columns(
            node.child({"columns", "", "where each quantity stands in the file"}).has("depth")));
    name_ = recording.name();
    recording.require_rows(3);
    const HertzData data = read_indentation(recording);
    check(recording, data);

    is_linear_ = node.choice({"model", "", "force with depth to the 3/2, or in proportion"},
                             {"hertz", "linear"}, "hertz") == "linear";
    const bool has_offset =
        node.choice({"contact_offset", "", "depth at which the ball touches: sought, or 0"},
                    {"free", "none"}, "free") == "free";
    radius_ = read_quantity(node.child({"geometry", "", "of ball and layer"}),
                            {"radius", "", "of the ball"}, Dimension::kLength, {1e-6, 10});
    const double nu =
        node.number({"poisson_ratio", "", "known, not sought"}, {0, kLargestPoisson}, 0.5);

    const double range = data.force.maxCoeff() - data.force.minCoeff();
    Series series{"force", "N", "depth", "m", data.depth, data.force};
    series.deviation =
        optional_quantity(node, {"deviation", "", "of the force; absent: a hundredth of its range"},
                          Dimension::kForce, {1e-12, 1e6})
            .value_or(0.01 * range);
    series.is_held_out = held_out_samples(node, recording, {{"depth", data.depth}});
    fitted_depth_ = greatest_fitted(series);
    series_.push_back(std::move(series));

    const double deepest = data.depth.maxCoeff();
    const double start =
        data.force.maxCoeff() * (1 - nu * nu) * 0.75 / std::sqrt(radius_) / std::pow(deepest, 1.5);
    parameters_.push_back({"young_modulus", "Pa", start, 1, 1e12, true});
    parameters_.push_back({"poisson_ratio", "", nu, nu, nu, false});
    const double reach = has_offset ? deepest : 0;
    parameters_.push_back({name_ + ".contact_offset", "m", 0, -5 * reach, 0.95 * reach, false});
  }

  bool predict(const Eigen::VectorXd& parameters, Eigen::VectorXd& prediction,
               Eigen::MatrixXd* jacobian) const override {
    const double E = parameters[0], nu = parameters[1], offset = parameters[2];
    const double plane = 1 - nu * nu;
    const double factor = 4.0 / 3 * E / plane * std::sqrt(radius_);
    const Eigen::VectorXd& depth = series_.front().x;
    prediction.resize(depth.size());
    if (jacobian) jacobian->resize(depth.size(), 3);
    // A spring as stiff as Hertz' chord to the deepest sample.
    const double chord = std::sqrt(fitted_depth_);
    for (Eigen::Index i = 0; i < depth.size(); ++i) {
      const double d = is_linear_ ? depth[i] - offset : std::max(depth[i] - offset, 0.0);
      const double shape = is_linear_ ? chord : std::sqrt(d);
      const double force = factor * d * shape;
      prediction[i] = force;
      if (jacobian)
        jacobian->row(i) << force / E, force * 2 * nu / plane,
            -factor * shape * (is_linear_ ? 1.0 : 1.5);
    }
    return true;
  }

  /// Mean strain below a ball, Tabor's 0.2 a / R with a = sqrt(R d).
  std::array<double, 2> strain_range() const override {
    return {-0.2 * std::sqrt(fitted_depth_ / radius_), 0};
  }

 private:
  static void check(const Recording& recording, const HertzData& data) {
    Eigen::Index deepest = 0;
    if (!(data.depth.maxCoeff(&deepest) > data.depth.minCoeff()))
      recording.fail(0, "depth is the same in every row: nothing can be learnt from it");
    if (!(data.depth[deepest] > 0))
      recording.fail(deepest, "no depth is positive; give its column `sign: -1`");
    if (!(data.force.maxCoeff() > data.force.minCoeff()))
      recording.fail(0, "force is the same in every row: nothing can be learnt from it");
    const Eigen::VectorXd centred = data.depth.array() - data.depth.mean();
    if (!(data.force[deepest] > 0) || centred.dot(data.force) <= 0)
      recording.fail(deepest,
                     "force falls with depth, so that its sign must be wrong; it is "
                     "positive in compression: give its column `sign: -1`");
  }

  static double greatest_fitted(const Series& series) {
    double greatest = 0;
    for (Eigen::Index i = 0; i < series.x.size(); ++i)
      if (series.is_held_out.empty() || !series.is_held_out[i])
        greatest = std::max(greatest, series.x[i]);
    return greatest > 0 ? greatest : series.x.maxCoeff();
  }

  bool is_linear_ = false;
  double radius_ = 0;
  double fitted_depth_ = 0;
};

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
      : half_space_(std::move(half_space)) {
    name_ = half_space_->name();
    series_ = half_space_->series();
    parameters_ = half_space_->parameters();
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

std::unique_ptr<Experiment> make_hertz(const config::Node& node,
                                       const std::filesystem::path& folder) {
  return std::make_unique<Hertz>(node, folder);
}

std::unique_ptr<Experiment> make_indentation(const config::Node& node,
                                             const std::filesystem::path& folder) {
  return std::make_unique<Indentation>(make_hertz(node, folder), node);
}

}  // namespace palpate::fit
