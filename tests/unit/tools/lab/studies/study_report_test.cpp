#include "tools/lab/studies/study_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "sim/draw/image.hpp"
#include "tests/unit/tools/lab/studies/study_folder.hpp"
#include "tools/lab/studies/study_host.hpp"

namespace palpate::studies {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kNasty = "a <script>\"b\" & 'c', d";

Json state(const std::string& name, double mean) {
  return {{"name", name},
          {"mean_mm", mean},
          {"max_mm", 2 * mean},
          {"octree_truth_in_estimate", 0.75},
          {"measured", "truth surface"},
          {"picture", "state.png"}};
}

StudyResult result(const std::string& application, const std::string& method, int seed,
                   const Json& states) {
  StudyResult result;
  result.job.name = "job_" + std::to_string(seed);
  result.job.application = application;
  result.job.kind = "control";
  result.job.method = method;
  result.job.mismatch = "none";
  result.job.seed = seed;
  result.json = {{"job",
                  {{"name", result.job.name},
                   {"application", application},
                   {"method", method},
                   {"model_error", "none"},
                   {"seed", seed}}},
                 {"states", states},
                 {"score", {{"feature", {{"error_mm", 3.0}, {"time_to_5mm_s", nullptr}}}}}};
  return result;
}

/// One application of two methods; the second has no result.
StudyReport canned() {
  StudyReport report;
  report.name = "thesis";
  report.title = "the applications of the thesis";
  StudyApplication application;
  application.name = kNasty;
  application.kind = "control";
  application.methods = {{"first", {}}, {"second", {}}};
  application.levels = {{"none", "", {}, {}, {}, {}}};
  application.published = {{"error of <Fig. 4.15>", "not available"}};
  report.plan.octree_resolution = 0.01;
  report.plan.applications = {application};
  report.results = {result(kNasty, "first", 1, {state("P1", 1.0), state("P2", 3.0)}),
                    result(kNasty, "first", 2, {state("P1", 2.0), state("P2", 6.0)}),
                    result(kNasty, "second", 1, Json::array())};
  report.results[2].json = Json();
  report.failures = {"job_3: exit code 1:\n<b>what happened</b>"};
  report.host = describe_host();
  return report;
}

TEST(StudyTables, SummaryIsOverStatesAndThenOverSeeds) {
  const StudyReport report = canned();
  const ReportTable table = summary_table(report.plan.applications[0], report.results);
  ASSERT_EQ(table.rows.size(), 3u);
  const std::vector<std::string>& first = table.rows[1];
  EXPECT_EQ(first[1], "3.00 (2.00 to 4.00)");   // means 2 and 4
  EXPECT_EQ(first[5], "9.00 (6.00 to 12.00)");  // maxima 6 and 12
  EXPECT_EQ(first[10], "75.0 (75.0 to 75.0)");  // %
  EXPECT_EQ(first[13], "not available");        // latency, which lock-step does not provide
  EXPECT_EQ(first.back(), "2");
  EXPECT_EQ(table.rows[2][1], "not available");  // the second method has no result
  EXPECT_EQ(table.rows[2].back(), "0");
  EXPECT_EQ(first.size(), table.header.size());
}

TEST(StudyTables, ByStateTheMethodsStandSideBySide) {
  const StudyReport report = canned();
  const ReportTable table = state_table(report.plan.applications[0], report.results);
  ASSERT_EQ(table.rows.size(), 6u);
  EXPECT_THAT(table.rows[0][0], HasSubstr("P1"));
  EXPECT_EQ(table.rows[1][1], "1.50 (1.00 to 2.00)");
  EXPECT_EQ(table.rows[4][1], "4.50 (3.00 to 6.00)");
  EXPECT_EQ(table.rows[1].size(), table.header.size());
}

/// Ten draws of a distribution, with errors of 1 to 10 mm.
StudyReport ten_draws() {
  StudyReport report = canned();
  StudyApplication& application = report.plan.applications[0];
  application.levels.clear();
  report.results.clear();
  for (int i = 1; i <= 10; ++i) {
    const std::string name = "calibrated " + std::to_string(i);
    application.levels.push_back({name, "", {}, {}, "calibrated", {}});
    StudyResult one = result(kNasty, "first", 1, Json::array({state("P1", i)}));
    one.job.mismatch = name;
    one.job.family = "calibrated";
    one.json["draw"] = {{"name", name}};
    one.json["states"][0]["octree_truth_in_estimate"] = 0.1 * i;
    report.results.push_back(one);
  }
  return report;
}

TEST(StudyTables, DrawsAreOneRowOfMedianNineTenthsAndWorst) {
  const StudyReport report = ten_draws();
  const ReportTable table = summary_table(report.plan.applications[0], report.results);
  ASSERT_EQ(table.rows.size(), 3u);
  EXPECT_THAT(table.rows[0][0], HasSubstr("calibrated"));
  EXPECT_EQ(table.rows[1][1], "5.50; 9.00; 10.00");
  EXPECT_EQ(table.rows[1][10], "55.0; 20.0; 10.0") << "of a share the smallest is the worst";
  EXPECT_EQ(table.rows[1].back(), "10");
  const ReportTable states = state_table(report.plan.applications[0], report.results);
  ASSERT_EQ(states.rows.size(), 3u);
  EXPECT_EQ(states.rows[1][1], "5.50; 9.00; 10.00");
  StudyReport capped = ten_draws();
  for (StudyResult& one : capped.results) one.json["states"][0]["hausdorff_mm"] = 1;
  const ReportTable errors = errors_table(capped.plan.applications[0], capped.results, 8);
  ASSERT_EQ(errors.header.size(), 2u);
  EXPECT_EQ(errors.rows[0][1], "5.50; 8.00; 8.00 / 1.00; 1.00; 1.00");
}

TEST(StudyTables, ATimeThatNeverCameIsNotANumber) {
  StudyReport report = canned();
  const auto row = [&report] {
    return control_table(report.plan.applications[0], report.results).rows[1];
  };
  EXPECT_EQ(row()[6], "never");
  report.results[1].json["score"]["feature"]["time_to_5mm_s"] = 1.5;
  EXPECT_EQ(row()[6], "1.5, never in 1");
}

TEST(StudyTables, CsvQuotesWhatItHasTo) {
  std::ostringstream out;
  write_states_csv(canned().results, out);
  const std::string csv = out.str();
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 4);
  EXPECT_THAT(csv, HasSubstr("\"a <script>\"\"b\"\" & 'c', d\",control,first,none,1,P1,"));
}

TEST(StudyOverview, CountsWhatStayedAtItsTargetAndARunThatFailedAsOneThatDidNot) {
  StudyReport report = canned();
  for (StudyResult& result : report.results) result.job.target = runs::ControlTarget{};
  report.results[0].json["score"]["feature"]["time_to_5mm_s"] = 2.5;
  report.results[1].json["score"]["feature"]["time_to_5mm_s"] = 4.0;
  report.results[0].json["score"]["feature"]["time_to_2mm_s"] = 3.5;
  report.results[2].failed = true;
  const ReportTable table = overview_table(report.plan, report.results);
  ASSERT_EQ(table.rows.size(), 3u);
  const auto cell = [&table](int row, const std::string& header) {
    const auto column = std::find(table.header.begin(), table.header.end(), header);
    return table.rows[row].at(static_cast<std::size_t>(column - table.header.begin()));
  };
  EXPECT_THAT(cell(1, "5 mm and stays"), HasSubstr("100 %"));
  EXPECT_THAT(cell(1, "5 mm in 3 s"), HasSubstr("50 %"));
  EXPECT_THAT(cell(1, "2 mm in 3 s"), HasSubstr("0 %"));
  EXPECT_EQ(cell(1, "feature's error mm"), "3.00 (3.00 to 3.00)");
  EXPECT_EQ(cell(1, "runs"), "2");
  EXPECT_THAT(cell(2, "5 mm and stays"), HasSubstr("0 %"));
  EXPECT_EQ(cell(2, "feature's error mm"), common::kNotAvailable);
}

TEST(StudyOverview, ALineARunOfWhatItScored) {
  StudyReport report = canned();
  report.results[0].json["belief"] = {{"young_modulus_kpa", 25.5},
                                      {"curve", {{"time_s", {0.0, 1.0}}}}};
  report.results[2].failed = true;
  std::ostringstream out;
  write_runs_csv(report.results, out);
  const std::string csv = out.str();
  EXPECT_THAT(csv, HasSubstr("application,method,model_error,seed,outcome,version,inputs_hash,"
                             "belief/young_modulus_kpa,score/feature/error_mm\r\n"));
  EXPECT_THAT(csv, HasSubstr(",first,none,1,done," PALPATE_VERSION ",,25.5,3.0\r\n"));
  EXPECT_THAT(csv, HasSubstr(",first,none,2,done," PALPATE_VERSION ",,,3.0\r\n"));
  EXPECT_THAT(csv, HasSubstr(",second,none,1,failed," PALPATE_VERSION ",,,\r\n"));
}

TEST(StudyTables, AFailedReplayCountsAtTheCapWhichIsTheMostOfAny) {
  StudyReport report = canned();
  for (StudyResult& result : report.results)
    for (Json& state : result.json["states"]) state["hausdorff_mm"] = 100;
  report.results[2] = {report.results[2].job, {}, true};
  const ReportTable table = errors_table(report.plan.applications[0], report.results, 42);
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[0], (std::vector<std::string>{"first", "3.00 / 42.00"}));
  EXPECT_EQ(table.rows[1], (std::vector<std::string>{"second", "42.00 / 42.00"}));
  EXPECT_TRUE(errors_table(report.plan.applications[0], {}, 42).rows.empty());
}

TEST(StudyPage, NeedsNoOtherFile) {
  StudyFolder folder;
  StudyReport report = canned();
  report.folder = folder.file("out");
  std::filesystem::create_directories(report.folder / "job_1");
  draw::write_png(report.folder / "job_1/state.png", draw::Image(2, 2));
  write_study(report);
  EXPECT_THAT(make_page(report, PALPATE_SOURCE_DIR),
              HasSubstr("report.html, runs.csv, states.csv"));
  const std::string page = folder.read("out/report.html");
  EXPECT_THAT(page, HasSubstr("src=\"data:image/png;base64,iVBORw0KGgo"));
  EXPECT_THAT(page, Not(HasSubstr("src=\"job_1")));
  EXPECT_THAT(page, HasSubstr("octree resolution 10.0 mm"));
  EXPECT_THAT(page, HasSubstr("3.00 (2.00 to 4.00)"));
  EXPECT_THAT(page, Not(HasSubstr("<script>")));
  EXPECT_THAT(page, HasSubstr("a &lt;script&gt;&#34;b&#34; &amp; &#39;c&#39;, d"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("out/report_study.txt")));
}

TEST(StudyPage, WithoutItTheNumbersAreComplete) {
  StudyFolder folder;
  StudyReport report = canned();
  report.folder = folder.file("out");
  folder.write("out/report.html", "of an earlier run");
  write_study(report);
  const std::string said = make_page(report, folder.file("no programs here"));
  EXPECT_THAT(said, HasSubstr("no report.html: "));
  EXPECT_THAT(said, HasSubstr("report_study"));
  EXPECT_THAT(said, HasSubstr("runs.csv, states.csv and thesis.json are complete"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("out/report.html")));
  const Json written = Json::parse(folder.read("out/thesis.json"));
  EXPECT_EQ(written["runs"].size(), 2u);
  EXPECT_EQ(written["published"][0]["value"], "not available");
  EXPECT_EQ(written["failures"].size(), 1u);
  EXPECT_GT(written["host"]["cores"].get<int>(), 0);
  ASSERT_EQ(written["applications"].size(), 1u);
  EXPECT_EQ(written["applications"][0]["tables"][1]["title"], "Control");
}

}  // namespace
}  // namespace palpate::studies
