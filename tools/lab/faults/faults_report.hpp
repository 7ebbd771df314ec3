#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>
#include <vector>

#include "tools/lab/faults/campaign.hpp"

namespace palpate::faults {

/// The table: outcomes, times to detect and to recover, each row's figure beside what was met,
/// every miss with its number and seed, and how many seeds survived.
void print_faults(const std::vector<faults::RowReport>& reports, std::ostream& out);

nlohmann::json faults_json(const std::vector<faults::RowReport>& reports);

/// Throws std::runtime_error where it cannot be written.
void write_faults_csv(const std::vector<faults::RowReport>& reports,
                      const std::filesystem::path& file);

/// A matrix, faults by outcome, coloured by outcome, each field as strong as its share of the
/// seeds. False, having drawn nothing, where gnuplot is not installed; throws std::runtime_error
/// where it fails.
bool draw_faults(const std::vector<faults::RowReport>& reports,
                 const std::filesystem::path& picture);

}  // namespace palpate::faults
