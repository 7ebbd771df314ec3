#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "rt/config/node.hpp"
#include "tools/fit/experiment.hpp"

namespace palpate::fit {

/// Reads a recording's YAML; files are below the folder. Throws config::Error for wrong keys and
/// import::CsvError for wrong file contents.
using MakeExperiment = std::unique_ptr<Experiment> (*)(const config::Node& node,
                                                       const std::filesystem::path& folder);

/// A kind of experiment, as `kind:` of a recording names it.
struct Kind {
  std::string name;
  std::string summary;  // one line for --help
  MakeExperiment make;
};

/// All kinds.
const std::vector<Kind>& kinds();

/// The experiment of the recording's `kind`. Unused keys are left to the caller's check_all_used().
/// Throws as MakeExperiment does.
std::unique_ptr<Experiment> make_experiment(const config::Node& node,
                                            const std::filesystem::path& folder);

}  // namespace palpate::fit
