#pragma once

#include <filesystem>

#include "rt/config/node.hpp"
#include "tools/common/process.hpp"
#include "tools/lab/faults/result.hpp"
#include "tools/lab/runs/operator.hpp"

namespace palpate::faults {

/// Temporary folder of one run, deleted with this object.
class FaultFolder {
 public:
  FaultFolder();
  ~FaultFolder();
  FaultFolder(const FaultFolder&) = delete;
  FaultFolder& operator=(const FaultFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// `overrides` plus settings that separate a busy machine's delays from the fault.
std::vector<std::string> patient(std::vector<std::string> overrides);

/// Starts palpated with that configuration and these ports; its output goes to palpated.txt in
/// `folder`.
common::Process start_palpated(const config::Node& configuration, const runs::Urls& urls,
                               const std::filesystem::path& folder);

/// palpate-sim, running with palpated, is killed while the loop is closed, and restarted.
faults::Row killed_simulator_row();

}  // namespace palpate::faults
