#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>
#include <vector>

#include "tools/lab/faults/campaign.hpp"

namespace palpate::faults {

/// The table: outcomes, times to detect and to recover, each row's bound with the measured value,
/// every miss with its row and seed, and how many seeds survived.
void print_faults(const std::vector<faults::RowReport>& reports, std::ostream& out);

nlohmann::json faults_json(const std::vector<faults::RowReport>& reports);

/// Throws std::runtime_error if it cannot be written.
void write_faults_csv(const std::vector<faults::RowReport>& reports,
                      const std::filesystem::path& file);

/// A matrix of faults by outcome, coloured by outcome, with an intensity by the share of the seeds.
/// Returns false without drawing if gnuplot is not installed; throws std::runtime_error if it
/// fails.
bool draw_faults(const std::vector<faults::RowReport>& reports,
                 const std::filesystem::path& picture);

}  // namespace palpate::faults
