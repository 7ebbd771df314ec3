#include "tools/export/picture_export.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "sim/draw/annotate.hpp"
#include "sim/draw/image.hpp"
#include "tests/unit/tools/export/python.hpp"
#include "tests/unit/tools/export/small_run.hpp"

namespace palpate::exporting {
namespace {

class PictureTest : public testing::Test {
 protected:
  PictureTest() {
    drawing_.width = 480;
    drawing_.height = 300;
  }

  draw::Image picture(const std::vector<double>& times) {
    const auto file = run_.folder() / "picture.png";
    export_png(follower_, drawing_, times, file);
    return draw::read_png(file.string());
  }

  /// Fraction of the pixels that are near a colour up to brightness.
  static double share(const draw::Image& image, const draw::Colour& colour) {
    const Eigen::Vector3d wanted =
        Eigen::Vector3d(colour.red, colour.green, colour.blue).normalized();
    int count = 0;
    for (int row = 0; row < image.height; ++row)
      for (int column = 0; column < image.width; ++column) {
        const std::uint8_t* p = image.pixel(column, row);
        const Eigen::Vector3d rgb(p[0], p[1], p[2]);
        if (rgb.norm() > 60 && rgb.normalized().dot(wanted) > 0.995) ++count;
      }
    return count / static_cast<double>(image.width * image.height);
  }

  SmallRun run_;
  Source source_{quiet({run_.control(), run_.housekeeping()})};
  ShapeFollower follower_{source_, {}};
  DrawingOptions drawing_;
};

TEST_F(PictureTest, ColoursShowTheQuantity) {
  drawing_.quantity = Quantity::kStrain;
  drawing_.low = 0;
  drawing_.high = 0.2;
  // Half of the scale's end: equivalent strain of a stretch of 1.1 is 2/3 of its 0.105.
  const double value = 2.0 / 3 * 0.5 * (1.1 * 1.1 - 1) / 0.2;
  const draw::Image late = picture({1.02});
  EXPECT_EQ(late.width, 480);
  EXPECT_GT(share(late, draw::colour_map(value)), 0.05);
  const draw::Image early = picture({0.02});
  EXPECT_LT(share(early, draw::colour_map(value)), 0.02);
  EXPECT_GT(share(early, draw::colour_map(0)), 0.015);
  EXPECT_LT(share(late, draw::colour_map(0)), 0.005);
}

TEST_F(PictureTest, TruthAndForcesCanBeSeen) {
  drawing_.quantity = Quantity::kNone;
  const draw::Colour wire{0.86F, 0.10F, 0.10F, 1}, arrow{0.90F, 0.35F, 0.05F, 1};
  const draw::Image image = picture({});
  EXPECT_GT(share(image, wire), 0.002);
  EXPECT_GT(share(image, arrow), 0.002);
}

TEST_F(PictureTest, ObstaclesOfTheConfigurationCanBeSeen) {
  drawing_.configuration = (run_.folder() / "palpated.yaml").string();
  const std::string frames =
      "frames: {object_in_base: {position: [0.6, 0, 0.3]}, gravity_in_base: [0, 0, -9.81]}\n";
  const auto with = [&](const std::string& obstacles) {
    std::ofstream(drawing_.configuration) << frames << obstacles;
    return picture({1.02});
  };
  const draw::Image without = with("");
  const auto change = [&](const std::string& shape) {
    const draw::Image image = with("obstacles:\n  - {name: it, " + shape + "}\n");
    int count = 0;
    // Not of the legend.
    for (int row = image.height / 4; row < image.height; ++row)
      for (int column = 0; column < image.width; ++column) {
        const std::uint8_t *p = image.pixel(column, row), *q = without.pixel(column, row);
        if (std::abs(p[0] - q[0]) + std::abs(p[1] - q[1]) > 8) ++count;
      }
    return count / static_cast<double>(image.width * image.height);
  };
  const std::string there = ", pose: {position: [0.7, 0, 0.2]}";
  EXPECT_GT(change("shape: half_space" + there), 0.15);
  const double box = change("shape: box, size: [0.06, 0.06, 0.06]" + there);
  EXPECT_GT(box, 0.005);
  EXPECT_LT(box, 0.15);
  for (const char* shape : {"shape: sphere, radius: 0.03", "shape: cylinder, radius: 0.03",
                            "shape: capsule, radius: 0.02, length: 0.06"})
    EXPECT_GT(change(shape + there), 0.003) << shape;
  const std::string lid = "shape: box, size: [0.06, 0.06, 0.06], moved: true";
  EXPECT_EQ(change(lid), 0) << "nothing has placed it";
  EXPECT_NEAR(change(lid + there), box, 1e-9);
}

TEST_F(PictureTest, SeveralTimesMakeSeveralPictures) {
  drawing_.width = 160;
  drawing_.height = 120;
  const auto written = export_png(follower_, drawing_, {0.9, 0.1}, run_.folder() / "many.png");
  ASSERT_EQ(written.size(), 2u);
  EXPECT_EQ(written[0].file.filename(), "many_000.060.png");  // the shape at 0.1 s
  EXPECT_TRUE(std::filesystem::exists(written[1].file));
}

TEST_F(PictureTest, WhatTheLogLacksIsReported) {
  drawing_.quantity = Quantity::kUncertainty;
  EXPECT_THROW(picture({}), std::runtime_error);
  drawing_.quantity = Quantity::kDisplacement;
  EXPECT_THROW(picture({-5}), std::runtime_error);
  EXPECT_THROW(export_png(follower_, drawing_, {}, run_.folder() / "a.jpg"), std::runtime_error);
}

TEST_F(PictureTest, AFilmHasItsPicturesAndLength) {
  drawing_.width = 160;
  drawing_.height = 120;
  FilmOptions film;
  film.rate = 10;
  film.speed = 0.5;
  const auto file = run_.folder() / "film.mp4";
  const auto written = export_mp4(follower_, drawing_, film, file);
  EXPECT_EQ(written[0].count, 21);  // one second at half speed, both ends shown
  const Answer answer = run({"/usr/bin/ffprobe", "-v", "error", "-count_frames", "-show_entries",
                             "stream=codec_name,width,height,nb_read_frames", "-of",
                             "default=noprint_wrappers=1", file.string()});
  EXPECT_EQ(answer.code, 0) << answer.text;
  for (const char* part : {"codec_name=h264", "width=160", "height=120", "nb_read_frames=21"})
    EXPECT_NE(answer.text.find(part), std::string::npos) << answer.text;
  drawing_.width = 161;
  EXPECT_THROW(export_mp4(follower_, drawing_, film, file), std::invalid_argument);
}

TEST(SurfaceEdges, HaveNoDiagonalsOfHexahedra) {
  const log::MeshMessage box = hexahedral_box({2, 1, 1}, {2, 1, 1});
  // 20 edges of two adjacent elements, each of two segments; 16 of them along the box's corners.
  EXPECT_EQ(surface_edges(box, Edges::kAll).cols(), 40);
  EXPECT_EQ(surface_edges(box, Edges::kSharp).cols(), 2 * 16);
}

}  // namespace
}  // namespace palpate::exporting
