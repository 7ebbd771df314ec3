#pragma once

#include <string>
#include <vector>

#include "tools/log/record.hpp"

namespace palpate::exporting {

/// One column of a table: a number or a text of a message.
struct Column {
  enum class Kind { kNumber, kText, kHash, kBytes, kLength };

  std::string name;  // as wrench[0], location[2][1]
  std::string unit;  // empty if there is none
  std::string meaning;
  Kind kind = Kind::kNumber;
  int field = 0;
  int index = 0;  // number in the field; row of a text
};

/// The columns of a type whose field f has at most widths[f] numbers in use. Bytes are one column
/// in hexadecimal; if there are more than kMostBytes, only their number.
std::vector<Column> columns(const log::TypeInfo& type, const std::vector<int>& widths);
inline constexpr int kMostBytes = 64;

/// Name of a number: the field's, with an index for each dimension.
std::string element_name(const log::FieldInfo& field, int index);

/// Unit of a number in readable form; empty if it has none.
std::string unit_text(const log::FieldInfo& field, int index);

}  // namespace palpate::exporting
