#include <gtest/gtest.h>

#include "tests/unit/tools/bridge/ros2/cell.hpp"
#include "tools/bridge/ros2/sensors.hpp"

namespace palpate::ros2_bridge {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

TEST(Ros2Conversions, TimesArePreservedInBothDirections) {
  EXPECT_EQ(utime_of(stamp_of(1'700'000'000'123'456)), 1'700'000'000'123'456);
  EXPECT_EQ(stamp_of(1'700'000'000'123'456).nanosec, 123'456'000u);
  EXPECT_FALSE(utime_of({-1, 0}));
  EXPECT_FALSE(utime_of({1, 1'000'000'000}));
}

TEST(Ros2Conversions, PosesArePreservedInBothDirections) {
  math::Pose X = math::Pose::Identity();
  X.translation() = Eigen::Vector3d(1, 2, 3);
  X.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 2).normalized()).toRotationMatrix();
  const Pose message = pose_message(X);
  EXPECT_NEAR(message.orientation.w, std::cos(0.35), 1e-12);
  const auto back = pose_of(message);
  ASSERT_TRUE(back);
  EXPECT_TRUE(back->isApprox(X, 1e-12));
  EXPECT_FALSE(pose_of({{0, kNotANumber, 0}, {0, 0, 0, 1}}));
  EXPECT_FALSE(pose_of({{0, 0, 0}, {0, 0, 0, 0}}));
}

TEST(Ros2Conversions, WrenchesHaveTheirPolarity) {
  WrenchStamped from{};
  from.wrench = {{1, 2, 3}, {4, 5, 6}};
  ft_wrench_t to{};
  EXPECT_EQ(convert(from, -1, to), nullptr);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(to.wrench[i], -1 - i);
  EXPECT_EQ(convert(from, 1, to), nullptr);
  EXPECT_EQ(to.wrench[5], 6);
  from.wrench.torque.y = kNotANumber;
  EXPECT_NE(convert(from, 1, to), nullptr);
}

TEST(Ros2Conversions, ImuReadingsNeedBothQuantities) {
  Imu from{};
  from.linear_acceleration = {0, 0, 9.81};
  from.angular_velocity = {0.1, 0.2, 0.3};
  imu_t to{};
  EXPECT_EQ(convert(from, to), nullptr);
  EXPECT_EQ(to.acceleration[2], 9.81);
  EXPECT_EQ(to.angular_velocity[1], 0.2);
  from.angular_velocity_covariance[0] = -1;
  EXPECT_NE(convert(from, to), nullptr);
  from.angular_velocity_covariance[0] = 0;
  from.linear_acceleration.x = std::numeric_limits<double>::infinity();
  EXPECT_NE(convert(from, to), nullptr);
}

/// Two rows of three points x, y, z, rgb, with two bytes at the end of a row.
class Cloud {
 public:
  Cloud() {
    for (std::size_t i = 0; i < 4; ++i)
      fields_.push_back({names_[i].data(), static_cast<std::uint32_t>(4 * i),
                         static_cast<std::uint8_t>(i < 3 ? 7 : 6), 1});
    for (std::size_t i = 0; i < data_.size(); ++i) data_[i] = static_cast<std::uint8_t>(i);
    message.header.frame_id = frame_.data();
    message.height = 2;
    message.width = 3;
    message.point_step = 16;
    message.row_step = 50;
    message.is_dense = true;
    refer(message.fields, fields_);
    refer(message.data, data_);
  }
  PointCloud2 message{};

 private:
  std::string frame_ = "camera";
  std::vector<std::string> names_ = {"x", "y", "z", "rgb"};
  std::vector<PointField> fields_;
  std::vector<std::uint8_t> data_ = std::vector<std::uint8_t>(98);
};

TEST(Ros2Conversions, CloudsKeepTheirBytes) {
  Cloud cloud;
  drake::lcmt_point_cloud to;
  ASSERT_EQ(convert(cloud.message, to), nullptr);
  EXPECT_EQ(to.frame_name, "camera");
  EXPECT_EQ(to.width, 3);
  EXPECT_EQ(to.height, 2);
  EXPECT_EQ(to.num_fields, 4);
  EXPECT_EQ(to.fields[2].byte_offset, 8);
  EXPECT_EQ(to.fields[2].datatype, 7);
  EXPECT_EQ(to.fields[3].datatype, 7) << "a word of PCL";
  EXPECT_EQ(to.flags, 2);
  EXPECT_EQ(to.row_step, 50);
  ASSERT_EQ(to.data_size, 98);
  EXPECT_EQ(to.data[97], 97);
}

TEST(Ros2Conversions, CloudsThatContradictThemselvesAreRefused) {
  drake::lcmt_point_cloud to;
  const auto refusal = [&to](void (*change)(PointCloud2&)) {
    Cloud cloud;
    change(cloud.message);
    return convert(cloud.message, to);
  };
  EXPECT_NE(refusal([](PointCloud2& m) { m.data._length = 97; }), nullptr);
  EXPECT_NE(refusal([](PointCloud2& m) { m.width = 0xffffffff; }), nullptr);
  EXPECT_NE(refusal([](PointCloud2& m) { m.height = 0xffffffff; }), nullptr);
  EXPECT_NE(refusal([](PointCloud2& m) { m.row_step = 47; }), nullptr);
  EXPECT_NE(refusal([](PointCloud2& m) { m.fields._length = 0; }), nullptr);
  EXPECT_NE(refusal([](PointCloud2& m) { m.fields._buffer[3].offset = 16; }), nullptr);
  EXPECT_EQ(refusal([](PointCloud2& m) { m.height = 0; }), nullptr) << "an empty one";
}

class IntakeTest : public testing::Test {
 protected:
  bool admits(std::int64_t utime) { return intake.admit(stamp_of(utime), now).has_value(); }
  std::int64_t now = 10'000'000;
  Intake intake{"topic", Clock()};
  const Intake::Counts& counts = intake.counts();
};

TEST_F(IntakeTest, RefusesWhatIsLateAheadOrOvertaken) {
  EXPECT_TRUE(admits(now - 100'000));
  EXPECT_FALSE(admits(now - 100'001));
  EXPECT_EQ(counts.late, 1);
  EXPECT_FALSE(admits(now + 100'001));
  EXPECT_EQ(counts.ahead, 1);
  EXPECT_TRUE(admits(now + 5));
  EXPECT_FALSE(admits(now + 5));
  EXPECT_FALSE(admits(now + 4));
  EXPECT_EQ(counts.overtaken, 2);
  EXPECT_FALSE(intake.admit({0, 2'000'000'000}, now));
  EXPECT_EQ(counts.malformed, 1);
  EXPECT_EQ(counts.accepted, 2);
  EXPECT_EQ(intake.summary(), "2 accepted, 1 malformed, 1 late, 1 ahead, 2 overtaken");
  for (int i = 0; i < 4; ++i) EXPECT_NE(intake.complaint(), "");
  EXPECT_EQ(intake.complaint(), "") << "each reason is said once";
}

TEST_F(IntakeTest, AClockThatIsSetBackDelaysNothing) {
  EXPECT_TRUE(admits(now));
  now -= 5'000'000;
  EXPECT_TRUE(admits(now));
}

TEST_F(IntakeTest, WithoutAStampTheTimeIsThatOfReception) {
  EXPECT_EQ(intake.admit({0, 0}, now), now);
  Intake received{"topic", Clock{false}};
  EXPECT_EQ(received.admit(stamp_of(7), now), now);
}

template <class Lcm, class Relay, class Ros>
void expect_relayed(bus::MessageBus& peer, Relay& relay, const char* channel, const char* topic,
                    Ros message) {
  bus::TypedSubscription<Lcm> readings(peer, channel, 8);
  Writer<Ros> writer(theirs(), {topic, Quality::kReliable});
  std::string frame = "sensor";
  constexpr std::int64_t kNow = 20'000'000;
  for (const std::int64_t age : {2, 1, 1, 200'000}) {  // one is repeated, one is late
    message.header = {stamp_of(kNow - age), frame.data()};
    writer.write(message);
  }
  relay.cycle(kNow);
  Lcm reading;
  std::int64_t arrival_ns = 0;
  ASSERT_TRUE(readings.take(reading, arrival_ns));
  EXPECT_EQ(reading.utime, kNow - 2) << "the stamp";
  ASSERT_TRUE(readings.take(reading, arrival_ns));
  EXPECT_EQ(reading.seq, 2);
  EXPECT_FALSE(readings.take(reading, arrival_ns));
  EXPECT_EQ(relay.intake().counts().late, 1);
  EXPECT_EQ(relay.intake().counts().overtaken, 1);
}

TEST(Ros2Relays, PassOnEveryReadingWithItsStamp) {
  const auto hub = bus::make_memory_hub();
  const auto bus = bus::make_memory_bus(hub), peer = bus::make_memory_bus(hub);
  WrenchRelay wrenches(ours(), "wrench", -1, Clock(), *bus);
  expect_relayed<ft_wrench_t>(*peer, wrenches, "FT_WRENCH", "wrench", WrenchStamped{});
  ImuRelay imu(ours(), "imu", Clock(), *bus);
  expect_relayed<imu_t>(*peer, imu, "IMU", "imu", Imu{});
}

}  // namespace
}  // namespace palpate::ros2_bridge
