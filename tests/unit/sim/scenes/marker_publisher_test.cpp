#include "sim/scenes/marker_publisher.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/unit/sim/scenes/stage.hpp"

namespace palpate::scenes {
namespace {

const std::string kMarkers = "markers.rest_points=[[0.25, 0.03, 0.06], [0.1, 0, 0.03]]";

std::vector<shape_observation_t> observe_markers(double seconds,
                                                 std::vector<std::string> overrides) {
  overrides.push_back(kMarkers);
  Stage stage(kSixPoses, coarse(std::move(overrides)));
  stage.run(seconds);
  return stage.sent<shape_observation_t>("SHAPE_OBSERVATION");
}

TEST(MarkerPublisher, MarkersAreWhereTheirMaterialIs) {
  Stage stage(kSixPoses, coarse({kMarkers, "markers.delay=0.05"}));
  const Simulation& s = stage.simulation;
  std::map<std::int64_t, Eigen::Vector3d> at;
  for (int i = 0; i < 2500; ++i) {
    stage.simulation.step();
    at[s.utime()] = s.scene().X_WO * s.plant().position_at({0.1, 0, 0.03});
  }
  const auto messages = stage.sent<shape_observation_t>("SHAPE_OBSERVATION");
  EXPECT_NEAR(messages.size(), 2.45 * 30, 1);
  double moved = 0;
  for (const auto& m : messages) {
    ASSERT_EQ(m.count, 2);
    const Eigen::Vector3d seen = Eigen::Map<const Eigen::Vector3f>(m.points[1]).cast<double>();
    EXPECT_LT((seen - at.at(m.utime)).norm(), 1e-6);
    moved = std::max(moved, (seen - at.begin()->second).norm());
  }
  EXPECT_GT(moved, 1e-3) << "the object has moved meanwhile";
}

TEST(MarkerPublisher, NoiseIsAsLargeAsStated) {
  const auto clear = observe_markers(3, {}), noisy = observe_markers(3, {"markers.noise=0.002"});
  ASSERT_EQ(clear.size(), noisy.size());
  double squares = 0;
  int count = 0;
  for (std::size_t i = 0; i < clear.size(); ++i) {
    EXPECT_DOUBLE_EQ(noisy[i].deviation, 0.002);
    for (int p = 0; p < 2; ++p)
      for (int k = 0; k < 3; ++k, ++count)
        squares += std::pow(noisy[i].points[p][k] - clear[i].points[p][k], 2);
  }
  EXPECT_NEAR(std::sqrt(squares / count), 0.002, 0.0003);
}

TEST(MarkerPublisher, SaysNothingWhileSomethingIsInTheWay) {
  const auto messages =
      observe_markers(1.5, {"markers.occlusions=[{at: 0.5, duration: 0.5}]", "markers.rate=100"});
  EXPECT_NEAR(messages.size(), 100, 2);
  for (const auto& m : messages) EXPECT_FALSE(m.utime > 500000 && m.utime < 1000000) << m.utime;
  EXPECT_TRUE(observe_markers(0.5, {"markers.drop_out=1"}).empty());
}

TEST(Cuts, AnObjectThatIsCutSagsMoreAndOneThatIsNotStaysAsItWas) {
  const auto sag = [](const std::vector<std::string>& overrides) {
    Stage stage(kControl, coarse(overrides));
    const double before = stage.simulation.plant().position_at({0.25, 0.03, 0.03}).z();
    stage.run(1.5);
    return before - stage.simulation.plant().position_at({0.25, 0.03, 0.03}).z();
  };
  EXPECT_LT(std::abs(sag({})), 1e-4);
  // Through the lower half, a fifth of the way along.
  const std::string cut = "cuts=[{at: 0.2, box: {lower: [0.02, 0, 0], upper: [0.12, 0.06, 0.03]}}]";
  EXPECT_GT(sag({cut}), 3e-4);
  EXPECT_THROW(sag({"cuts=[{at: 0.2, box: {lower: [0.02, 0, 0.5], upper: [0.12, 0.06, 0.6]}}]"}),
               config::Error);
}

TEST(MarkerPublisher, WrongMarkersAreRefused) {
  const auto error = [](const std::vector<std::string>& overrides) -> std::string {
    try {
      read_scene(config::Node::load_file(kSixPoses, overrides));
    } catch (const config::Error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(error({kMarkers}), "");
  EXPECT_NE(error({"markers.rest_points=[[0.9, 0, 0]]"}).find("outside"), std::string::npos);
  EXPECT_NE(error({"markers.rest_points=[]"}).find("rest_points"), std::string::npos);
  EXPECT_NE(error({kMarkers, "markers.noise=-1"}).find("noise"), std::string::npos);
  EXPECT_NE(error({kMarkers, "camera.eye=[1.1, -0.9, 0.8]"}).find("markers"), std::string::npos);
}

}  // namespace
}  // namespace palpate::scenes
