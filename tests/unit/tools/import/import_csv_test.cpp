#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <palpate/biotac_t.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/imu_t.hpp>
#include <palpate/robot_state_t.hpp>

#include "rt/bus/event_log_reader.hpp"
#include "tests/support/recordings.hpp"
#include "tools/import/fields.hpp"
#include "tools/import/import_csv.hpp"
#include "tools/recordings/csv_reader.hpp"

namespace palpate::import {
namespace {

using testing::HasSubstr;

struct Event {
  std::int64_t timestamp = 0;
  std::string channel;
  std::vector<std::uint8_t> data;

  template <class Message>
  Message as() const {
    Message message{};
    EXPECT_EQ(message.decode(data.data(), 0, static_cast<int>(data.size())),
              static_cast<int>(data.size()));
    return message;
  }
};

std::vector<Event> read_log(const std::string& path) {
  bus::EventLogReader log(path);
  std::vector<Event> events;
  while (const bus::LoggedEvent* event = log.next())
    events.push_back({event->utime, event->channel, {event->data, event->data + event->size}});
  EXPECT_EQ(log.complaint(), "");
  return events;
}

class ImportCsv : public testing::Test {
 protected:
  ImportCsv() {
    const auto* const info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              ("palpate_import_" + std::string(info->name()) + "_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
    options_.input = (folder_ / "in.csv").string();
    options_.output = (folder_ / "out.lcmlog").string();
    options_.session = 42;
  }
  ~ImportCsv() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& text) { std::ofstream(options_.input) << text; }

  void use(const std::string& format, const std::map<std::string, std::string>& columns = {}) {
    options_.streams = {{"CHANNEL", format, columns}};
  }

  /// Error text of import_csv; "" if there is none.
  std::string complaint() {
    try {
      import_csv(options_);
    } catch (const std::exception& error) {
      EXPECT_TRUE(std::filesystem::is_empty(folder_) || !std::filesystem::exists(options_.output));
      EXPECT_FALSE(std::filesystem::exists(options_.output + ".part"));
      return error.what();
    }
    return "";
  }

  std::filesystem::path folder_;
  ImportOptions options_;
};

TEST_F(ImportCsv, WritesTimesSequenceAndSession) {
  write("t,fx,fy,fz,tx,ty,tz\n0.5,1,2,3,4,5,6\n0.501,-1,0,0,0,0,1e-3\n");
  use("force_torque");
  options_.start = 10;
  const ImportSummary summary = import_csv(options_);
  EXPECT_EQ(summary.rows, 2);
  EXPECT_EQ(summary.messages.at("CHANNEL"), 2);
  const std::vector<Event> events = read_log(options_.output);
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[1].channel, "CHANNEL");
  EXPECT_EQ(events[1].timestamp, 10501000);
  const auto message = events[1].as<ft_wrench_t>();
  EXPECT_EQ(message.utime, 10501000);
  EXPECT_EQ(message.seq, 1);
  EXPECT_EQ(message.session, 42);
  EXPECT_EQ(message.wrench[0], -1);
  EXPECT_EQ(message.wrench[5], 1e-3);
}

TEST_F(ImportCsv, MapsColumnsUnitsSignsAndConstants) {
  write("stamp,acc_a,acc_b,gyro\n1000,1,-2,90\n");
  use("imu", {{"ax", "-acc_b:g"}, {"ay", "acc_a:g"}, {"az", "=0.5"}, {"wz", "-gyro:deg/s"}});
  options_.time_column = "stamp";
  options_.time_unit = "us";
  import_csv(options_);
  const auto message = read_log(options_.output).at(0).as<imu_t>();
  EXPECT_EQ(message.utime, 1000);
  EXPECT_NEAR(message.acceleration[0], 2 * 9.80665, 1e-12);
  EXPECT_NEAR(message.acceleration[1], 9.80665, 1e-12);
  EXPECT_EQ(message.acceleration[2], 0.5);
  EXPECT_EQ(message.angular_velocity[0], 0);
  EXPECT_NEAR(message.angular_velocity[2], -M_PI / 2, 1e-12);
}

TEST_F(ImportCsv, FillsARobotState) {
  write("t,px,py,pz,qw,qx,qy,qz,vz,wx,j1,j2\n0,1,2,3,0,1,0,0,0.1,0.2,90,-45\n");
  use("robot_state", {{"q1", "j1:deg"}, {"q2", "j2:deg"}});
  import_csv(options_);
  const auto message = read_log(options_.output).at(0).as<robot_state_t>();
  EXPECT_EQ(message.joint_count, 2);
  EXPECT_NEAR(message.q[1], -M_PI / 4, 1e-12);
  EXPECT_EQ(message.position[2], 3);
  EXPECT_EQ(message.quaternion[1], 1);
  EXPECT_EQ(message.twist[2], 0.1);
  EXPECT_EQ(message.twist[3], 0.2);
}

TEST_F(ImportCsv, CountsWhatABiotacHas) {
  std::string header = "pac0,pac1,pdc", row = "2030,2095,1972";
  for (int i = 1; i <= 19; ++i) {
    header += ",e" + std::to_string(i);
    row += "," + std::to_string(3000 + i);
  }
  write(header + "\n" + row + "\n" + row + "\n");
  use("biotac");
  options_.rate = 100;
  import_csv(options_);
  const std::vector<Event> events = read_log(options_.output);
  EXPECT_EQ(events.at(1).timestamp, 10000);
  const auto message = events.at(0).as<biotac_t>();
  EXPECT_EQ(message.valid, biotac_t::VALID_ELECTRODES | biotac_t::VALID_PAC | biotac_t::VALID_PDC);
  EXPECT_EQ(message.pac_count, 2);
  EXPECT_EQ(message.pac[1], 2095);
  EXPECT_EQ(message.electrodes[18], 3019);
}

TEST_F(ImportCsv, TakesOnlyTheRowsAskedFor) {
  write("t,finger,fx,fy,fz,tx,ty,tz\n0,a,1,0,0,0,0,0\n0.1,b,2,0,0,0,0,0\n0.2,a,3,0,0,0,0,0\n");
  use("force_torque");
  options_.where = {{"finger", "a"}};
  EXPECT_EQ(import_csv(options_).rows, 2);
  EXPECT_EQ(read_log(options_.output).at(1).as<ft_wrench_t>().wrench[0], 3);
}

TEST_F(ImportCsv, ReadsCompressedFiles) {
  const std::string text = "t,fx,fy,fz,tx,ty,tz\r\n0,1,2,3,4,5,6\r\n";
  gzFile file = gzopen(options_.input.c_str(), "wb");
  ASSERT_EQ(gzwrite(file, text.data(), static_cast<unsigned>(text.size())),
            static_cast<int>(text.size()));
  gzclose(file);
  use("force_torque");
  EXPECT_EQ(import_csv(options_).rows, 1);
  EXPECT_EQ(read_log(options_.output).at(0).as<ft_wrench_t>().wrench[5], 6);
}

TEST_F(ImportCsv, ComplaintsNameFileLineAndColumn) {
  use("force_torque");
  EXPECT_THAT(complaint(), HasSubstr("in.csv: "));
  write("");
  EXPECT_THAT(complaint(), HasSubstr("empty"));
  write("t,fx,fy,fz,tx,ty\n0,1,2,3,4,5\n");
  EXPECT_THAT(complaint(), HasSubstr("no column 'tz'; the columns are t, fx"));
  const std::string header = "t,fx,fy,fz,tx,ty,tz\n0,1,2,3,4,5,6\n";
  write(header + "\n0.1,1,2,3,4,five,6\n");
  EXPECT_THAT(complaint(), HasSubstr("in.csv:4:ty: 'five' is not a number"));
  write(header + "0.1,1,nan,3,4,5,6\n");
  EXPECT_THAT(complaint(), HasSubstr("in.csv:3:fy: 'nan' is not finite"));
  write(header + "0.1,1,2,3,4,5\n");
  EXPECT_THAT(complaint(), HasSubstr("in.csv:3: has 6 cells, the header 7"));
  write(header + "-0.1,1,2,3,4,5,6\n");
  EXPECT_THAT(complaint(), HasSubstr("in.csv:3:t: time goes back by 100000 us"));
  write("t,fx,fx\n");
  EXPECT_THAT(complaint(), HasSubstr("two columns are named 'fx'"));
  write(header.substr(0, header.find('\n') + 1));
  EXPECT_THAT(complaint(), HasSubstr("no row"));
}

TEST_F(ImportCsv, AllMissingColumnsOfAFileAreOneComplaint) {
  write("stamp,fx,fz,a\n0,1,2,3\n");
  options_.streams = {{"FT_WRENCH", "force_torque", {{"fy", "-side:mN"}, {"tx", "=0"}}},
                      {"IMU", "imu", {{"ax", "a"}, {"wx", "gyro"}}}};
  options_.where = {{"finger", "ring"}};
  EXPECT_THAT(complaint(),
              HasSubstr("in.csv: no columns 't', 'finger', 'side', 'ty', 'tz', 'ay', 'az', 'gyro'; "
                        "the columns are stamp, fx, fz, a; palpate-import --formats"));
}

TEST_F(ImportCsv, ReadsQuotedCellsAndOtherDelimiters) {
  write("t;fx;fy;fz;tx;ty;tz;note\n0;1;2;3;4;5;6;\"a; b\"\n");
  use("force_torque");
  import_csv(options_);
  EXPECT_EQ(read_log(options_.output).at(0).as<ft_wrench_t>().wrench[5], 6);
  std::filesystem::remove(options_.output);
  options_.delimiter = ',';
  EXPECT_THAT(complaint(), HasSubstr("no columns 't', 'fx'"));
}

TEST_F(ImportCsv, ThePageOfFormatsNamesEveryFieldsUnitAndWhetherItIsRequired) {
  const std::string page = formats_page();
  for (const std::string& format : format_names())
    EXPECT_THAT(page, HasSubstr("\n## " + format + "\n"));
  EXPECT_THAT(page, HasSubstr("| `fx`, `fy`, `fz` | N (kN, mN) | yes | force"));
  EXPECT_THAT(page, HasSubstr("| `q1` to `q16` | rad (deg) | no | joint positions"));
  EXPECT_THAT(page, HasSubstr("| `qw`, `qx`, `qy`, `qz` | - | yes | orientation"));
}

TEST_F(ImportCsv, ComplainsAboutMappingsThatMakeNoSense) {
  write("t,fx,fy,fz,tx,ty,tz,q\n0,1,2,3,4,5,6,7\n");
  use("force_torque", {{"force", "fx"}});
  EXPECT_THAT(complaint(), HasSubstr("no field 'force'; its fields: fx, fy"));
  use("force_torque", {{"fx", "fx:deg"}});
  EXPECT_THAT(complaint(), HasSubstr("unknown unit 'deg'; allowed: N, kN, mN"));
  use("force_torque", {{"fx", "=two"}});
  EXPECT_THAT(complaint(), HasSubstr("field fx: '=two'"));
  use("force_plate");
  EXPECT_THAT(complaint(), HasSubstr("unknown format 'force_plate'; allowed: biotac"));
  use("force_torque");
  options_.streams[0].channel = "no spaces";
  EXPECT_THAT(complaint(), HasSubstr("channel 'no spaces'"));
  use("robot_state", {{"px", "=0"},
                      {"py", "=0"},
                      {"pz", "=0"},
                      {"qw", "fx"},
                      {"qx", "fy"},
                      {"qy", "=0"},
                      {"qz", "=0"}});
  EXPECT_THAT(complaint(), HasSubstr("in.csv:2: the quaternion is not of unit length"));
}

TEST_F(ImportCsv, ReadsItsMapFromYaml) {
  write("ms,a,b\n5,1,2\n");
  const config::Node root = config::Node::from_text(
      "time_column: ms\n"
      "time_unit: ms\n"
      "streams:\n"
      "  - channel: IMU\n"
      "    format: imu\n"
      "    columns: {ax: \"-a\", ay: \"b:g\", az: \"=0\"}\n");
  read_map(root, options_);
  import_csv(options_);
  const Event event = read_log(options_.output).at(0);
  EXPECT_EQ(event.channel, "IMU");
  EXPECT_EQ(event.timestamp, 5000);
  EXPECT_EQ(event.as<imu_t>().acceleration[0], -1);
  EXPECT_THROW(read_map(config::Node::from_text("strems: []\n"), options_), config::Error);
}

TEST_F(ImportCsv, ImportsTheFoamBarRecording) {
  PALPATE_REQUIRE_RECORDING("biotac_foam_bar/ring_finger_dev.csv");
  options_.input = (support::recordings() / "biotac_foam_bar/ring_finger_dev.csv").string();
  options_.streams = preset_streams("biotac_foam_bar");
  const ImportSummary summary = import_csv(options_);
  const std::vector<Event> events = read_log(options_.output);
  ASSERT_EQ(events.size(), static_cast<std::size_t>(2 * summary.rows));
  // 100 Hz throughout.
  EXPECT_NEAR(1e-6 * static_cast<double>(summary.last_utime - summary.first_utime),
              0.01 * static_cast<double>(summary.rows - 1), 0.02);
  recordings::CsvReader csv(options_.input);
  std::size_t i = 0;
  while (csv.next()) {
    const auto biotac = events.at(i++).as<biotac_t>();
    const auto truth = events.at(i++).as<ft_wrench_t>();
    EXPECT_EQ(biotac.valid, 15);
    EXPECT_EQ(biotac.electrodes[18], csv.number(csv.column("e19")));
    EXPECT_EQ(biotac.pdc, csv.number(csv.column("pdc")));
    EXPECT_EQ(truth.wrench[2], csv.number(csv.column("fz")));
  }
}

}  // namespace
}  // namespace palpate::import
