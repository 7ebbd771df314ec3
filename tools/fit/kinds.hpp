#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "rt/config/node.hpp"
#include "tools/fit/experiment.hpp"

namespace palpate::fit {

/// Reads a recording's YAML; files lie below the folder. Throws config::Error for wrong keys and
/// import::CsvError for what a file holds.
using MakeExperiment = std::unique_ptr<Experiment> (*)(const config::Node& node,
                                                       const std::filesystem::path& folder);

/// A kind of experiment, as `kind:` of a recording names it.
struct Kind {
  std::string name;
  std::string summary;  // one line for --help
  MakeExperiment make;
};

/// Every kind there is.
const std::vector<Kind>& kinds();

/// The experiment of the recording's `kind`. Keys that nobody asked for are left to the caller's
/// check_all_used(). Throws as MakeExperiment does.
std::unique_ptr<Experiment> make_experiment(const config::Node& node,
                                            const std::filesystem::path& folder);

}  // namespace palpate::fit
