#include "tools/fit/experiments/hertz.hpp"

#include <algorithm>
#include <cmath>

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
    Series series;
    series.quantity = "force";
    series.unit = "N";
    series.abscissa = "depth";
    series.abscissa_unit = "m";
    series.x = data.depth;
    series.measured = data.force;
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

  const std::string& name() const override { return name_; }
  const std::vector<Series>& series() const override { return series_; }
  const std::vector<Parameter>& parameters() const override { return parameters_; }

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
      if (series.is_held_out.empty() || !series.is_held_out[static_cast<std::size_t>(i)])
        greatest = std::max(greatest, series.x[i]);
    return greatest > 0 ? greatest : series.x.maxCoeff();
  }

  std::string name_;
  bool is_linear_ = false;
  double radius_ = 0;
  double fitted_depth_ = 0;
  std::vector<Series> series_;
  std::vector<Parameter> parameters_;
};

}  // namespace

std::unique_ptr<Experiment> make_hertz(const config::Node& node,
                                       const std::filesystem::path& folder) {
  return std::make_unique<Hertz>(node, folder);
}

}  // namespace palpate::fit
