#include "tools/collect/collection.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>

#include "tools/collect/localise.hpp"
#include "tools/log/log_reader.hpp"
#include "tools/recordings/csv_reader.hpp"

#include <palpate/biotac_t.hpp>
#include <palpate/ft_wrench_t.hpp>

namespace palpate::collect {
namespace {

class Collection : public ::testing::Test {
 protected:
  Collection()
      : folder_(std::filesystem::temp_directory_path() /
                ("palpate-collect-" + std::to_string(getpid()))),
        trials_(make_trials(Profiles::kExtended)),
        bench_(sensors::read_sensors(config::Node::from_text("{}")), 4, {0.2}) {
    std::filesystem::create_directories(folder_);
  }
  ~Collection() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void collect(CollectionFile& file, int first, int count) const {
    for (int i = first; i < first + count; ++i) file.add(trials_[i], bench_.run(trials_[i]));
  }
  static std::string text(const std::string& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  std::filesystem::path folder_;
  std::vector<Trial> trials_;
  Bench bench_;
};

TEST_F(Collection, ForceTorqueReadsWhatTheProfileHolds) {
  const std::vector<Sample> samples = bench_.run(trials_[0]);
  ASSERT_EQ(samples.size(), 480u);
  EXPECT_NEAR(samples[30].wrench.head<3>().norm(), 0, 0.15);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (int k = 100; k < 300; ++k) mean += samples[k].wrench.head<3>() / 200;
  EXPECT_NEAR(mean.norm(), trials_[0].profile.force, 0.02);
  // On the probe: out of the finger.
  const Eigen::Vector3d at = sensing::project_on_skin(sensing::area_centres().col(0));
  EXPECT_GT(mean.normalized().dot(sensing::skin_normal(at)), 0.95);
  EXPECT_GT(samples[200].biotac.pdc - samples[30].biotac.pdc, 15);
}

TEST_F(Collection, ResumedFileIsThatOfOneGo) {
  collect(*open_collection(path("whole.csv"), false), 0, 3);
  collect(*open_collection(path("parts.csv"), false), 0, 2);
  const auto file = open_collection(path("parts.csv"), true);
  ASSERT_EQ(file->trials(), 2);
  collect(*file, 2, 1);
  EXPECT_EQ(text(path("whole.csv")), text(path("parts.csv")));

  std::filesystem::resize_file(path("whole.csv"), text(path("whole.csv")).size() - 5);
  EXPECT_THROW(open_collection(path("whole.csv"), true), std::runtime_error);
  EXPECT_THROW(open_collection(path("a.log"), true), std::invalid_argument);
}

TEST_F(Collection, LogHoldsTheSameReadings) {
  collect(*open_collection(path("a.log"), false), 0, 2);
  const std::vector<Sample> samples = bench_.run(trials_[1]);
  log::LogReader reader(log::LogClock::kSent);
  std::vector<biotac_t> touches;
  std::vector<ft_wrench_t> wrenches;
  reader.collect("BIOTAC_0", touches);
  reader.collect("FT_WRENCH", wrenches);
  reader.read(path("a.log"));
  EXPECT_EQ(reader.undecodable(), 0);
  ASSERT_EQ(touches.size(), 2 * samples.size());
  ASSERT_EQ(wrenches.size(), touches.size());
  EXPECT_GT(touches[480].utime - touches[479].utime, 1000000);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    EXPECT_EQ(touches[480 + k].electrodes[7], samples[k].biotac.electrodes[7]);
    EXPECT_EQ(wrenches[480 + k].wrench[4], samples[k].wrench[4]);
  }
}

TEST_F(Collection, LocalisationIsScoredWhereTheForceIsStrong) {
  const auto file = open_collection(path("a.csv"), false);
  std::size_t strong = 0;
  for (std::size_t i = 0; i < trials_.size(); i += 35) {
    const std::vector<Sample> samples = bench_.run(trials_[i]);
    file->add(trials_[i], samples);
    for (const Sample& sample : samples) strong += sample.wrench.head<3>().norm() > 0.5;
  }
  const auto errors = score_localisation(path("a.csv"), {}, 0.5);
  ASSERT_EQ(errors.size(), 3u);
  for (const LocalisationErrors& e : errors) {
    EXPECT_GT(e.samples, 1000);
    EXPECT_LE(e.samples, static_cast<long>(strong));
    EXPECT_LT(e.median, 5e-3);
    EXPECT_GT(e.area_rate, 2.0 / 9);
  }
  EXPECT_LE(errors[0].absolute.norm(), 1.05 * errors[1].absolute.norm());

  std::ofstream(path("bad.csv"), std::ios::app) << "trial,area,t,fx\n";
  EXPECT_THROW(score_localisation(path("bad.csv"), {}, 0.5), recordings::CsvError);
}

}  // namespace
}  // namespace palpate::collect
