#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "tools/evaluate/thesis_tables.hpp"

namespace palpate::evaluate {

/// All that the report is made of.
struct ThesisReport {
  ThesisPlan plan;
  std::vector<ThesisResult> results;
  std::vector<std::string> failures;  // of jobs, with their last words
  nlohmann::json host;                // describe_host() and how the jobs were run
  std::filesystem::path folder;       // of the jobs' folders
};

/// Summary tables as text.
void print_thesis(const ThesisReport& report, std::ostream& out);

/// One page with tables, plots and the pictures of each application's first seed. Plots are drawn
/// next to it, where gnuplot is installed.
std::string thesis_page(const ThesisReport& report);

/// report.html, states.csv and thesis.json in the report's folder. Throws std::runtime_error where
/// one cannot be written.
void write_thesis(const ThesisReport& report);

}  // namespace palpate::evaluate
