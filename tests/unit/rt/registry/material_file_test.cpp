#include "rt/config/material_file.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "rt/registry/object.hpp"
#include "tests/support/scratch_folder.hpp"

namespace palpate::registry {
namespace {

class MaterialFileTest : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) {
    const auto path = folder_.path() / name;
    std::ofstream(path) << text;
    return path.string();
  }

  /// A bar whose section `object` additionally contains `keys`.
  Object bar(const std::string& keys) {
    const std::string path =
        write("bar.yaml",
              "object:\n  mesh: {box: {size: [0.2, 0.04, 0.04], cells: [4, 1, 1]}}\n"
              "  fixed_box: {lower: [0, 0, 0], upper: [0, 0.04, 0.04]}\n"
              "  grasp_box: {lower: [0.2, 0, 0], upper: [0.2, 0.04, 0.04]}\n" +
                  keys);
    const config::Node root = config::Node::load_file(path);
    Object object = read_object(root, Frames());
    root.check_all_used();
    return object;
  }

  std::string refusal(const std::string& keys) {
    try {
      bar(keys);
    } catch (const config::Error& error) {
      return error.what();
    }
    return "";
  }

  support::ScratchFolder folder_;
  const std::string fitted_ =
      "material: {model: ogden_1, young_modulus: 5e4, poisson_ratio: 0.45, density: 31,\n"
      "  mass_damping: 3, ogden_exponent: 4}\n"
      "corotational: {young_modulus: 4.2e4, poisson_ratio: 0.41, strain_range: [-0.1, 0.3]}\n";
};

TEST_F(MaterialFileTest, GoesOverTheObjectsOwnMaterial) {
  write("fitted.yaml", fitted_);
  const Object object =
      bar("  material_file: fitted.yaml\n"
          "  material: {young_modulus: 1e5, poisson_ratio: 0.2, density: 26}\n");
  EXPECT_EQ(object.body.material.young_modulus, 4.2e4);
  EXPECT_EQ(object.body.material.poisson_ratio, 0.41);
  EXPECT_EQ(object.body.material.density, 31);
  EXPECT_EQ(object.body.damping.mass_factor, 3);
  EXPECT_EQ(object.body.damping.stiffness_factor, elasticity::Damping().stiffness_factor);
  EXPECT_EQ(bar("  material_file: fitted.yaml\n").body.material.density, 31);
}

TEST_F(MaterialFileTest, ItsStrainsAreTheLargestOfTheLawUnlessOneIsStated) {
  write("fitted.yaml", fitted_);
  const std::string file = "  material_file: fitted.yaml\n";
  EXPECT_EQ(bar(file).largest_strain, 0.3);
  EXPECT_EQ(bar(file + "  material: {largest_strain: 0.2}\n").largest_strain, 0.2);
  EXPECT_NE(refusal(file + "  material: {largest_strain: 0}\n").find("largest_strain"),
            std::string::npos);
  EXPECT_FALSE(
      bar("  material: {young_modulus: 1e5, poisson_ratio: 0.2, density: 26}\n").largest_strain);
}

TEST_F(MaterialFileTest, ItsLawIsTakenWithItsOwnModuliWhereTheModelIsNamed) {
  write("fitted.yaml", fitted_);
  const std::string file = "  material_file: fitted.yaml\n";
  EXPECT_FALSE(bar(file).body.law.has_value());
  const Object object = bar(file + "  material: {model: ogden_1}\n");
  EXPECT_EQ(object.body.law, elasticity::find_stretch_law("ogden_1")->make({4}));
  EXPECT_EQ(object.body.material.young_modulus, 5e4);
  EXPECT_EQ(object.body.material.poisson_ratio, 0.45);
  EXPECT_NE(refusal(file + "  material: {model: neo_hookean}\n").find("ogden_1"),
            std::string::npos);
  const std::string moduli = "young_modulus: 1e5, poisson_ratio: 0.2, density: 26";
  EXPECT_NE(refusal("  material: {model: ogden_1, " + moduli + "}\n").find("ogden_exponent"),
            std::string::npos);
  EXPECT_NE(refusal("  material: {model: rubber, " + moduli + "}\n").find("neo_hookean"),
            std::string::npos);
}

TEST_F(MaterialFileTest, DampingThatIsGivenStands) {
  write("fitted.yaml", fitted_);
  EXPECT_EQ(
      bar("  material_file: fitted.yaml\n  damping: {mass_factor: 7}\n").body.damping.mass_factor,
      7);
}

TEST_F(MaterialFileTest, AWrongFileIsNamed) {
  EXPECT_NE(refusal("  material_file: nowhere.yaml\n").find("nowhere.yaml"), std::string::npos);
  write("scene.yaml", "object: {size: 3}\n");
  EXPECT_NE(refusal("  material_file: scene.yaml\n").find("palpate-fit"), std::string::npos);
  write("without_corotational.yaml", "material: {model: linear, poisson_ratio: 0.3}\n");
  EXPECT_NE(refusal("  material_file: without_corotational.yaml\n").find("corotational"),
            std::string::npos);
  write("wild.yaml",
        "material: {model: linear}\ncorotational: {young_modulus: -1, poisson_ratio: 0.3}\n");
  EXPECT_NE(refusal("  material_file: wild.yaml\n").find("wild.yaml"), std::string::npos);
  write("weightless.yaml",
        "material: {model: linear}\ncorotational: {young_modulus: 1e4, poisson_ratio: 0.3}\n");
  EXPECT_NE(refusal("  material_file: weightless.yaml\n").find("density"), std::string::npos);
}

}  // namespace
}  // namespace palpate::registry
