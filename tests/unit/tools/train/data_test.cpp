#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "tools/recordings/csv_reader.hpp"
#include "tools/recordings/errors.hpp"
#include "tools/recordings/recording_table.hpp"
#include "tools/recordings/ridge.hpp"
#include "tools/recordings/wrist_data.hpp"

namespace palpate::train {
namespace {

using ::testing::HasSubstr;

class RecordingFile {
 public:
  explicit RecordingFile(const std::string& text)
      : path_((std::filesystem::temp_directory_path() /
               ("palpate-train-" + std::to_string(getpid()) + ".csv"))
                  .string()) {
    std::ofstream(path_) << text;
  }
  ~RecordingFile() { std::filesystem::remove(path_); }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

std::string complaint(const std::string& text) {
  const RecordingFile file(text);
  try {
    recordings::read_tables(file.path(), "t", {"a"}, "");
  } catch (const recordings::CsvError& error) {
    return error.what();
  }
  return "";
}

TEST(ReadTables, NamesFileLineAndColumnOfWhatIsWrong) {
  EXPECT_THAT(complaint("t,a\n0,1\n1,nan\n2,3\n"), HasSubstr(".csv:3:a: 'nan' is not finite"));
  EXPECT_THAT(complaint("t,a\n0,1\n1,\n"), HasSubstr(".csv:3:a: '' is not a number"));
  EXPECT_THAT(complaint("t,a\n0,1\n1\n"), HasSubstr(".csv:3: has 1 cells"));
  EXPECT_THAT(complaint("t,b\n0,1\n"), HasSubstr("no column 'a'"));
  EXPECT_THAT(complaint("t,a\n0,1\n2,1\n1,1\n"), HasSubstr(".csv:4:t: time runs backwards"));
  EXPECT_THAT(complaint("t,a\n0,1\n"), HasSubstr("fewer than two rows"));
  EXPECT_THAT(complaint(""), HasSubstr("empty"));
}

TEST(ReadTables, SeparatesRecordings) {
  const RecordingFile file("run,t,a\nx,5,1\nx,6,2\ny,0,3\ny,1,4\ny,2,5\n");
  const std::vector<recordings::Table> tables =
      recordings::read_tables(file.path(), "t", {"a"}, "run");
  ASSERT_EQ(tables.size(), 2u);
  EXPECT_EQ(tables[0].time[1], 1);  // from 0
  EXPECT_EQ(tables[1].rows(2, 0), 5);
  EXPECT_THAT(tables[1].name, HasSubstr(":y"));
}

TEST(Resample, HoldsOrAveragesWhatCameBefore) {
  recordings::Table table;
  table.time = Eigen::VectorXd::LinSpaced(11, 0, 1);
  table.rows = Eigen::VectorXd::LinSpaced(11, 0, 10);
  const recordings::Table held = recordings::resample(table, 4, 0);
  ASSERT_EQ(held.rows.rows(), 5);
  EXPECT_EQ(held.rows(1, 0), 2);  // at 0.25 s: the sample of 0.2 s
  EXPECT_EQ(held.rows(4, 0), 10);
  const recordings::Table mean = recordings::resample(table, 5, 0.3);
  EXPECT_EQ(mean.rows(0, 0), 0);
  EXPECT_NEAR(mean.rows(5, 0), 9, 1e-12);  // of 0.8, 0.9 and 1 s
}

TEST(IdentifyDelay, FindsAFractionOfASampleUnderNoise) {
  const double rate = 1000, delay = 0.0123;
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 0.02);
  Eigen::MatrixXd reference(4000, 2), signal(4000, 2);
  const auto motion = [](double t) {
    return Eigen::RowVector2d(std::sin(5 * t) + 0.4 * std::sin(17 * t), std::cos(3 * t));
  };
  for (Eigen::Index k = 0; k < 4000; ++k) {
    const double t = static_cast<double>(k) / rate;
    const Eigen::RowVector2d noise(normal(random), normal(random));
    reference.row(k) = motion(t);
    signal.row(k) = 3 * motion(t - delay) + noise + Eigen::RowVector2d(7, -2);
  }
  const recordings::DelayFit later = recordings::identify_delay(reference, signal, rate, 0.1);
  EXPECT_NEAR(later.seconds, delay, 1e-3);
  EXPECT_GT(later.correlation, 0.99);
  EXPECT_NEAR(recordings::identify_delay(signal, reference, rate, 0.1).seconds, -delay, 1e-3);
  EXPECT_THROW(recordings::identify_delay(reference, signal, rate, 2), std::invalid_argument);
}

TEST(DelayColumns, UndoesADelay) {
  recordings::Table table;
  table.time = Eigen::VectorXd::LinSpaced(101, 0, 1);
  table.rows.resize(101, 2);
  table.rows.col(0) = table.time;
  table.rows.col(1) = table.time;
  recordings::delay_columns(table, 1, 1, 0.025);
  EXPECT_NEAR(table.rows(50, 1), 0.475, 1e-12);
  EXPECT_NEAR(table.rows(50, 0), 0.5, 1e-12);
  EXPECT_EQ(table.rows(0, 1), 0);
}

TEST(Ridge, FindsALinearMapAndShrinksWhereNoiseOutnumbersRows) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto noise = [&](Eigen::Index rows, Eigen::Index cols) {
    Eigen::MatrixXd m(rows, cols);
    for (Eigen::Index i = 0; i < m.size(); ++i) m.data()[i] = normal(random);
    return m;
  };
  const Eigen::MatrixXd map = noise(2, 4);
  const Eigen::MatrixXd x = noise(200, 4);
  const Eigen::MatrixXd y = (x * map.transpose()).rowwise() + Eigen::RowVector2d(3, -1);
  const recordings::Ridge exact = recordings::fit_ridge(x, y, {1e-9, 1e-3, 1});
  EXPECT_EQ(exact.penalty[0], 1e-9);
  EXPECT_LT((exact.matrix - map).norm(), 1e-6);
  EXPECT_NEAR(exact.offset[0], 3, 1e-6);
  const recordings::Ridge noisy =
      recordings::fit_ridge(noise(40, 20), noise(40, 1), {1e-9, 1e-3, 100});
  EXPECT_EQ(noisy.penalty[0], 100);
  EXPECT_THROW(recordings::fit_ridge(x.topRows(5), y.topRows(5), {1}), std::invalid_argument);
}

TEST(Errors, AreThoseOfTheirDefinition) {
  Eigen::MatrixXd truth(2, 3), predicted(2, 3);
  truth << 1, 0, 0, 0, 1, 0;
  predicted << 0, 1, 0, 0, 2, 0;
  recordings::ColumnGroup group;
  group.columns = {"x", "y", "z"};
  group.is_direction = true;
  const recordings::Errors errors = recordings::measure_errors(predicted, truth, {group});
  EXPECT_NEAR(errors.rms[1], 1, 1e-12);
  EXPECT_NEAR(errors.mean_absolute[0], 0.5, 1e-12);
  EXPECT_NEAR(errors.norms[0], std::sqrt(1.5), 1e-12);
  EXPECT_NEAR(errors.correlation[1], 1, 1e-12);
  EXPECT_EQ(errors.correlation[2], 0);
  EXPECT_NEAR(errors.median_angle[0], 0, 1e-12);  // of 90 degrees and 0
  EXPECT_THROW(recordings::measure_errors(predicted, truth.topRows(1), {group}),
               std::invalid_argument);
}

}  // namespace
}  // namespace palpate::train
