#include "tools/lab/shapes/pushed_sponge.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "tests/support/recordings.hpp"
#include "tests/unit/tools/lab/shapes/shape_folder.hpp"
#include "tools/lab/shapes/sponge_model.hpp"
#include "tools/recordings/csv_reader.hpp"

namespace palpate::shapes {
namespace {

constexpr double kLeft = 50, kRight = 210, kTop = 100, kBottom = 200;  // pixels
constexpr double kTouch = kTop - kFingerRadius;
constexpr int kFrameCount = 12;  // the finger moves down to frame 9

double height_of(int frame) { return kTouch - 6 + 4 * std::min(frame, 18 - frame); }

std::string frames(double force_per_pixel) {
  std::ostringstream text;
  text << "frame,t_s,finger_x_px,finger_y_px,fx_N,fy_N,fz_N\n";
  for (int k = 0; k < kFrameCount; ++k) {
    text << k << ',' << 0.2 * k << ",130," << height_of(k) << ",0,0,"
         << -force_per_pixel * std::max(0.0, height_of(k) - kTouch) << '\n';
  }
  return text.str();
}

std::string outline(double bottom) {
  std::ostringstream text;
  text << "frame,x_px,y_px\n";
  for (double x = kLeft; x <= kRight; x += 2)
    text << "0," << x << ',' << kTop << "\n0," << x << ',' << bottom + 0.01 * (x - kLeft) << '\n';
  for (double y = kTop; y <= kBottom; y += 2)
    text << "0," << kLeft << ',' << y << "\n0," << kRight << ',' << y << '\n';
  return text.str();
}

PushedSponge read_trial(const std::string& frames, const std::string& contour) {
  const ShapeFolder folder;
  folder.write("sponge/x_contour.csv", contour);
  return read_pushed_sponge(folder.write("sponge/x_frames.csv", frames));
}

TEST(PushedSponge, RestAndFirstContactFollowFromOutlineAndForce) {
  const PushedSponge sponge = read_trial(frames(0.02), outline(kBottom));
  EXPECT_EQ(sponge.recording, "sponge/x");
  ASSERT_EQ(static_cast<int>(sponge.frames.size()), kFrameCount);
  EXPECT_EQ(sponge.last_loading, 9);
  EXPECT_NEAR(sponge.contact_height, kTouch, 1e-9);
  Eigen::Matrix<double, 2, 4> corners;
  corners << kLeft, kRight, kRight, kLeft, kTop, kTop, kBottom + 1.6, kBottom;
  EXPECT_LT((sponge.corners - corners).norm(), 1e-9);
  EXPECT_NEAR(sponge.depth(sponge.frames[9]), 30 / 100.8, 1e-3);
}

TEST(PushedSponge, ADamagedTrialIsAnErrorWithTheFile) {
  const auto message = [](const std::string& frames, const std::string& contour) {
    try {
      read_trial(frames, contour);
    } catch (const recordings::CsvError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const auto has = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(has(message("frame,t_s\n0,1\n", outline(kBottom)), "x_frames.csv"));
  EXPECT_TRUE(
      has(message("frame,t_s,finger_x_px,finger_y_px,fz_N\n", outline(kBottom)), "no frame"));
  EXPECT_TRUE(has(message(frames(0.02), "frame,x_px,y_px\n99,1,2\n"), "frame"));
  EXPECT_TRUE(has(message(frames(0.02), "frame,x_px,y_px\n0,1,2\n"), "four sides"));
  EXPECT_TRUE(has(message(frames(0), outline(kBottom)), "no force rises"));
}

TEST(PushedSponge, TheModelFollowsTheFingerAndStaysOnTheTable) {
  const PushedSponge sponge = read_trial(frames(0.02), outline(kBottom));
  const SpongeModel model(sponge, {6, 4});
  const std::vector<PredictedSponge> predicted =
      model.predict({0.1, sponge.contact_height}, sponge.last_loading);
  ASSERT_EQ(static_cast<int>(predicted.size()), sponge.last_loading + 1);
  EXPECT_EQ(predicted[0].force, 0);
  for (int k = 3; k <= sponge.last_loading; ++k)
    EXPECT_GT(predicted[k].force, predicted[k - 1].force) << k;
  const Eigen::Matrix2Xd& last = predicted.back().outline;
  const double finger = height_of(sponge.last_loading) + kFingerRadius;  // its lowest point
  double deepest = 0;  // y of the outline below the finger, on the upper side
  for (int i = 0; i < last.cols(); ++i) {
    if (std::abs(last(0, i) - 130) < 1 && last(1, i) < 0.5 * (kTop + kBottom))
      deepest = std::max(deepest, last(1, i));
  }
  EXPECT_NEAR(deepest, finger, 0.5);
  EXPECT_NEAR(last.row(1).maxCoeff(), kBottom + 1.6, 0.5);
  // stiffness of a strip: between that of the part below the finger and that of the whole sponge
  const double E = SpongeModel::kModulus, depth = kPixel * 30, height = kPixel * 101;
  const double whole = E * kThickness * kPixel * 160 * depth / height;
  EXPECT_LT(predicted.back().force, whole);
  EXPECT_GT(predicted.back().force, 0.3 * whole);
}

TEST(PushedSponge, TheRecordedTrialIsRead) {
  PALPATE_REQUIRE_RECORDING("sponge_push_uobham");
  const PushedSponge sponge =
      read_pushed_sponge(support::recordings() / "sponge_push_uobham" / "sponge_centre_frames.csv");
  EXPECT_EQ(sponge.frames.size(), 100u);
  EXPECT_NEAR(sponge.length(), 390, 2);
  EXPECT_NEAR(sponge.height(), 234, 3);
  EXPECT_NEAR(sponge.contact_height, 352, 10);
}

}  // namespace
}  // namespace palpate::shapes
