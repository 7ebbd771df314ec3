#include "tools/lab/runs/absolute_override.hpp"

#include <gtest/gtest.h>

#include "rt/config/node.hpp"
#include "tests/unit/tools/lab/studies/study_folder.hpp"

namespace palpate::runs {
namespace {

class AbsoluteOverride : public testing::Test {
 protected:
  std::string made(const std::string& item) const { return absolute_override(item, file_); }
  studies::StudyFolder folder_;
  std::filesystem::path base_ = folder_.write(
      "base.yaml", "object: {mesh: {cells: [10, 1, 5], size: [0.5, 0.06, 0.4]}, name: bar}\n");
  std::filesystem::path file_ = folder_.write(
      "file.yaml", "base: base.yaml\nobject: {material: {modulus: 60e3, ratio: 0.3}}\n");
};

TEST_F(AbsoluteOverride, ScalesAndShiftsWhatTheFileSays) {
  EXPECT_EQ(made("object.material.modulus*=1.3"), "object.material.modulus=78000");
  EXPECT_EQ(made("object.material.ratio+=-0.15"), "object.material.ratio=0.15");
  EXPECT_EQ(made("object.mesh.size*=0.5"), "object.mesh.size=[0.25, 0.03, 0.2]");
}

TEST_F(AbsoluteOverride, WholeNumbersOfAListStayWholeAndAtLeastOne) {
  EXPECT_EQ(made("object.mesh.cells*=0.7"), "object.mesh.cells=[7, 1, 4]");
  EXPECT_EQ(made("object.mesh.cells*=0.1"), "object.mesh.cells=[1, 1, 1]");
}

TEST_F(AbsoluteOverride, LeavesOtherOverridesAlone) {
  EXPECT_EQ(made("a.b=c*=2"), "a.b=c*=2");
  EXPECT_EQ(made("sensors={position: [1, 2]}"), "sensors={position: [1, 2]}");
}

TEST_F(AbsoluteOverride, WantsANumberInTheFile) {
  EXPECT_THROW(made("object.pads.stiffness*=0.2"), config::Error);
  EXPECT_THROW(made("object.material.density*=2"), config::Error);
  EXPECT_THROW(made("object.name*=2"), config::Error);
  EXPECT_THROW(made("object.mesh.size+=1"), config::Error);
  EXPECT_THROW(made("object.material.modulus*=soft"), config::Error);
}

}  // namespace
}  // namespace palpate::runs
