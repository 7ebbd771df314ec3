#include "tools/fit/findings.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "tools/common/table.hpp"
#include "tools/fit/report.hpp"

namespace palpate::fit {
namespace {

/// The member's own parameters, extracted from the problem's by their names there.
Eigen::VectorXd values_of(const Member& member, const std::map<std::string, double>& values) {
  const std::vector<Parameter>& wanted = member.experiment->parameters();
  const std::string prefix = member.experiment->name() + ".";
  Eigen::VectorXd result(static_cast<Eigen::Index>(wanted.size()));
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    auto found = values.find(prefix + wanted[k].name);  // shared elsewhere, own parameter here
    if (found == values.end()) found = values.find(wanted[k].name);
    if (found == values.end()) found = values.find(wanted[k].name.substr(prefix.size()));
    result[static_cast<Eigen::Index>(k)] = found->second;
  }
  return result;
}

}  // namespace

void print_findings(const Job& job, const JobResult& result, std::ostream& out) {
  if (!result.error.empty()) return;
  const Problem& problem = *result.problem;
  const Eigen::VectorXd all = problem.values(result.fit.solution.coordinates);
  std::map<std::string, double> values;
  for (std::size_t p = 0; p < problem.parameters().size(); ++p) {
    values[problem.parameters()[p].name] = all[static_cast<Eigen::Index>(p)];
  }
  common::Table table({job.title(), "quantity", "measured", "predicted", "difference", "goal", ""});
  bool is_empty = true;
  for (const Member& member : problem.members()) {
    for (const Finding& f : member.experiment->findings(values_of(member, values))) {
      const double difference = f.predicted - f.measured;
      const bool is_met = f.is_bound ? difference < 0 : std::abs(difference) <= f.allowed;
      table.add({member.experiment->name(), f.what, readable(f.measured, f.unit),
                 readable(f.predicted, f.unit), readable(difference, f.unit),
                 f.is_bound      ? "less"
                 : f.allowed > 0 ? readable(f.allowed, f.unit)
                                 : "",
                 f.is_bound || f.allowed > 0 ? (is_met ? "met" : "MISSED") : ""});
      is_empty = false;
    }
  }
  if (is_empty) return;
  out << "\n";
  table.print(out);
}

}  // namespace palpate::fit
