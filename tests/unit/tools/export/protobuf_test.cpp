#include <google/protobuf/descriptor.pb.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "tools/export/foxglove_schemas.hpp"
#include "tools/export/protobuf_encoder.hpp"

namespace palpate::exporting {
namespace {

TEST(Protobuf, DescribesEveryMessageOnceAndItsPartsBeforeIt) {
  google::protobuf::FileDescriptorSet set;
  ASSERT_TRUE(set.ParseFromString(ProtobufEncoder().descriptions()));
  ASSERT_EQ(set.file_size(), 3) << "times, and Foxglove's";
  EXPECT_EQ(set.file(2).package(), "foxglove");
  EXPECT_EQ(set.file(2).message_type_size(), static_cast<int>(foxglove_messages().size()));
  EXPECT_THROW(foxglove_schema("foxglove.Vector4"), std::invalid_argument);
}

/// Bytes by hand, from the encoding of Protobuf: tag = number << 3 | wire type.
TEST(Protobuf, EncodesAsItsRulesSay) {
  const std::string json =
      R"({"timestamp": {"sec": 3, "nsec": 5000}, "frame_id": "W", "pose": {"position": {"x": 0, "y": 1, "z": 0}}})";
  const std::string one("\x11\x00\x00\x00\x00\x00\x00\xf0\x3f", 9);  // field 2: 1.0
  EXPECT_EQ(ProtobufEncoder().encode("foxglove.PoseInFrame", json),
            std::string("\x0a\x05\x08\x03\x10\x88\x27", 7) + std::string("\x12\x01W", 3) +
                std::string("\x1a\x0b\x0a\x09", 4) + one);
}

TEST(Protobuf, RefusesWhatDoesNotFit) {
  ProtobufEncoder encoder;
  EXPECT_THROW(encoder.encode("foxglove.Nothing", "{}"), std::runtime_error);
  EXPECT_THROW(encoder.encode("foxglove.PoseInFrame", R"({"frame": "W"})"), std::runtime_error);
  EXPECT_THROW(encoder.encode("foxglove.PoseInFrame", R"({"frame_id": []})"), std::runtime_error);
}

}  // namespace
}  // namespace palpate::exporting
