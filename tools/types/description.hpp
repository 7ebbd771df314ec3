#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace palpate::types {

/// What a member holds.
enum class Kind {
  kInt8,
  kInt16,
  kInt32,
  kInt64,
  kByte,
  kBoolean,
  kFloat,
  kDouble,
  kString,
  kEnumeration,  // an int32_t on the wire
  kStruct
};

/// Encoded size of a value, bytes; 0 for kString and kStruct, whose values differ in size.
int size_of(Kind kind);

struct Dimension {
  std::string
      text;      // the size or the name of a member, as written (a constant's value for its name)
  int size = 0;  // unless a member holds it
  int member = -1;  // index of the member of the same struct that holds the size; -1: none
};

struct Struct;

struct Member {
  std::string name;
  std::string type;  // double, or package.name_t
  Kind kind = Kind::kInt32;
  const Struct* content = nullptr;  // of kStruct
  std::vector<Dimension> dimensions;
  std::string comment;  // on its line, or on the lines before
};

struct Constant {
  std::string type, name, value;  // the value as written
};

/// A struct of an .lcm file.
struct Struct {
  std::string name;   // package.name_t
  std::string place;  // file:line
  std::string comment;
  std::vector<Constant> constants;
  std::vector<Member> members;
  std::int64_t fingerprint = 0;  // LCM's hash, the first eight bytes of a message
};

/// An enum of an .lcm file, as LCM had them until version 1.3.
struct Enumeration {
  std::string name;  // package.name_t
  std::string place;
  std::vector<std::pair<std::string, std::int32_t>> values;
};

}  // namespace palpate::types
