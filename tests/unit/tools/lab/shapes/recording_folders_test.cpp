#include "tools/lab/shapes/recording_folders.hpp"

#include <gtest/gtest.h>

#include "rt/config/node.hpp"
#include "tests/support/recordings.hpp"
#include "tests/unit/tools/lab/shapes/shape_folder.hpp"
#include "tools/lab/shapes/pushed_sponge.hpp"
#include "tools/recordings/csv_reader.hpp"

namespace palpate::shapes {
namespace {

const char* const kFrames =
    "frame,t_s,finger_x_px,finger_y_px,fx_N,fy_N,fz_N\n"
    "0,0.0,10,300,0,0,0.02\n1,0.2,10,340,0,0,-1.5\n";

TEST(RecordingFolders, FindsFormatsByContentInAFolderAndBelow) {
  const ShapeFolder folder;
  folder.write("one.yaml", kCylinder);
  folder.write("beams/other.yaml", kBeam);
  folder.write("sponge/x_frames.csv", kFrames);
  folder.write("sponge/x_contour.csv", "frame,x_px,y_px\n0,1,2\n0,3,4\n");
  folder.write("alone/y_frames.csv", kFrames);  // no outline
  folder.write("else/case.yaml", "name: another kind\n");
  const ShapeFiles files = find_shapes(folder.path());
  ASSERT_EQ(files.cylinders.size(), 1u);
  EXPECT_EQ(files.cylinders[0].filename(), "one.yaml");
  ASSERT_EQ(files.beams.size(), 1u);
  ASSERT_EQ(files.sponges.size(), 1u);
  EXPECT_TRUE(find_shapes(folder.path() / "else").empty());
  EXPECT_EQ(find_shapes(folder.path() / "beams").beams.size(), 1u);

  const PushedSponge sponge = read_pushed_sponge(files.sponges[0]);
  EXPECT_EQ(sponge.recording, "sponge/x");
  EXPECT_EQ(sponge.frames, 2);
  EXPECT_EQ(sponge.contour_points, 2);
  EXPECT_DOUBLE_EQ(sponge.travel, 40);
  EXPECT_DOUBLE_EQ(sponge.largest_force, 1.5);
}

TEST(RecordingFolders, SpongeWithoutAColumnOrFrameIsAnError) {
  const ShapeFolder folder;
  folder.write("x_contour.csv", "frame,x_px,y_px\n");
  EXPECT_THROW(read_pushed_sponge(folder.write("x_frames.csv", "frame,t_s\n0,1\n")),
               recordings::CsvError);
  EXPECT_THROW(read_pushed_sponge(folder.write(
                   "x_frames.csv", "frame,t_s,finger_x_px,finger_y_px,fx_N,fy_N,fz_N\n")),
               recordings::CsvError);
}

TEST(RecordingFolders, EveryRecordedShapeIsFound) {
  PALPATE_REQUIRE_RECORDING("sponge_push_uobham");
  const ShapeFiles files = find_shapes(support::recordings() / "sponge_push_uobham");
  ASSERT_EQ(files.sponges.size(), 1u);
  EXPECT_EQ(read_pushed_sponge(files.sponges[0]).frames, 100);
}

}  // namespace
}  // namespace palpate::shapes
