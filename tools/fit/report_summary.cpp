#include <algorithm>
#include <cmath>
#include <map>

#include "tools/common/table.hpp"
#include "tools/fit/report.hpp"

namespace palpate::fit {
namespace {

using common::number;
using common::Table;

constexpr std::size_t kMostRows = 60;  // more fits are reported by their medians alone

double median_of(std::vector<double> values) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

/// Summary of a fit; empty if there is nothing to report.
struct Figures {
  std::vector<double> modulus, poisson, percent, rmse, held_percent, held_errors;
  std::string unit;  // of rmse and held_errors

  void add(const Figures& other) {
    const auto append = [](std::vector<double>& to, const std::vector<double>& from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    append(modulus, other.modulus);
    append(poisson, other.poisson);
    append(percent, other.percent);
    append(rmse, other.rmse);
    append(held_percent, other.held_percent);
    append(held_errors, other.held_errors);
    unit = other.unit;
  }
};

/// Errors are those of the first series' quantity.
Figures figures_of(const JobResult& result) {
  Figures figures;
  if (!result.error.empty()) return figures;
  if (result.effective) {
    figures.modulus = {result.effective->young_modulus};
    const Estimate* const nu = result.fit.find("poisson_ratio");
    if (nu->standing == Standing::kEstimated) figures.poisson = {result.effective->poisson_ratio};
  }
  const std::string& quantity = result.fit.series.front().quantity;
  figures.unit = result.fit.series.front().unit;
  for (std::size_t s = 0; s < result.fit.series.size(); ++s) {
    const SeriesFit& f = result.fit.series[s];
    if (f.quantity != quantity) continue;
    if (f.fitted.count > 0) {
      figures.percent.push_back(f.fitted.percent);
      figures.rmse.push_back(f.fitted.rmse);
    }
    if (f.held_out.count == 0) continue;
    figures.held_percent.push_back(f.held_out.percent);
    const Series& series = result.problem->series_at(s);
    for (Eigen::Index i = 0; i < series.measured.size(); ++i)
      if (!result.problem->is_fitted(s, i))
        figures.held_errors.push_back(std::abs(f.predicted[i] - series.measured[i]));
  }
  return figures;
}

std::string percent_or_nothing(const std::vector<double>& values) {
  return values.empty() ? "" : number(median_of(values), 2);
}

std::vector<std::string> row_of(const std::string& title, const Figures& f,
                                const std::string& modulus_note, const std::string& poisson_note) {
  return {title,
          f.modulus.empty() ? "undetermined" : readable(median_of(f.modulus), "Pa"),
          modulus_note,
          f.poisson.empty() ? "" : number(median_of(f.poisson), 3),
          poisson_note,
          f.rmse.empty() ? "" : readable(median_of(f.rmse), f.unit),
          percent_or_nothing(f.percent),
          f.held_errors.empty() ? "" : readable(median_of(f.held_errors), f.unit),
          percent_or_nothing(f.held_percent)};
}

/// "spread 12 %" of several; quartiles of many.
std::string spread_of(std::vector<double> values, const std::string& unit) {
  if (values.size() < 2) return "";
  constexpr std::size_t kMany = 20;
  std::sort(values.begin(), values.end());
  if (values.size() >= kMany)
    return "quartiles " + readable(values[values.size() / 4], unit) + ", " +
           readable(values[3 * values.size() / 4], unit);
  double mean = 0, squares = 0;
  for (const double v : values) mean += v / static_cast<double>(values.size());
  for (const double v : values) squares += (v - mean) * (v - mean);
  const double deviation = std::sqrt(squares / static_cast<double>(values.size() - 1));
  return unit.empty() ? "spread " + number(deviation, 3)
                      : "spread " + number(100 * deviation / mean, 0) + " %";
}

/// The lines of one variant.
class Section {
 public:
  Section(const Plan& plan, const std::vector<JobResult>& results, std::string variant)
      : plan_(plan), results_(results), variant_(std::move(variant)) {
    for (std::size_t k = 0; k < plan.jobs.size(); ++k)
      if (plan.jobs[k].variant == variant_) members_.push_back(k);
  }

  void add_to(Table& table) {
    if (!variant_.empty()) table.section(variant_);
    for (const std::size_t k : members_) {
      const Figures figures = figures_of(results_[k]);
      const std::string& group = plan_.jobs[k].group;
      if (sizes_[group]++ == 0) groups_.push_back(group);
      by_group_[group].add(figures);
      all_.add(figures);
      if (members_.size() <= kMostRows) add_fit(table, k, figures);
    }
    for (const std::string& group : groups_) {
      if (sizes_[group] < 2) continue;
      const Figures& f = by_group_[group];
      table.add(row_of("median of " + std::to_string(sizes_[group]) + ": " + group, f,
                       spread_of(f.modulus, "Pa"), spread_of(f.poisson, "")));
    }
    if (groups_.size() > 1 && members_.size() <= kMostRows)
      table.add(row_of("median of all " + std::to_string(members_.size()), all_, "", ""));
  }

 private:
  void add_fit(Table& table, std::size_t k, const Figures& figures) const {
    const JobResult& result = results_[k];
    if (!result.error.empty()) {
      table.add({plan_.jobs[k].name, "failed"});
      return;
    }
    std::string modulus, poisson;
    if (result.effective) {
      const Estimate* const nu = result.fit.find("poisson_ratio");
      modulus = interval_text(result.effective->modulus_interval, "Pa");
      if (nu->standing == Standing::kEstimated)
        poisson = number(result.effective->poisson_interval[0], 3) + " to " +
                  number(result.effective->poisson_interval[1], 3);
    }
    table.add(row_of(plan_.jobs[k].name, figures, modulus, poisson));
  }

  const Plan& plan_;
  const std::vector<JobResult>& results_;
  std::string variant_;
  std::vector<std::size_t> members_;
  std::vector<std::string> groups_;
  std::map<std::string, Figures> by_group_;
  std::map<std::string, std::size_t> sizes_;
  Figures all_;
};

}  // namespace

void print_summary(const Plan& plan, const std::vector<JobResult>& results, std::ostream& out) {
  Table table({"fit", "E", "95 % interval", "nu", "95 % interval", "RMSE", "% of range",
               "held out: median |error|", "% of range"});
  std::vector<std::string> variants;
  for (const Job& job : plan.jobs)
    if (std::find(variants.begin(), variants.end(), job.variant) == variants.end())
      variants.push_back(job.variant);
  for (const std::string& variant : variants) Section(plan, results, variant).add_to(table);
  table.print(out);
}

}  // namespace palpate::fit
