#include "tools/lab/shapes/recording_folders.hpp"

#include <gtest/gtest.h>

#include "rt/config/node.hpp"
#include "tests/unit/tools/lab/shapes/shape_folder.hpp"

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
}

}  // namespace
}  // namespace palpate::shapes
