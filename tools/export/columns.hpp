#pragma once

#include <string>
#include <vector>

#include "tools/log/record.hpp"

namespace palpate::exporting {

/// One column of a table: a number or a text of a message.
struct Column {
  enum class Kind { kNumber, kText, kHash, kBytes, kLength };

  std::string name;  // as wrench[0], location[2][1]
  std::string unit;  // empty where there is none
  std::string meaning;
  Kind kind = Kind::kNumber;
  int field = 0;
  int index = 0;  // number in the field; row of a text
};

/// The columns of a type where field f has at most widths[f] numbers in use. Bytes are one column
/// in hexadecimal; where they are more than kMostBytes, their number alone.
std::vector<Column> columns(const log::TypeInfo& type, const std::vector<int>& widths);
inline constexpr int kMostBytes = 64;

/// The name of a number: the field's, with an index for each dimension.
std::string element_name(const log::FieldInfo& field, int index);

/// The unit of a number as people read it; empty where it has none.
std::string unit_text(const log::FieldInfo& field, int index);

}  // namespace palpate::exporting
