#pragma once

#include <memory>
#include <string>

namespace palpate::exporting {

/// Encodes Foxglove's messages (foxglove_schemas.hpp) in Protobuf.
class ProtobufEncoder {
 public:
  ProtobufEncoder();
  ~ProtobufEncoder();

  /// Their descriptions with those of times: an encoded google.protobuf.FileDescriptorSet.
  const std::string& descriptions() const { return descriptions_; }
  /// The message of that schema, foxglove.X, whose JSON is given. Throws std::runtime_error if it
  /// does not fit.
  std::string encode(const std::string& schema, const std::string& json);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  std::string descriptions_;
};

}  // namespace palpate::exporting
