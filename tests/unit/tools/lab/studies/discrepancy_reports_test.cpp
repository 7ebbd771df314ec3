#include "tools/lab/studies/discrepancy_reports.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tools/lab/studies/discrepancy_ranking.hpp"

namespace palpate::studies {
namespace {

constexpr std::int64_t kSecond = 1000000;

/// Three seconds of estimates that doubt nothing, at 100 Hz.
log::RunLog quiet_log() {
  log::RunLog log;
  for (int i = 0; i < 300; ++i) {
    estimate_t estimate{};
    estimate.utime = 10000 * i;
    estimate.unknown_contact_deviation = -1;
    log.estimates.push_back(estimate);
  }
  return log;
}

/// Degrades the estimates between two times and gives their reason in HEALTH.
void degrade(log::RunLog& log, double from, double until, const char* reason) {
  for (estimate_t& estimate : log.estimates) {
    const double time = 1e-6 * static_cast<double>(estimate.utime);
    if (time < from || time >= until) continue;
    estimate.status = estimate_t::STATUS_DEGRADED;
    health_t health{};
    health.utime = estimate.utime;
    health.state = health_t::STATE_DEGRADED;
    std::strcpy(reinterpret_cast<char*>(health.reason), reason);
    log.health.push_back(health);
  }
}

discrepancy_t discrepancy_at(double time, bool inconsistent, std::vector<int> causes = {}) {
  discrepancy_t message{};
  message.utime = std::llround(1e6 * time);
  message.inconsistent = inconsistent ? 1 : 0;
  for (const int cause : causes) message.cause[message.cause_count++] = cause;
  return message;
}

TEST(DoubtReports, ADegradedEstimateIsOneForAsLongAsItLasts) {
  log::RunLog log = quiet_log();
  degrade(log, 1, 1.5, "the force of hand 0 along x contradicts the model");
  degrade(log, 2, 2.5, "nothing explains the wrench of the hand");
  const std::vector<DoubtReport> reports = doubt_reports(log, 0);
  ASSERT_EQ(reports.size(), 2u);
  EXPECT_EQ(reports[0].begin, kSecond);
  EXPECT_EQ(reports[0].end, 1490000);
  EXPECT_EQ(reports[0].reason, "the force of hand 0 along x contradicts the model");
  EXPECT_EQ(reports[1].reason, "nothing explains the wrench of the hand");
  EXPECT_TRUE(is_reported(reports, 1200000));
  EXPECT_FALSE(is_reported(reports, 1700000));
  EXPECT_EQ(reported_at(reports, 1700000), &reports[1]);
  EXPECT_EQ(reported_at(reports, 2600000), nullptr);
}

TEST(DoubtReports, FailingInputsAndSolversAreNone) {
  for (const char* reason : {"pose of the hand is stale", "no pose of the hand yet",
                             "deformation model does not converge",
                             "force-torque reading is too old", "the loop runs late"}) {
    log::RunLog log = quiet_log();
    degrade(log, 1, 2, reason);
    EXPECT_TRUE(doubt_reports(log, 0).empty()) << reason;
  }
}

TEST(DoubtReports, ATrackedExternalContactIsOne) {
  log::RunLog log = quiet_log();
  for (std::size_t i = 50; i < 80; ++i) log.estimates[i].unknown_contact_deviation = 0.2;
  std::vector<DoubtReport> reports = doubt_reports(log, 0);
  ASSERT_EQ(reports.size(), 1u);
  EXPECT_EQ(reports[0].begin, 500000);
  EXPECT_EQ(reports[0].reason, kExternalContact);

  log = quiet_log();
  for (int i = 0; i <= 40; ++i) {
    unknown_contact_t contact{};
    contact.utime = kSecond + 10000 * i;
    contact.force_deviation = i < 40 ? 0.1 : -1;
    log.unknown_contacts.push_back(contact);
  }
  reports = doubt_reports(log, 0);
  ASSERT_EQ(reports.size(), 1u);
  EXPECT_EQ(reports[0].end, 1390000);
}

TEST(DoubtReports, AnInconsistentDiscrepancyIsOneAndReasonsAreJoined) {
  log::RunLog log = quiet_log();
  log.discrepancies = {discrepancy_at(0.5, false), discrepancy_at(1, true),
                       discrepancy_at(1.2, false)};
  EXPECT_EQ(doubt_reports(log, 0).at(0).end, 1190000);
  EXPECT_EQ(doubt_reports(log, 0).at(0).reason, "inconsistent wrenches");
  degrade(log, 1.1, 1.4, "the force of hand 0 along x contradicts the model");
  for (std::size_t i = 130; i < 160; ++i) log.estimates[i].unknown_contact_deviation = 0.2;
  const std::vector<DoubtReport> reports = doubt_reports(log, 0);
  ASSERT_EQ(reports.size(), 1u) << "they overlap";
  EXPECT_EQ(reports[0].end, 1590000);
  EXPECT_EQ(reports[0].reason,
            "inconsistent wrenches; the force of hand 0 along x contradicts the model; external "
            "contact");
}

TEST(DoubtReports, WhatBeginsEarlierBeginsAtTheStart) {
  log::RunLog log = quiet_log();
  degrade(log, 0, 1.5, "contradicts the model");
  EXPECT_EQ(doubt_reports(log, kSecond).at(0).begin, kSecond);
  EXPECT_TRUE(doubt_reports(log, 2 * kSecond).empty());
}

TEST(DiscrepancyRanking, IsTheLastOneUntilThen) {
  using Message = discrepancy_t;
  log::RunLog log = quiet_log();
  log.discrepancies = {discrepancy_at(0.5, true, {Message::CAUSE_CLAMP_PLACE}),
                       discrepancy_at(1, true, {Message::CAUSE_SLIP, Message::CAUSE_CONTACT}),
                       discrepancy_at(2, false)};
  const auto ranking = [&log](double from, double until) {
    return ranking_at(log, doubt_reports(log, 0), std::llround(1e6 * from),
                      std::llround(1e6 * until));
  };
  EXPECT_EQ(ranking(0, 0.7), (std::vector<int>{Message::CAUSE_CLAMP_PLACE}));
  EXPECT_EQ(ranking(0, 2.5), (std::vector<int>{Message::CAUSE_SLIP, Message::CAUSE_CONTACT}));
  EXPECT_TRUE(ranking(0, 0.4).empty());
  EXPECT_TRUE(ranking(0.6, 0.9).empty()) << "of an earlier discrepancy";
}

TEST(DiscrepancyRanking, ATrackedContactIsTheContactWhileNothingIsRanked) {
  log::RunLog log = quiet_log();
  for (std::size_t i = 100; i < 200; ++i) log.estimates[i].unknown_contact_deviation = 0.2;
  const std::vector<DoubtReport> reports = doubt_reports(log, 0);
  EXPECT_TRUE(ranking_at(log, reports, 0, 900000).empty());
  EXPECT_EQ(ranking_at(log, reports, 0, 1500000), std::vector<int>{discrepancy_t::CAUSE_CONTACT});
  EXPECT_TRUE(ranking_at(log, reports, 2500000, 2800000).empty());
  log.discrepancies = {discrepancy_at(1.2, true, {discrepancy_t::CAUSE_WEIGHT})};
  EXPECT_EQ(ranking_at(log, reports, 0, 1500000), std::vector<int>{discrepancy_t::CAUSE_WEIGHT});
}

TEST(DiscrepancyRanking, EveryKindHasItsCause) {
  EXPECT_EQ(cause_name(cause_of("table")), "contact");
  EXPECT_EQ(cause_name(cause_of("cylinder")), "contact");
  EXPECT_EQ(cause_name(cause_of("wall")), "contact");
  EXPECT_EQ(cause_name(cause_of("slip")), "slip");
  EXPECT_EQ(cause_name(cause_of("shifted clamp")), "clamp place");
  EXPECT_EQ(cause_name(cause_of("sprung clamp")), "clamp compliance");
  EXPECT_EQ(cause_name(cause_of("stiffer half")), "uneven stiffness");
  EXPECT_EQ(cause_name(cause_of("weight")), "weight");
  EXPECT_EQ(cause_name(cause_of("none")), "unknown");
  EXPECT_EQ(cause_name(99), "unknown");
}

}  // namespace
}  // namespace palpate::studies
