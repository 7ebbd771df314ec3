#include "tools/lab/studies/discrepancy_world.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <set>

#include "rt/config/node.hpp"
#include "sim/scenes/scene.hpp"
#include "tests/unit/tools/lab/studies/study_folder.hpp"

namespace palpate::studies {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

const std::filesystem::path kSource = PALPATE_SOURCE_DIR;

DiscrepancyPlan shipped() {
  return read_discrepancy_plan(kSource / "tools/lab/studies/discrepancies.yaml", kSource);
}

std::vector<DiscrepancyWorld> worlds(const std::string& set, int count, int seed = 1) {
  return make_worlds(shipped(), {set, count, seed, "none", "", 0}, kSource);
}

/// What an override sets, as a document of its own.
config::Node value_of(const std::vector<std::string>& overrides, const std::string& key) {
  for (const std::string& item : overrides)
    if (item.rfind(key + "=", 0) == 0)
      return config::Node::from_text("value: " + item.substr(key.size() + 1));
  ADD_FAILURE() << "nothing sets " << key;
  return config::Node::from_text("{}");
}

TEST(DiscrepancyWorlds, EveryKindHasItsShare) {
  std::map<std::string, int> count;
  std::set<std::string> names;
  for (const DiscrepancyWorld& world : worlds("scoring", 100)) {
    ++count[world.kind];
    names.insert(world.name);
  }
  EXPECT_EQ(names.size(), 100u);
  for (const DiscrepancyKind& kind : shipped().kinds)
    EXPECT_NEAR(count[kind.name], kind.share, 1) << kind.name;
}

TEST(DiscrepancyWorlds, TuningAndScoringShareNothing) {
  std::set<std::string> objects, motions;
  for (const DiscrepancyWorld& world : worlds("scoring", 20)) {
    objects.insert(world.object);
    motions.insert(value_of(world.scene_overrides, "motion").dump());
  }
  EXPECT_EQ(objects.size(), 2u);
  for (const DiscrepancyWorld& world : worlds("tuning", 20)) {
    EXPECT_EQ(objects.count(world.object), 0u);
    EXPECT_TRUE(motions.insert(value_of(world.scene_overrides, "motion").dump()).second);
  }
  for (const DiscrepancyWorld& world : worlds("scoring", 20, 2))
    EXPECT_TRUE(motions.insert(value_of(world.scene_overrides, "motion").dump()).second);
  EXPECT_THROW(worlds("training", 1), std::invalid_argument);
}

TEST(DiscrepancyWorlds, AreTheSameForTheSameSeedWhateverTheirNumber) {
  const std::vector<DiscrepancyWorld> few = worlds("scoring", 10), many = worlds("scoring", 40);
  for (std::size_t i = 0; i < few.size(); ++i) {
    EXPECT_EQ(few[i].name, many[i].name);
    EXPECT_EQ(few[i].scene_overrides, many[i].scene_overrides);
  }
}

TEST(DiscrepancyWorlds, OfOneKindAndOfAnyLength) {
  WorldSelection selection{"scoring", 4, 1, "none", "none", 2};
  for (const DiscrepancyWorld& world : make_worlds(shipped(), selection, kSource)) {
    EXPECT_EQ(world.kind, "none");
    EXPECT_GT(world.duration, 120);
    EXPECT_LT(world.duration, 130);
    EXPECT_EQ(world.begin, 1);
    const scenes::Scene scene =
        scenes::read_scene(config::Node::load_file(world.scene.string(), world.scene_overrides));
    EXPECT_NEAR(world.duration, scene.motion->duration() + 0.5, 1e-4);
  }
  selection.kind = "slip";
  for (const DiscrepancyWorld& world : make_worlds(shipped(), selection, kSource)) {
    EXPECT_EQ(world.kind, "slip");
    EXPECT_LT(world.duration, 60) << "longer only in free air";
  }
  selection.kind = "rain";
  EXPECT_THROW(make_worlds(shipped(), selection, kSource), std::invalid_argument);
}

TEST(DiscrepancyWorlds, ObstaclesAreFreeAtRestAndInTheHandsWay) {
  int obstacles = 0;
  for (const std::string set : {"scoring", "tuning"})
    for (const DiscrepancyWorld& world : worlds(set, 60)) {
      if (!world.obstacle) continue;
      ++obstacles;
      const Vector3d size =
          scenes::read_scene(config::Node::load_file(world.scene.string())).plant.size;
      double nearest = HUGE_VAL;
      for (int corner = 0; corner < 8; ++corner)
        nearest = std::min(nearest, world.obstacle->distance(Vector3d(corner & 1 ? size.x() : 0,
                                                                      corner & 2 ? size.y() : 0,
                                                                      corner & 4 ? size.z() : 0)));
      EXPECT_GT(nearest, 4e-3) << world.name;
      // The hand's pose goes further than the clearance, where a half-space would be met.
      if (world.obstacle->radius > 0) continue;
      double deepest = 0;
      const config::Node motion = value_of(world.scene_overrides, "motion").child("value");
      for (const config::Node& pose : motion.list("poses"))
        deepest =
            std::min(deepest, nearest + world.obstacle->direction.dot(pose.vector3("translation")));
      EXPECT_LT(deepest, -5e-3) << world.name;
    }
  EXPECT_GT(obstacles, 30);
}

TEST(DiscrepancyWorlds, DistanceIsFromThePlaneOrTheCylinder) {
  const RigidObstacle table{{0, 0, -0.01}, Vector3d::UnitZ(), 0};
  EXPECT_NEAR(table.distance({3, 2, 0.02}), 0.03, 1e-12);
  const RigidObstacle cylinder{{0.2, 0, -0.05}, Vector3d::UnitY(), 0.04};
  EXPECT_NEAR(cylinder.distance({0.2, 7, 0}), 0.01, 1e-12);
  EXPECT_NEAR(cylinder.distance({0.23, 7, -0.05}), -0.01, 1e-12);
}

TEST(DiscrepancyWorlds, ShiftedClampIsWherePalpatedDoesNotExpectIt) {
  for (const DiscrepancyWorld& world : worlds("scoring", 60)) {
    if (world.kind != "shifted clamp") continue;
    const auto pose = [&world](const std::vector<std::string>& overrides) {
      return config::Node::load_file(world.configuration.string(), overrides)
          .child("frames")
          .pose("object_in_base");
    };
    const double shift =
        (pose(world.daemon_overrides).translation() - pose({}).translation()).norm();
    EXPECT_GE(shift, 0.006 - 1e-6);
    EXPECT_LE(shift, 0.02 + 1e-6);
    EXPECT_NEAR(shift, world.drawn[0].value, 1e-6);
  }
}

TEST(DiscrepancyWorlds, ScenesOfMotionAndWeightAreRead) {
  int weights = 0;
  for (const DiscrepancyWorld& world : worlds("scoring", 60)) {
    if (world.kind != "weight" && world.kind != "none") continue;
    const scenes::Scene scene =
        scenes::read_scene(config::Node::load_file(world.scene.string(), world.scene_overrides));
    ASSERT_TRUE(scene.motion);
    EXPECT_EQ(scene.motion->legs().size(), 5u);
    EXPECT_NEAR(world.duration, scene.motion->duration() + 0.5, 1e-6);
    if (world.kind == "none") continue;
    ++weights;
    ASSERT_EQ(scene.pokes.size(), 1u);
    EXPECT_NEAR(scene.pokes[0].at, world.onset, 1e-6);
    EXPECT_NEAR(scene.pokes[0].at + scene.pokes[0].duration, world.end, 1e-6);
    EXPECT_LT(world.end, world.duration);
    EXPECT_LT(scene.pokes[0].force.z(), 0);
  }
  EXPECT_GT(weights, 3);
}

TEST(DiscrepancyWorlds, ModelErrorsAreDrawnBesides) {
  const DiscrepancyPlan plan = shipped();
  const auto drawn = make_worlds(plan, {"scoring", 5, 1, "uncalibrated", "", 0}, kSource),
             exact = make_worlds(plan, {"scoring", 5, 1, "none", "", 0}, kSource);
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    EXPECT_EQ(drawn[i].name, exact[i].name);
    EXPECT_GT(drawn[i].drawn.size(), exact[i].drawn.size() + 20);
    EXPECT_EQ(value_of(drawn[i].scene_overrides, "motion").dump(),
              value_of(exact[i].scene_overrides, "motion").dump());
    EXPECT_EQ(drawn[i].daemon_overrides.back(), plan.method.overrides.back());
  }
}

TEST(DiscrepancyPlan, ErrorsNameFileAndKey) {
  const StudyFolder folder;
  std::ifstream in(kSource / "tools/lab/studies/discrepancies.yaml");
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const auto error_of = [&](const std::string& from, const std::string& to) -> std::string {
    std::string changed = text;
    EXPECT_NE(changed.find(from), std::string::npos) << from;
    changed.replace(changed.find(from), from.size(), to);
    try {
      read_discrepancy_plan(folder.write("plan.yaml", changed), kSource);
    } catch (const config::Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(error_of("share: 20", "share: 21"), "");
  EXPECT_THAT(error_of("tuning: [bar hard,", "tuning: [bar soft,"), HasSubstr("sets.scoring"));
  EXPECT_THAT(error_of("  slip:", "  slide:"), HasSubstr("kinds.slide"));
  EXPECT_THAT(error_of("clearance: [0.005, 0.02]", "clearance: [0.02, 0.005]"),
              HasSubstr("kinds.wall.clearance"));
  EXPECT_THAT(error_of("radius: [0.02", "radius: [0"), HasSubstr("kinds.cylinder.radius"));
  EXPECT_THAT(error_of("errors: calibrated", "errors: perfect"), HasSubstr("errors"));
  EXPECT_THAT(error_of("method: pose and wrench", "method: magic"), HasSubstr("method"));
  EXPECT_THAT(error_of("part: 0.2", "parts: 0.2"), HasSubstr("part"));
}

}  // namespace
}  // namespace palpate::studies
