#include "tools/lab/studies/poke_score.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/unit/tools/lab/scores/synthetic_run.hpp"

namespace palpate::studies {
namespace {

constexpr double kAt = 1, kEnd = 2.5;  // s, of the poke
constexpr double kFound = 1.09, kGone = 2.8;
const Eigen::Vector3d kPoint(0.2, 0.05, 0.2), kForce(0, 0, -0.5);

double share(double time) { return scenes::Poke{kAt, kEnd - kAt, kPoint, kForce}.share(time); }

/// The hand measures half of the poke; the estimate detects it late, 10 mm off and 0.1 N too small,
/// with a shape error of 8 mm until then and 1 mm after.
log::RunLog poked_run() {
  log::RunLog run =
      scores::synthetic_run([](const Eigen::Vector3d& p, double) { return p; },
                            [](const Eigen::Vector3d& p, double time) -> Eigen::Vector3d {
                              if (time < kAt || time > kEnd) return p;
                              return p + Eigen::Vector3d(0, 0, time < kFound ? 8e-3 : 1e-3);
                            },
                            4);
  for (int tick = 0; tick < 3900; ++tick) {
    const double time = 1e-3 * tick;
    if (tick % 10 == 0) {
      truth_contact_t contact = {};
      contact.utime = static_cast<std::int64_t>(time * 1e6);
      contact.grasp_count = 1;
      contact.grasp_quaternion[0][0] = 1;
      contact.grasp_wrench[0][2] = 3 + 0.25 * share(time);
      run.truth_contacts.push_back(contact);
    }
    estimate_t estimate = {};
    estimate.utime = static_cast<std::int64_t>(time * 1e6);
    const bool imagined = time > 3.2 && time < 3.4;
    const bool reported = (time >= kFound && time < kGone) || imagined;
    estimate.unknown_contact_deviation = reported ? 0.02 : -1;
    run.estimates.push_back(estimate);
    if (!reported) continue;
    unknown_contact_t contact = {};
    contact.utime = estimate.utime;
    contact.location_deviation = 0.01;
    contact.force_deviation = 0.02;
    for (int i = 0; i < 3; ++i) {
      contact.location[i] = kPoint[i] + (i == 0 ? 0.01 : 0);
      contact.force[i] = 0.8 * kForce[i];
    }
    run.unknown_contacts.push_back(contact);
  }
  return run;
}

registry::Frames frames() {
  registry::Frames frames;
  frames.X_EG.translation().z() = 0.3;
  frames.X_ES.translation().z() = 0.04;
  return frames;
}

TEST(PokeScore, ComparesReportsWithTheTruth) {
  const log::RunLog run = poked_run();
  const scenes::Poke poke{kAt, kEnd - kAt, kPoint, kForce};
  const PokeScores scores = score_pokes({poke}, run, scores::score_shape(run), frames());
  ASSERT_EQ(scores.pokes.size(), 1u);
  const PokeScore& score = scores.pokes[0];
  // 125 mN of 250: half of the ramp of 0.1 s.
  ASSERT_TRUE(score.felt);
  EXPECT_NEAR(*score.felt, 0.05, 1e-3);
  ASSERT_TRUE(score.found);
  EXPECT_NEAR(*score.found, 0.04, 2e-3);
  ASSERT_TRUE(score.gone);
  EXPECT_NEAR(*score.gone, kGone - kEnd, 2e-3);
  EXPECT_NEAR(score.place.value(), 0.01, 1e-6);
  EXPECT_NEAR(score.force.value(), 0.1, 1e-6);
  EXPECT_EQ(score.observable, 1.0);
  EXPECT_NEAR(score.before.worst, 0, 1e-6);
  EXPECT_NEAR(score.largest.worst, 8e-3, 1e-6);
  EXPECT_NEAR(score.half_second.value().worst, 1e-3, 1e-6);
  EXPECT_NEAR(score.second.value().mean, 1e-3, 1e-6);
  ASSERT_EQ(scores.false_alarms.size(), 1u);
  EXPECT_NEAR(scores.false_alarms[0], 3.2, 2e-3);
  EXPECT_NEAR(scores.quiet, 3.9 - (kEnd + 0.5 - kAt), 0.01);
  const nlohmann::json json = to_json(scores, 0.4);
  EXPECT_EQ(json["false_alarms"], 1);
  EXPECT_NEAR(json["each"][0]["half_second"]["worst_percent_of_length"].get<double>(), 0.25, 1e-4);
}

TEST(PokeScore, SaysWhatWasNeverFeltOrFound) {
  log::RunLog run = poked_run();
  for (truth_contact_t& contact : run.truth_contacts) contact.grasp_wrench[0][2] = 3;
  for (estimate_t& estimate : run.estimates) estimate.unknown_contact_deviation = -1;
  run.unknown_contacts.clear();
  const PokeScores scores =
      score_pokes({{kAt, kEnd - kAt, kPoint, kForce}}, run, scores::score_shape(run), frames());
  EXPECT_FALSE(scores.pokes[0].felt);
  EXPECT_FALSE(scores.pokes[0].found);
  EXPECT_FALSE(scores.pokes[0].place);
  EXPECT_FALSE(scores.pokes[0].half_second);
  EXPECT_TRUE(scores.false_alarms.empty());
  EXPECT_TRUE(to_json(scores, 0.4)["each"][0]["felt_ms"].is_null());
  run.truths.clear();
  EXPECT_THROW(score_pokes({}, run, {}, frames()), std::runtime_error);
}

TEST(PokeTable, CountsPokesOfAllSeedsAndNoneWhereThereAreNoPokes) {
  StudyApplication application;
  application.name = "poked";
  application.kind = "force";
  application.methods = {{"filter", {}}};
  application.levels = {{"none", "", {}, {}, {}, {}}};
  StudyResult result;
  result.job.application = "poked";
  result.job.method = "filter";
  result.job.mismatch = "none";
  result.json = nlohmann::json::object();
  EXPECT_TRUE(poke_table(application, {result}).rows.empty());
  const log::RunLog run = poked_run();
  result.json["pokes"] = to_json(
      score_pokes({{kAt, kEnd - kAt, kPoint, kForce}}, run, scores::score_shape(run), frames()),
      0.4);
  const ReportTable table = poke_table(application, {result, result});
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[1].size(), table.header.size());
  EXPECT_EQ(table.rows[1][1], "2 of 2");
  EXPECT_EQ(table.rows[1][3], "2 of 2");
  EXPECT_EQ(table.rows[1].back().substr(0, 4), "2 in");
  EXPECT_EQ(each_poke_table(application, {result}).rows.size(), 2u);
}

}  // namespace
}  // namespace palpate::studies
