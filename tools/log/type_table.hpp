#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace palpate::log {

enum class Primitive { kInt8, kInt16, kInt32, kInt64, kByte, kFloat, kDouble };

/// Encoded size of one number, bytes.
int size_of(Primitive primitive);

/// One field of a message type.
struct FieldInfo {
  std::string name;
  Primitive primitive = Primitive::kInt32;
  std::vector<int> sizes;          // of each dimension; {0} if length_field gives it
  int length_field = -1;           // index of the field with the number of values sent
  int count_field = -1;            // index of the field with the number of rows in use
  std::vector<std::string> units;  // one for all, or one for each index of the last dimension
  std::string comment;             // of the .lcm file; may be empty

  bool is_integer() const { return primitive <= Primitive::kInt64; }
  bool is_bytes() const { return primitive == Primitive::kByte; }
  bool is_text() const { return units.front() == "text"; }  // zero-terminated
  bool is_hash() const { return units.front() == "hash"; }  // an identifier rather than a number
  bool is_scalar() const { return sizes.empty(); }
  /// Numbers in one row, an entry of the first dimension.
  int row_size() const;
  /// Of the number at `index`, counted through all dimensions.
  const std::string& unit(int index) const;
};

/// One message type of lcmtypes/.
struct TypeInfo {
  std::string name;  // as ft_wrench_t
  std::string comment;
  std::int64_t fingerprint = 0;
  std::vector<std::pair<std::string, std::int64_t>> constants;
  std::vector<FieldInfo> fields;

  /// Index of a field; -1 if there is none.
  int field(const std::string& field_name) const;
};

/// All types of lcmtypes/, by name. Generated when palpate is built.
const std::vector<TypeInfo>& types();

/// The type of an encoded message; nullptr for an unknown one and for less than a fingerprint.
const TypeInfo* type_of(const std::uint8_t* data, int size);

}  // namespace palpate::log
