#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/lab/studies/study_plan.hpp"

namespace palpate::studies {

/// The programs whose bytes a result depends on, in addition to this one.
std::vector<std::filesystem::path> study_programs();

/// 64-bit FNV-1a of a file's bytes, as text. Throws std::runtime_error if it cannot be read.
std::string hash_of_file(const std::filesystem::path& file);

/// Hash of everything that a job's result depends on: scene and configuration after overrides, the
/// files that they name, the programs (hashes as returned by hash_of_file), and the scoring
/// settings. Throws config::Error if scene or configuration is not YAML.
std::string hash_of_inputs(const StudyJob& job, const std::vector<std::string>& programs);

}  // namespace palpate::studies
