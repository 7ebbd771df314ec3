#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "rt/config/node.hpp"
#include "tools/fit/fit.hpp"

namespace palpate::fit {

/// One fit of a plan: recordings that identify parameters jointly.
struct Job {
  std::string group;            // name in the plan
  std::string name;             // likewise, followed by the value of `each`
  std::string variant;          // empty: the plan has none
  bool is_one_of_many = false;  // by `each`: a failed one does not affect the others
  std::vector<config::Node> recordings;
  std::map<std::string, ParameterChange> parameters;
  FitOptions options;
  double effective_strain =
      0;  // largest strain of the co-rotational material; 0: all that is fitted

  /// "name, variant".
  std::string title() const;
};

/// The work of palpate-fit. In YAML:
///
///   name: foam
///   about: description, printed above the results
///   recording: {kind: uniaxial, ...}     # defaults of every recording
///   fits:                                # or `recordings:` alone, for one fit
///     - name: leap 1
///       group: leap       # medians and spread per group are reported too; optional
///       recordings:
///         - {file: a.csv.gz, own: [young_modulus], shared: [load_bias], held_out: true}
///       variants: [Ogden]    # only these; default: all
///       each: probe       # one fit for each number in this column of the first recording's file
///       parameters: {young_modulus: {start: 1e5, lower: 1e3, upper: 1e7}}   # or {known: 1e5}
///   variants:                            # each fit is run with each of them; optional
///     - {name: Ogden, recording: {model: ogden_1}, solver: {starts: 4}, parameters: {...}}
///   effective: {strain: 0.1}             # largest strain of the co-rotational E; default: all
///   solver: {loss: huber, loss_scale: 2, starts: 1, seed: 1, iterations: 200, profile: auto,
///            reweigh: true}
struct Plan {
  std::string name;
  std::string about;
  std::vector<Job> jobs;
  std::string hash;  // of the plan and all that was set over it
};

/// Throws config::Error, and import::CsvError if `each` cannot be read.
Plan read_plan(const config::Node& node, const std::filesystem::path& data);

}  // namespace palpate::fit
