#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "tools/lab/studies/study_tables.hpp"

namespace palpate::studies {

/// Contents of the report.
struct StudyReport {
  std::string name;   // of the study, and of its JSON file
  std::string title;  // of its page
  StudyPlan plan;
  std::vector<StudyResult> results;
  std::vector<std::string> failures;  // failed jobs, with their last output
  nlohmann::json host;                // describe_host() and how the jobs were run
  std::filesystem::path folder;       // of the jobs' folders
};

/// Summary tables as text.
void print_study(const StudyReport& report, std::ostream& out);

/// One page with tables, plots and the images of each application's first seed. Plots are drawn
/// next to it if gnuplot is installed.
std::string study_page(const StudyReport& report);

/// Writes report.html, runs.csv, states.csv and a JSON file with the study's name to the report's
/// folder. Throws std::runtime_error if one cannot be written.
void write_study(const StudyReport& report);

}  // namespace palpate::studies
