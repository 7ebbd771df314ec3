#include <gtest/gtest.h>

#include <string>

#include "rt/registry/registry.hpp"

namespace palpate::registry {
namespace {

class FeatureRegistry : public ::testing::Test {
 protected:
  FeatureRegistry() {
    object_.body.mesh = mesh::make_element_mesh(mesh::make_box({0.5, 0.06, 0.06}, {6, 2, 2}),
                                                mesh::ElementOrder::kQuadratic);
    context_.object = &object_;
  }
  std::unique_ptr<shape::Feature> make(const std::string& yaml) const {
    const config::Node node = config::Node::from_text(yaml);
    std::unique_ptr<shape::Feature> feature = make_feature(node, context_);
    node.check_all_used();
    return feature;
  }
  std::string refusal(const std::string& yaml) const {
    try {
      make(yaml);
    } catch (const config::Error& error) {
      return error.what();
    }
    return "";
  }

  Object object_;
  Context context_;
};

constexpr const char* kStraight = "rest_points: [[0.1, 0, 0.06], [0.2, 0, 0.06], [0.3, 0, 0.06]]";

TEST_F(FeatureRegistry, BuildsEachKind) {
  const std::string straight = kStraight;
  const struct {
    std::string yaml;
    const char* kind;
    int dimension;
  } kinds[] = {
      {"{component: point, rest_points: [[0.1, 0, 0]], components: [0, 2]}", "point", 2},
      {"{component: points, " + straight + "}", "points", 9},
      {"{component: points, surface: 20}", "points", 60},
      {"{component: pose, rest_points: [[0.1, 0, 0], [0.2, 0, 0], [0.1, 0.06, 0]]}", "pose", 6},
      {"{component: distance, rest_points: [[0.1, 0, 0], [0.4, 0, 0]]}", "distance", 1},
      {"{component: angle, " + straight + ", axis: [0, -1, 0]}", "angle", 1},
      {"{component: curvature, " + straight + ", axis: [0, -1, 0]}", "curvature", 1},
      {"{component: fourier_contour, " + straight +
           ", harmonics: 2, closed: false, components: [0, 2]}",
       "fourier_contour", 6},
  };
  for (const auto& [yaml, kind, dimension] : kinds) {
    const std::unique_ptr<shape::Feature> feature = make(yaml);
    EXPECT_STREQ(feature->kind(), kind);
    EXPECT_EQ(feature->dimension(), dimension) << yaml;
  }
}

TEST_F(FeatureRegistry, SpreadsPointsOverAGroupOfTheMesh) {
  const Eigen::Matrix3Xi whole = mesh::extract_surface(object_.body.mesh).triangles;
  object_.groups["face"].triangles = whole.leftCols(1);
  object_.groups["core"].tetrahedra = {0};
  const auto feature = make("{component: points, surface: 20, surface_group: face}");
  EXPECT_EQ(feature->dimension(), 9) << "the three corners of one triangle";
  for (const Eigen::Vector3d& p : feature->rest_points()) {
    double nearest = 1;
    for (const int n : whole.col(0))
      nearest = std::min(nearest, (p - object_.body.mesh.nodes.col(n)).norm());
    EXPECT_LT(nearest, 1e-12);
  }
  EXPECT_NE(refusal("{component: points, surface: 9, surface_group: faces}")
                .find("no group 'faces'; allowed: core, face"),
            std::string::npos);
  EXPECT_NE(
      refusal("{component: points, surface: 9, surface_group: core}").find("holds no triangles"),
      std::string::npos);
}

TEST_F(FeatureRegistry, SaysWhyAFeatureCannotBe) {
  const std::string straight = kStraight;
  EXPECT_NE(refusal("{component: angle, " + straight + "}").find("an axis"), std::string::npos);
  EXPECT_NE(refusal("{component: curvature, " + straight + "}").find("an axis"), std::string::npos);
  EXPECT_NE(refusal("{component: distance, " + straight + "}").find("rest_points: 3; allowed: 2"),
            std::string::npos);
  EXPECT_NE(refusal("{component: points, surface: 513}").find("512"), std::string::npos);
  EXPECT_NE(refusal("{component: points, surface: 9, " + straight + "}").find("no meaning"),
            std::string::npos);
  EXPECT_NE(
      refusal("{component: fourier_contour, " + straight + ", harmonics: 2}").find("harmonics: 2"),
      std::string::npos);
}

}  // namespace
}  // namespace palpate::registry
