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

/// The errors_table() of each application that has results, as text. `cap`: mm.
void print_errors(const StudyReport& report, double cap, std::ostream& out);

/// Writes runs.csv, states.csv and a JSON file with the study's name, which holds all tables and
/// results, to the report's folder. Throws std::runtime_error if one cannot be written.
void write_study(const StudyReport& report);

/// Makes report.html, one page with tables, plots and the images of each application's first seed,
/// from the files of write_study(), by tools/lab/report/report_study below `root`. Returns one or
/// more lines that name the files written and, if there is no page, what prevented it, such as a
/// missing Python package; an earlier page is then deleted. Throws Interrupted.
std::string make_page(const StudyReport& report, const std::filesystem::path& root);

}  // namespace palpate::studies
