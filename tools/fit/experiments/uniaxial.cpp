#include "tools/fit/experiments/uniaxial.hpp"

#include <algorithm>
#include <cmath>

#include "core/solid/strain_energy.hpp"
#include "tools/fit/experiments/uniaxial_data.hpp"

namespace palpate::fit {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

bool is_free(const config::Node& node, const config::Key& key) {
  return node.choice(key, {"free", "none"}, "none") == "free";
}

class Uniaxial final : public Experiment {
 public:
  Uniaxial(const config::Node& node, const std::filesystem::path& folder)
      : data_(read_uniaxial(node, folder)),
        material_(solid::StrainEnergy::make(node.choice({"model", "", "law of the material"},
                                                        solid::StrainEnergy::names(), "linear"))),
        sign_(data_.is_compression ? -1 : 1) {
    name_ = data_.name;
    const bool is_viscous = is_free(node, {"viscosity", "", "a part that goes with the rate"});
    const bool is_relaxing = is_free(node, {"relaxation", "", "a part that fades with time"});
    has_history_ = is_viscous || is_relaxing;
    has_contact_ = is_free(node, {"contact_offset", "", "where the plate touches, in compression"});
    const bool is_clamp_free =
        is_free(node, {"clamp_offset", "", "by which the clamps are too far apart, in tension"});
    if (has_contact_ && !data_.is_compression)
      node.fail("contact_offset", "is of compression; in tension it is clamp_offset");
    if (is_clamp_free && data_.is_compression)
      node.fail("clamp_offset", "is of tension; in compression it is contact_offset");
    if (has_history_ && data_.time.size() == 0)
      node.fail("viscosity",
                "and relaxation need a column `time`, and cycles that are not averaged");
    for (Index i = 0; i < data_.strain.size(); ++i)
      if (has_history_ || data_.is_used[i]) rows_.push_back(i);
    make_series();
    make_parameters(node);
  }

  std::string material() const override { return material_->name(); }
  std::array<double, 2> strain_range() const override { return strain_range_; }

  bool predict(const VectorXd& parameters, VectorXd& prediction,
               MatrixXd* jacobian) const override {
    const auto count = static_cast<Index>(parameters_.size());
    const auto rows = static_cast<Index>(rows_.size());
    StressHistory stress{VectorXd(rows), MatrixXd::Zero(rows, count)};
    StressHistory stretch = stress, lateral = stress;
    if (!respond(parameters, stretch, stress, lateral)) return false;
    StressHistory total = stress;
    if (has_history_) add_overstress(parameters, stretch, stress, total);

    const auto load_count = series_[0].measured.size();
    const bool has_width = series_.size() > 1;
    prediction.resize(load_count + (has_width ? series_[1].measured.size() : 0));
    if (jacobian) jacobian->setZero(prediction.size(), count);
    const double scale = sign_ * data_.area, rest_width = parameters[width_];
    Index to = 0, width_to = load_count;
    for (Index k = 0; k < rows; ++k) {
      const Index row = rows_[k];
      if (!data_.is_used[row]) continue;
      prediction[to] = scale * total.stress[k] + parameters[bias_];
      if (jacobian) {
        jacobian->row(to) = scale * total.by_parameter.row(k);
        (*jacobian)(to, bias_) += 1;
      }
      ++to;
      if (!has_width || !std::isfinite(data_.width[row])) continue;
      prediction[width_to] = rest_width * lateral.stress[k];
      if (jacobian) {
        jacobian->row(width_to) = rest_width * lateral.by_parameter.row(k);
        (*jacobian)(width_to, width_) += lateral.stress[k];
      }
      ++width_to;
    }
    return true;
  }

 private:
  void make_series() {
    Series load{data_.is_stress ? "stress" : "force", data_.is_stress ? "Pa" : "N", "strain", ""};
    std::vector<Index> used;
    for (Index i = 0; i < data_.strain.size(); ++i)
      if (data_.is_used[i]) used.push_back(i);
    const auto n = static_cast<Index>(used.size());
    load.x.resize(n);
    load.measured.resize(n);
    load.is_held_out.resize(used.size());
    load.deviation = data_.load_deviation;
    for (Index k = 0; k < n; ++k) {
      const Index i = used[k];
      load.x[k] = data_.strain[i];
      load.measured[k] = data_.load[i];
      const bool is_held = data_.is_held_out[i];
      load.is_held_out[k] = is_held;
      if (is_held) continue;
      strain_range_[0] = std::min(strain_range_[0], sign_ * data_.strain[i]);
      strain_range_[1] = std::max(strain_range_[1], sign_ * data_.strain[i]);
    }
    series_.push_back(load);
    if (data_.width.size() == 0) return;
    Series width{"width", "m", "strain", ""};
    width.deviation = data_.width_deviation;
    std::vector<double> x, measured;
    for (Index k = 0; k < n; ++k) {
      const double seen = data_.width[used[k]];
      if (!std::isfinite(seen)) continue;
      x.push_back(load.x[k]);
      measured.push_back(seen);
      width.is_held_out.push_back(load.is_held_out[k]);
    }
    width.x = Eigen::Map<VectorXd>(x.data(), static_cast<Index>(x.size()));
    width.measured = Eigen::Map<VectorXd>(measured.data(), static_cast<Index>(x.size()));
    series_.push_back(width);
  }

  Index add(const Parameter& parameter) {
    parameters_.push_back(parameter);
    return static_cast<Index>(parameters_.size()) - 1;
  }

  Index add_own(const std::string& name, const std::string& unit, double start, bool is_free_one,
                double lower, double upper) {
    return add({data_.name + "." + name, unit, start, is_free_one ? lower : start,
                is_free_one ? upper : start, false});
  }

  void make_parameters(const config::Node& node) {
    const VectorXd& strain = data_.strain;
    const double most = strain.maxCoeff();
    const double range = data_.load.maxCoeff() - data_.load.minCoeff();
    for (const solid::MaterialConstant& c : material_->constants())
      add({c.name, c.unit, c.start, c.lower, c.upper, c.is_logarithmic});
    parameters_[0].start = range / (data_.area * (most - strain.minCoeff()));
    const std::string poisson = node.text(
        {"poisson_ratio", "",
         "-0.5 to 0.5, or free (sought), or by_width (sought where there is a width, else 0)"},
        "0.5");
    const bool has_width = data_.width.size() > 0;
    const bool is_poisson_free = poisson == "free" || (poisson == "by_width" && has_width);
    if (is_poisson_free && !has_width)
      node.fail("poisson_ratio",
                "can be free only where the recording has a column `width` or a "
                "`video`: the load alone does not determine it");
    if (!is_poisson_free)
      parameters_[1].start = parameters_[1].lower = parameters_[1].upper =
          poisson == "by_width" ? 0 : node.number("poisson_ratio", {-0.5, 0.5}, 0.5);
    // For strains and lengths alike: offsets are bounded by a third of the range reached.
    const double reach = most * data_.length / 3;
    const bool has_offset = has_contact_ || is_free(node, "clamp_offset");
    offset_ = add_own(data_.is_compression ? "contact_offset" : "clamp_offset",
                      data_.length == 1 ? "" : "m", 0, has_offset, -reach, reach);
    const bool is_bias_free = is_free(node, {"load_bias", "", "load at no strain"});
    bias_ = add_own("load_bias", series_[0].unit, 0, is_bias_free, -range, range);
    if (is_free(node, "viscosity")) {
      const double duration = data_.time[data_.time.size() - 1] - data_.time[0];
      viscosity_ = add({"viscosity", "Pa s", 0.01 * parameters_[0].start,
                        1e-9 * parameters_[0].start * duration,
                        1e3 * parameters_[0].start * duration, true});
    }
    if (is_free(node, "relaxation")) {
      const double duration = data_.time[data_.time.size() - 1] - data_.time[0];
      const double step = duration / static_cast<double>(data_.time.size());
      ratio_ = add({"relaxation_ratio", "", 0.2, 1e-4, 100, true});
      relaxation_time_ =
          add({"relaxation_time", "s", std::sqrt(duration * step), step / 10, 10 * duration, true});
    }
    if (has_width) {
      const double w = series_[1].measured.size() > 0 ? series_[1].measured[0] : 1;
      width_ = add_own("rest_width", "m", w, true, 0.5 * w, 1.5 * w);
    }
  }

  /// The elastic bar by row; `lateral` is a stretch.
  bool respond(const VectorXd& parameters, StressHistory& stretch, StressHistory& stress,
               StressHistory& lateral) const {
    const auto constants = static_cast<Index>(material_->constants().size());
    const VectorXd c = parameters.head(constants);
    solid::UniaxialStress r;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const auto row = static_cast<Index>(k);
      const double strain = data_.strain[rows_[k]] - parameters[offset_] / data_.length;
      const bool touches = !has_contact_ || strain > 0;
      const double by_offset = touches ? -sign_ / data_.length : 0;
      stretch.stress[row] = touches ? 1 + sign_ * strain : 1;
      stretch.by_parameter(row, offset_) = by_offset;
      if (!respond_uniaxially(*material_, c, stretch.stress[row], r)) return false;
      stress.stress[row] = r.stress;
      stress.by_parameter.row(row).head(constants) = r.by_constant.transpose();
      stress.by_parameter(row, offset_) = r.by_stretch * by_offset;
      lateral.stress[row] = r.lateral;
      lateral.by_parameter.row(row).head(constants) = r.lateral_by_constant.transpose();
      lateral.by_parameter(row, offset_) = r.lateral_by_stretch * by_offset;
    }
    return true;
  }

  void add_overstress(const VectorXd& parameters, const StressHistory& stretch,
                      const StressHistory& stress, StressHistory& total) const {
    if (ratio_ >= 0) {
      const StressHistory q = relaxing_part(stress, data_.time, parameters[ratio_],
                                            parameters[relaxation_time_], ratio_, relaxation_time_);
      total.stress += q.stress;
      total.by_parameter += q.by_parameter;
    }
    if (viscosity_ < 0) return;
    for (Index i = 1; i < data_.time.size(); ++i) {
      const double h = data_.time[i] - data_.time[i - 1];
      const double rate = (stretch.stress[i] - stretch.stress[i - 1]) / h;
      total.stress[i] += parameters[viscosity_] * rate;
      total.by_parameter(i, viscosity_) += rate;
      total.by_parameter.row(i) += parameters[viscosity_] / h *
                                   (stretch.by_parameter.row(i) - stretch.by_parameter.row(i - 1));
    }
  }

  UniaxialData data_;
  std::unique_ptr<const solid::StrainEnergy> material_;
  double sign_;
  bool has_history_ = false, has_contact_ = false;
  std::vector<Index> rows_;  // of the data, that are worked on
  std::array<double, 2> strain_range_{};
  // Indices in parameters_; -1: absent. Without a width the column is arbitrary, as it is not used.
  Index offset_ = 0, bias_ = 0, width_ = 0, viscosity_ = -1, ratio_ = -1, relaxation_time_ = -1;
};

}  // namespace

StressHistory relaxing_part(const StressHistory& elastic, const Eigen::VectorXd& time, double ratio,
                            double relaxation_time, Eigen::Index ratio_column,
                            Eigen::Index time_column) {
  const Eigen::Index n = elastic.stress.size();
  StressHistory q;
  q.stress.setZero(n);
  q.by_parameter.setZero(n, elastic.by_parameter.cols());
  for (Eigen::Index i = 1; i < n; ++i) {
    const double h = time[i] - time[i - 1], tau = relaxation_time;
    const double a = std::exp(-h / tau), b = -std::expm1(-h / tau) * tau / h;
    const double a_tau = a * h / (tau * tau), b_tau = b / tau - a / tau;
    const double change = elastic.stress[i] - elastic.stress[i - 1];
    q.stress[i] = a * q.stress[i - 1] + ratio * b * change;
    q.by_parameter.row(i) =
        a * q.by_parameter.row(i - 1) +
        ratio * b * (elastic.by_parameter.row(i) - elastic.by_parameter.row(i - 1));
    q.by_parameter(i, ratio_column) += b * change;
    q.by_parameter(i, time_column) += a_tau * q.stress[i - 1] + ratio * b_tau * change;
  }
  return q;
}

std::unique_ptr<Experiment> make_uniaxial(const config::Node& node,
                                          const std::filesystem::path& folder) {
  return std::make_unique<Uniaxial>(node, folder);
}

}  // namespace palpate::fit
