#include <algorithm>
#include <cctype>
#include <cstdio>
#include <fstream>
#include <iomanip>
#include <stdexcept>

#include "tools/common/output_files.hpp"
#include "tools/common/plot.hpp"
#include "tools/common/progress.hpp"
#include "tools/common/table.hpp"
#include "tools/fit/report.hpp"

namespace palpate::fit {
namespace {

using common::csv_cell;
using Eigen::Index;

constexpr std::size_t kMostFolders = 200;
constexpr std::size_t kMostPlots = 6;

std::string exact(double value) { return common::formatted("%.9g", value); }

std::string pair_text(const std::array<double, 2>& pair) {
  return "[" + exact(pair[0]) + ", " + exact(pair[1]) + "]";
}

/// A name that is valid for a folder.
std::string folder_name(const std::string& text) {
  std::string name;
  for (const char c : text)
    name += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-' ? c : '_';
  return name;
}

/// Whether it is a parameter of the material, not a recording's own.
bool is_material(const Estimate& e) { return e.parameter.name.find('.') == std::string::npos; }

/// Curves through measured and predicted values, in the recorded order.
common::Plot value_plot(const JobResult& result, std::size_t s) {
  const Series& series = result.problem->series_at(s);
  const SeriesFit& fit = result.fit.series[s];
  common::Curve measured{"measured", {}, {}}, fitted{"fitted", {}, {}},
      held{"predicted, held out", {}, {}};
  for (Index i = 0; i < series.measured.size(); ++i) {
    const double x = abscissa_of(series, i);
    measured.x.push_back(x);
    measured.y.push_back(series.measured[i]);
    common::Curve& to = result.problem->is_fitted(s, i) ? fitted : held;
    to.x.push_back(x);
    to.y.push_back(fit.predicted[i]);
  }
  const auto with_unit = [](const std::string& name, const std::string& unit) {
    return unit.empty() ? name : name + " [" + unit + "]";
  };
  common::Plot plot{fit.recording,
                    with_unit(series.abscissa, series.abscissa_unit),
                    with_unit(series.quantity, series.unit),
                    {measured}};
  for (common::Curve* curve : {&fitted, &held})
    if (!curve->x.empty()) plot.curves.push_back(*curve);
  return plot;
}

common::Plot residual_plot(const JobResult& result, std::size_t s) {
  common::Plot plot = value_plot(result, s);
  const common::Curve measured = plot.curves.front();
  const Series& series = result.problem->series_at(s);
  common::Curve residual{"predicted - measured", measured.x, {}};
  for (Index i = 0; i < series.measured.size(); ++i)
    residual.y.push_back(result.fit.series[s].predicted[i] - series.measured[i]);
  plot.title += ": residual";
  plot.curves = {residual};
  return plot;
}

/// Opens the file, lets `write` fill it, and throws std::runtime_error on failure.
template <class Write>
void write_file(const std::filesystem::path& path, const Write& write) {
  std::ofstream out(path);
  write(out);
  if (!out.flush()) throw std::runtime_error("cannot write " + path.string());
}

void write_table(const Plan& plan, const std::vector<JobResult>& results, std::ostream& out) {
  out << "fit,group,variant,young_modulus_Pa,young_modulus_low_Pa,young_modulus_high_Pa,"
         "poisson_ratio,rmse,percent_of_range,held_out_median,held_out_percent,error\n";
  for (std::size_t k = 0; k < results.size(); ++k) {
    const Job& job = plan.jobs[k];
    const JobResult& r = results[k];
    out << csv_cell(job.name) << ',' << csv_cell(job.group) << ',' << csv_cell(job.variant) << ',';
    if (r.effective)
      out << exact(r.effective->young_modulus) << ',' << exact(r.effective->modulus_interval[0])
          << ',' << exact(r.effective->modulus_interval[1]) << ','
          << exact(r.effective->poisson_ratio) << ',';
    else
      out << ",,,,";
    if (r.error.empty()) {
      const SeriesFit& f = r.fit.series.front();
      out << exact(f.fitted.rmse) << ',' << exact(f.fitted.percent) << ',';
      if (f.held_out.count > 0)
        out << exact(f.held_out.median) << ',' << exact(f.held_out.percent);
      else
        out << ',';
    } else {
      out << ",,,";
    }
    out << ',' << csv_cell(r.error) << '\n';
  }
}

}  // namespace

void write_material(const Job& job, const JobResult& result, std::ostream& out) {
  const Uncertainty& u = result.fit.uncertainty;
  out << "# " << job.title() << ": a material as palpate-fit found it; SI units.\nmaterial:\n"
      << "  model: " << result.material << "\n";
  const auto is_known = [](const Estimate& e) {
    return is_material(e) && e.standing != Standing::kUndetermined;
  };
  for (const Estimate& e : u.estimates)
    if (is_known(e))
      out << "  " << e.parameter.name << ": " << exact(e.value)
          << (e.standing == Standing::kAtBound ? "  # at the bound of what was allowed"
              : e.standing == Standing::kKnown ? "  # given, not fitted"
                                               : "")
          << "\n";
  out << "intervals:  # 95 %\n";
  for (const Estimate& e : u.estimates)
    if (is_known(e) && e.standing == Standing::kEstimated)
      out << "  " << e.parameter.name << ": " << pair_text(e.interval) << "\n";
  out << "undetermined: [";
  const char* separator = "";
  for (const Estimate& e : u.estimates)
    if (e.standing == Standing::kUndetermined) {
      out << separator << e.parameter.name;
      separator = ", ";
    }
  out << "]\n";
  if (!result.effective) return;
  const EffectiveMaterial& e = *result.effective;
  out << "corotational:  # for palpated's linear model\n  young_modulus: " << exact(e.young_modulus)
      << "\n  poisson_ratio: " << exact(e.poisson_ratio)
      << "\n  strain_range: " << pair_text(e.strain_range)
      << "\n  intervals: {young_modulus: " << pair_text(e.modulus_interval)
      << ", poisson_ratio: " << pair_text(e.poisson_interval) << "}\n";
}

void write_samples(const JobResult& result, std::ostream& out) {
  out << "recording,quantity,unit,abscissa,abscissa_unit,x,measured,predicted,held_out\n";
  for (std::size_t s = 0; s < result.fit.series.size(); ++s) {
    const Series& series = result.problem->series_at(s);
    const SeriesFit& fit = result.fit.series[s];
    for (Index i = 0; i < series.measured.size(); ++i) {
      const double x = abscissa_of(series, i);
      out << csv_cell(fit.recording) << ',' << csv_cell(series.quantity) << ',' << series.unit
          << ',' << csv_cell(series.abscissa) << ',' << series.abscissa_unit << ',' << exact(x)
          << ',' << exact(series.measured[i]) << ',' << exact(fit.predicted[i]) << ','
          << (result.problem->is_fitted(s, i) ? 0 : 1) << '\n';
    }
  }
}

bool draw_fit(const Job& job, const JobResult& result, const std::filesystem::path& picture) {
  std::vector<common::Plot> plots;
  const std::size_t count = std::min(result.fit.series.size(), kMostPlots);
  for (std::size_t s = 0; s < count; ++s) {
    plots.push_back(value_plot(result, s));
    plots.push_back(residual_plot(result, s));
  }
  plots.front().title = job.title() + ": " + plots.front().title;
  return common::draw(plots, picture);
}

void write_files(const Plan& plan, const std::vector<JobResult>& results,
                 const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  write_file(folder / "fits.csv", [&](std::ostream& out) { write_table(plan, results, out); });
  if (results.size() > kMostFolders) return;
  const auto count = static_cast<int>(results.size());
  common::Progress progress(1, 1, "pictures and files");
  for (int k = 0; k < count; ++k) {
    const Job& job = plan.jobs[k];
    const JobResult& result = results[k];
    progress.show(static_cast<double>(k) / count, job.title());
    if (!result.error.empty()) continue;
    const std::filesystem::path own = count == 1 ? folder : folder / folder_name(job.title());
    std::filesystem::create_directories(own);
    write_file(own / "material.yaml", [&](std::ostream& out) { write_material(job, result, out); });
    write_file(own / "samples.csv", [&](std::ostream& out) { write_samples(result, out); });
    draw_fit(job, result, own / "fit.png");
  }
  progress.finish(true, folder.string());
}

}  // namespace palpate::fit
