#include "sim/scenes/camera_publisher.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <thread>

#include "core/mesh/closest_point.hpp"
#include "tests/unit/sim/scenes/stage.hpp"

namespace palpate::scenes {
namespace {

const std::string kEye = "camera.eye=[1.1, -0.9, 0.8]";

std::vector<std::string> with_camera(std::vector<std::string> overrides = {}) {
  overrides.insert(overrides.end(), {kEye, "camera.truth_segmentation=true"});
  return coarse(std::move(overrides));
}

std::vector<shape_observation_t> observe(double seconds, std::vector<std::string> overrides = {}) {
  Stage stage(kSixPoses, with_camera(std::move(overrides)));
  stage.run(seconds);
  return stage.sent<shape_observation_t>("SHAPE_OBSERVATION");
}

bool alike(const shape_observation_t& a, const shape_observation_t& b) {
  return a.count == b.count && a.deviation == b.deviation &&
         std::memcmp(a.points, b.points, sizeof(a.points)) == 0;
}

TEST(CameraPublisher, SaysNothingWhereTheSceneDoesNotAsk) {
  Stage stage(kSixPoses);
  stage.run(0.3);
  EXPECT_TRUE(stage.sent<shape_observation_t>("SHAPE_OBSERVATION").empty());
  EXPECT_EQ(stage.simulation.camera(), nullptr);
}

TEST(CameraPublisher, SendsAtItsRateAndLate) {
  Stage stage(kSixPoses, with_camera({"sensors.camera.jitter=0"}));
  std::size_t known = 0;
  for (int tick = 1; tick <= 600; ++tick) {
    const std::size_t before = stage.messages.size();
    stage.simulation.step();
    for (std::size_t i = before; i < stage.messages.size(); ++i) {
      if (stage.messages[i].channel != "SHAPE_OBSERVATION") continue;
      shape_observation_t message;
      message.decode(stage.messages[i].data.data(), 0, stage.messages[i].data.size());
      EXPECT_EQ(message.utime + 60000, 1000 * tick);
      EXPECT_EQ(message.seq, static_cast<std::int32_t>(++known));
      EXPECT_EQ(message.session, 1);
    }
  }
  EXPECT_NEAR(known, 0.54 * 30, 1);
  EXPECT_EQ(stage.simulation.camera()->left_out(), 0);
}

TEST(CameraPublisher, PointsLieOnThePlantWhileItMoves) {
  Stage stage(kSixPoses, with_camera());
  const Simulation& s = stage.simulation;
  const math::Pose X_WO = s.scene().X_WO;
  std::map<std::int64_t, Eigen::Matrix3Xd> shapes;
  for (int i = 0; i < 2000; ++i) {
    stage.simulation.step();
    shapes[s.utime()] = (X_WO.linear() * s.plant().positions()).colwise() + X_WO.translation();
  }
  double squares = 0, stated = 0, moved = 0;
  int count = 0;
  for (const auto& m : stage.sent<shape_observation_t>("SHAPE_OBSERVATION")) {
    ASSERT_GT(m.count, 100);
    ASSERT_LE(m.count, 256);
    const Eigen::Matrix3Xd& shape = shapes.at(m.utime);
    moved = (shape - shapes.begin()->second).colwise().norm().maxCoeff();
    for (int i = 0; i < m.count; i += 4) {
      const Eigen::Vector3d p = Eigen::Map<const Eigen::Vector3f>(m.points[i]).cast<double>();
      const double d =
          mesh::closest_point_on_surface(p, s.plant().surface_triangles(), shape).distance;
      squares += d * d;
      ++count;
    }
    stated = m.deviation;
  }
  const double rms = std::sqrt(squares / count);
  std::printf("distance of observed points from the plant's surface: rms %.2f mm, stated %.2f mm\n",
              1e3 * rms, 1e3 * stated);
  EXPECT_GT(moved, 0.01);
  EXPECT_LT(rms, 1.1 * stated);
  EXPECT_GT(rms, 0.4 * stated);
}

TEST(CameraPublisher, RunsAreEqualToTheBitAndSeedsMatter) {
  const auto first = observe(0.4), again = observe(0.4), other = observe(0.4, {"seed=2"});
  ASSERT_GT(first.size(), 8u);
  ASSERT_EQ(first.size(), again.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].utime, again[i].utime);
    EXPECT_TRUE(alike(first[i], again[i])) << i;
  }
  EXPECT_FALSE(alike(first[0], other[0]));
}

TEST(CameraPublisher, WhereItMayLagPicturesAreTheSameOrLeftOut) {
  std::map<std::int64_t, shape_observation_t> waited;
  for (const auto& m : observe(1.1)) waited[m.utime] = m;
  Stage stage(kSixPoses, with_camera());
  stage.simulation.let_camera_lag();
  for (int i = 0; i < 1000; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));  // as in real time
    stage.simulation.step();
  }
  const auto lagging = stage.sent<shape_observation_t>("SHAPE_OBSERVATION");
  ASSERT_FALSE(lagging.empty());
  EXPECT_LE(lagging.size(), waited.size());
  for (const auto& m : lagging) {
    ASSERT_TRUE(waited.count(m.utime)) << m.utime;
    EXPECT_TRUE(alike(m, waited.at(m.utime))) << m.utime;
  }
}

TEST(CameraPublisher, FollowsTheSensorTable) {
  EXPECT_NEAR(observe(1, {"sensors.camera.rate=10", "sensors.camera.delay=0"}).size(), 10, 1);
  const auto lossy = observe(2, {"sensors.camera.drop_out=0.5", "sensors.camera.rate=20"}).size();
  EXPECT_GT(lossy, 8u);
  EXPECT_LT(lossy, 32u);
  // A camera believed to be 5 cm higher reports everything 5 cm higher.
  const std::vector<std::string> exact{"sensors.camera.depth.noise=0", "sensors.camera.delay=0"};
  std::vector<std::string> shifted = exact;
  shifted.push_back("sensors.camera.calibration_error.position=[0, 0, 0.05]");
  const auto here = observe(0.05, exact), there = observe(0.05, shifted);
  const auto middle = [](const shape_observation_t& m) {
    return Eigen::Vector3f(
        Eigen::Map<const Eigen::Matrix3Xf>(&m.points[0][0], 3, m.count).rowwise().mean());
  };
  const Eigen::Vector3f moved = middle(there.at(0)) - middle(here.at(0));
  const Eigen::Vector3f along = Eigen::Vector3f(0.01F, 0.9F, -0.5F).normalized();  // about its axis
  EXPECT_NEAR(moved.norm(), 0.05F, 3e-3F);
  EXPECT_GT(moved.normalized().dot(along), 0.95F);
}

TEST(CameraPublisher, SeesNothingWhileItIsOccluded) {
  const std::string occlusions = "camera.occlusions=[{at: 0.2, duration: 0.3}]";
  const auto some = observe(0.8, {"sensors.camera.drop_out=0", occlusions}), all = observe(0.8);
  ASSERT_FALSE(all.empty());
  std::map<std::int64_t, shape_observation_t> seen;
  for (const auto& m : some) seen[m.utime] = m;
  for (const auto& m : all) {
    const std::int64_t since_us = m.utime - all.front().utime;
    const bool hidden = since_us > 200'000 && since_us < 466'000;
    if (hidden) {
      EXPECT_EQ(seen.count(m.utime), 0u) << since_us;
    }
    if (since_us < 166'000 || since_us > 500'000) {
      ASSERT_EQ(seen.count(m.utime), 1u) << since_us;
      EXPECT_TRUE(alike(seen.at(m.utime), m)) << "what was not seen changes nothing of the rest";
    }
  }
}

TEST(CameraPublisher, TruthSegmentationCanBeChosen) {
  const auto found = observe(0.1, {"camera.segmentation=truth", "camera.colour=[0.6, 0.62, 0.65]"});
  ASSERT_FALSE(found.empty());  // grey like the hand: colour alone would not distinguish them
  for (const auto& p : found[0].points) EXPECT_TRUE(std::isfinite(p[0]));
  EXPECT_GT(found[0].count, 100);
}

/// Of the message: drake/lcmt_point_cloud after fingerprint, utime and the frame's name "camera".
std::int64_t big_endian(const std::vector<std::uint8_t>& data, std::size_t at) {
  std::uint64_t value = 0;
  for (std::size_t i = at; i < at + 8; ++i) value = value << 8 | data.at(i);
  return static_cast<std::int64_t>(value);
}
constexpr std::size_t kUtime = 8, kWidth = 8 + 8 + 4 + 7;

TEST(CameraPublisher, SendsCloudsInPlaceOfObservations) {
  Stage stage(kSixPoses, coarse({kEye, "sensors.camera={rate: 10, delay: 0.06, jitter: 0}",
                                 "camera.cloud={channel: SEEN, stride: 8}"}));
  stage.run(0.5);
  EXPECT_TRUE(stage.sent<shape_observation_t>("SHAPE_OBSERVATION").empty());
  ASSERT_EQ(stage.clouds.size(), 5u);  // exposures at 1 ms (the first tick), 100, .. 400 ms
  for (std::size_t i = 0; i < stage.clouds.size(); ++i) {
    const bus::Published& cloud = stage.clouds[i];
    EXPECT_EQ(cloud.channel, "SEEN");
    EXPECT_EQ(cloud.time_ns - big_endian(cloud.data, kUtime), 60'000);
    const std::int64_t points = big_endian(cloud.data, kWidth);
    EXPECT_GT(points, 100);
    EXPECT_LE(points, 80 * 60);
    EXPECT_LT(cloud.data.size(), 16u * points + 256);
  }
}

TEST(CameraPublisher, CloudsOfFewerPixelsArePartOfThoseOfMoreAndOneRunEqualsAnother) {
  const auto sizes = [](const char* stride) {
    Stage stage(kSixPoses, coarse({kEye, "sensors.camera.delay=0", stride}));
    stage.run(0.1);
    return stage.clouds.at(0).data;
  };
  const auto fine = sizes("camera.cloud.stride=4"), again = sizes("camera.cloud.stride=4"),
             coarser = sizes("camera.cloud.stride=8");
  EXPECT_EQ(fine, again);
  const double ratio = double(big_endian(fine, kWidth)) / double(big_endian(coarser, kWidth));
  EXPECT_NEAR(ratio, 4, 0.4);
}

TEST(CameraPublisher, LateStampsAreThoseOfClouds) {
  Stage stage(kSixPoses, coarse({kEye,
                                 "sensors.camera={jitter: 0, delay: 0.05, "
                                 "stamp_delay: 0.02, rate: 10}"}));
  stage.run(0.3);
  ASSERT_GT(stage.clouds.size(), 1u);
  for (const bus::Published& cloud : stage.clouds)
    EXPECT_EQ(cloud.time_ns - big_endian(cloud.data, kUtime), 30'000);
}

TEST(CameraPublisher, ScoredScenesSendCloudsOnRequest) {
  Stage scored(kSixPoses, with_camera());
  scored.run(0.15);
  EXPECT_TRUE(scored.clouds.empty());
  Stage both(kSixPoses, with_camera({"camera.cloud.stride=8"}));
  both.run(0.15);
  EXPECT_FALSE(both.clouds.empty());
  EXPECT_FALSE(both.sent<shape_observation_t>("SHAPE_OBSERVATION").empty());
}

TEST(CameraPublisher, WrongKeysAreRefused) {
  for (const char* wrong :
       {"camera.eyes=3", "camera.segmentation=magic", "camera.voxel=0", "camera.margin=-1",
        "camera.colour=[0, 0, 0]", "camera.target=[1.1, -0.9, 0.2]", "camera.occlusions=[{at: 1}]",
        "camera.occlusions=[{at: -1, duration: 1}]", "camera.occlusions=[{at: 1, duration: 0}]",
        "camera.occlusions=[{at: 1, duration: 2}, {at: 2, duration: 1}]",
        "camera.pose.position=[0, 0, 1]", "sensors.camera.rate=0",
        "sensors.camera.depth.edge_loss=2", "sensors.camera.depth.farthest=0.2",
        "camera.cloud.stride=0", "camera.cloud.channel=cloud", "camera.truth_segmentation=3"}) {
    EXPECT_THROW(read_scene(config::Node::load_file(kSixPoses, {kEye, wrong})), config::Error)
        << wrong;
  }
  EXPECT_THROW(read_scene(config::Node::load_file(kSixPoses, {"camera.voxel=0.02"})),
               config::Error);
  EXPECT_NO_THROW(read_scene(config::Node::load_file(kSixPoses, {kEye})));
  EXPECT_NO_THROW(
      read_scene(config::Node::load_file(kSixPoses, {"camera.pose.position=[0, 0, 1]"})));
}

}  // namespace
}  // namespace palpate::scenes
