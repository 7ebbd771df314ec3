#include "tools/export/columns.hpp"

#include <algorithm>

namespace palpate::exporting {
namespace {

void add_texts(std::vector<Column>& columns, const log::FieldInfo& field, int place, int width) {
  const int rows = field.sizes.size() < 2 ? 1 : width / field.row_size();
  for (int row = 0; row < rows; ++row) {
    const std::string name =
        field.sizes.size() < 2 ? field.name : field.name + "[" + std::to_string(row) + "]";
    columns.push_back({name, "", field.comment, Column::Kind::kText, place, row});
  }
}

void add_bytes(std::vector<Column>& columns, const log::FieldInfo& field, int place, int width) {
  if (field.length_field >= 0 || width > kMostBytes)
    columns.push_back(
        {field.name + ".length", "byte", field.comment, Column::Kind::kLength, place, 0});
  else
    columns.push_back({field.name, "", field.comment, Column::Kind::kBytes, place, 0});
}

}  // namespace

std::string element_name(const log::FieldInfo& field, int index) {
  if (field.is_scalar()) return field.name;
  if (field.sizes.size() == 1) return field.name + "[" + std::to_string(index) + "]";
  std::string places;
  for (std::size_t d = field.sizes.size() - 1; d > 0; --d) {
    places = "[" + std::to_string(index % field.sizes[d]) + "]" + places;
    index /= field.sizes[d];
  }
  return field.name + "[" + std::to_string(index) + "]" + places;
}

std::string unit_text(const log::FieldInfo& field, int index) {
  const std::string& unit = field.unit(index);
  return unit == "1" || unit == "hash" || unit == "text" || unit == "bytes" ? "" : unit;
}

std::vector<Column> columns(const log::TypeInfo& type, const std::vector<int>& widths) {
  std::vector<Column> result;
  for (std::size_t f = 0; f < type.fields.size(); ++f) {
    const log::FieldInfo& field = type.fields[f];
    const int place = static_cast<int>(f);
    if (field.is_text()) {
      add_texts(result, field, place, widths[f]);
    } else if (field.is_bytes()) {
      add_bytes(result, field, place, widths[f]);
    } else {
      const auto kind = field.is_hash() ? Column::Kind::kHash : Column::Kind::kNumber;
      for (int i = 0; i < widths[f]; ++i)
        result.push_back(
            {element_name(field, i), unit_text(field, i), field.comment, kind, place, i});
    }
  }
  return result;
}

}  // namespace palpate::exporting
