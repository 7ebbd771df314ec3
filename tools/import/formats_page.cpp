#include "tools/import/formats_page.hpp"

#include <map>

#include "tools/import/fields.hpp"

namespace palpate::import {
namespace {

const char* channel_type(const std::string& format) {
  static const std::map<std::string, const char*> kTypes = {
      {"biotac", "`biotac_t`, for example on `BIOTAC_0`"},
      {"force_torque", "`ft_wrench_t`, for example on `FT_WRENCH`"},
      {"imu", "`imu_t`, for example on `IMU`"},
      {"robot_state", "`robot_state_t`, for example on `ROBOT_STATE`"}};
  return kTypes.at(format);
}

/// "`fx`, `fy`, `fz`", or, of more than four, "`q1` to `q16`".
std::string names_of(const std::vector<Field>& fields, std::size_t begin, std::size_t end) {
  if (end - begin > 4) return "`" + fields[begin].name + "` to `" + fields[end - 1].name + "`";
  std::string names;
  for (std::size_t i = begin; i < end; ++i)
    names += (names.empty() ? "`" : ", `") + fields[i].name + "`";
  return names;
}

std::string table(const std::string& format) {
  const std::vector<Field>& fields = fields_of(format);
  std::string text =
      "## " + format + "\n\nMessages of type " + channel_type(format) +
      ".\n\n| field | unit (others) | required | effect |\n| --- | --- | --- | --- |\n";
  for (std::size_t begin = 0; begin < fields.size();) {
    const Field& first = fields[begin];
    std::size_t end = begin;
    while (end < fields.size() && fields[end].effect == first.effect) ++end;
    text += "| " + names_of(fields, begin, end) + " | " + units_text(first.dimension) + " | " +
            (first.required ? "yes" : "no") + " | " + first.effect + " |\n";
    begin = end;
  }
  return text;
}

}  // namespace

std::string formats_page() {
  std::string text =
      "# Formats of palpate-import\n\n"
      "Made by `palpate-import --formats`; do not edit.\n\n"
      "A recording is a file of delimited values with a header line (comma, semicolon or tab; "
      "quotes as in RFC 4180), plain or compressed by gzip.\n"
      "A field takes the column of its own name, in the first unit of its row. "
      "`--column FIELD=[-]COLUMN[:UNIT]` takes another column,\n"
      "with the opposite sign, or in one of the other units; `--column FIELD==CONSTANT` sets a "
      "constant in the first unit. A field that is not required\n"
      "and has no column is zero.\n"
      "The column `t` holds the time in seconds; `--time-column` and `--time-unit` name another "
      "column and unit, and `--rate` replaces it.\n";
  for (const std::string& format : format_names()) text += "\n" + table(format);
  return text;
}

}  // namespace palpate::import
