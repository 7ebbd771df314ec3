#include "tools/import/fields.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

namespace palpate::import {
namespace {

using Units = std::map<std::string, double>;

constexpr const char* kQuaternionEffect = "orientation of the flange in the base, unit quaternion";

const Units& units_of(Dimension dimension) {
  static const std::map<Dimension, Units> kUnits = {
      {Dimension::kForce, {{"N", 1}, {"mN", 1e-3}, {"kN", 1e3}}},
      {Dimension::kTorque, {{"Nm", 1}, {"mNm", 1e-3}, {"Nmm", 1e-3}}},
      {Dimension::kLength, {{"m", 1}, {"cm", 1e-2}, {"mm", 1e-3}}},
      {Dimension::kAngle, {{"rad", 1}, {"deg", M_PI / 180}}},
      {Dimension::kSpeed, {{"m/s", 1}, {"mm/s", 1e-3}}},
      {Dimension::kAngularSpeed, {{"rad/s", 1}, {"deg/s", M_PI / 180}}},
      {Dimension::kAcceleration, {{"m/s2", 1}, {"g", 9.80665}, {"mg", 9.80665e-3}}},
      {Dimension::kNone, {{"1", 1}}},
  };
  return kUnits.at(dimension);
}

std::vector<Field> vector_fields(const std::string& prefix, Dimension dimension, bool required,
                                 const std::string& effect) {
  std::vector<Field> fields;
  for (const char* axis : {"x", "y", "z"})
    fields.push_back({prefix + axis, dimension, required, effect});
  return fields;
}

std::vector<Field> numbered(const std::string& prefix, int first, int count, Dimension dimension,
                            const std::string& effect) {
  std::vector<Field> fields;
  for (int i = first; i < first + count; ++i)
    fields.push_back({prefix + std::to_string(i), dimension, false, effect});
  return fields;
}

/// The column of "[-]column[:unit]"; empty for "=constant".
std::string column_of(const std::string& description) {
  if (!description.empty() && description.front() == '=') return "";
  const std::size_t begin = !description.empty() && description.front() == '-' ? 1 : 0;
  return description.substr(begin, description.find(':') - begin);
}

std::vector<Field> joined(const std::vector<std::vector<Field>>& groups) {
  std::vector<Field> all;
  for (const std::vector<Field>& group : groups) all.insert(all.end(), group.begin(), group.end());
  return all;
}

struct Format {
  const char* messages;       // their type
  std::vector<Field> fields;  // the encoders index into this list
};

const std::map<std::string, Format>& formats() {
  static const std::map<std::string, Format> kFormats = {
      {"force_torque",
       {"`ft_wrench_t`, for example on `FT_WRENCH`",
        joined({vector_fields("f", Dimension::kForce, true,
                              "force of the sensor on its load, in the sensor's frame"),
                vector_fields("t", Dimension::kTorque, true,
                              "torque of the sensor on its load, about the sensor's origin")})}},
      {"imu",
       {"`imu_t`, for example on `IMU`",
        joined({vector_fields("a", Dimension::kAcceleration, true,
                              "specific force in the unit's frame: at rest minus gravity"),
                vector_fields("w", Dimension::kAngularSpeed, false,
                              "angular velocity in the unit's frame")})}},
      {"robot_state",
       {"`robot_state_t`, for example on `ROBOT_STATE`",
        joined({vector_fields("p", Dimension::kLength, true,
                              "position of the flange in the robot's base"),
                {{"qw", Dimension::kNone, true, kQuaternionEffect}},
                vector_fields("q", Dimension::kNone, true, kQuaternionEffect),
                vector_fields("v", Dimension::kSpeed, false,
                              "linear velocity of the flange's origin, in the base's axes"),
                vector_fields("w", Dimension::kAngularSpeed, false,
                              "angular velocity of the flange, in the base's axes"),
                numbered("q", 1, 16, Dimension::kAngle,
                         "joint positions; the last one that has a column sets the joint count"),
                numbered("dq", 1, 16, Dimension::kAngularSpeed, "joint velocities"),
                numbered("tau", 1, 16, Dimension::kTorque, "joint torques")})}},
      {"biotac",
       {"`biotac_t`, for example on `BIOTAC_0`",
        joined(
            {numbered("e", 1, 19, Dimension::kNone, "electrodes, counts; all of them or none"),
             numbered("pac", 0, 22, Dimension::kNone,
                      "dynamic pressure, counts, oldest first; without gaps from `pac0` on"),
             {{"pdc", Dimension::kNone, false, "static pressure, counts"},
              {"tac", Dimension::kNone, false, "thermal flux, counts; valid with `tdc` only"},
              {"tdc", Dimension::kNone, false, "temperature, counts; valid with `tac` only"}}})}},
  };
  return kFormats;
}

template <class Container, class Name>
std::string listed(const Container& container, Name name) {
  std::string list;
  for (const auto& item : container) list += (list.empty() ? "" : ", ") + name(item);
  return list;
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
      "## " + format + "\n\nMessages of type " + formats().at(format).messages +
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

double unit_factor(Dimension dimension, const std::string& unit) {
  const Units& units = units_of(dimension);
  const auto found = units.find(unit);
  if (found == units.end())
    throw std::invalid_argument("unknown unit '" + unit + "'; allowed: " +
                                listed(units, [](const auto& item) { return item.first; }));
  return found->second;
}

std::string units_text(Dimension dimension) {
  if (dimension == Dimension::kNone) return "-";
  std::string si, others;
  for (const auto& [unit, factor] : units_of(dimension)) {
    if (factor == 1) {
      si = unit;
    } else {
      others += (others.empty() ? "" : ", ") + unit;
    }
  }
  return si + " (" + others + ")";
}

std::vector<std::string> needed_columns(const std::string& format,
                                        const std::map<std::string, std::string>& described) {
  std::vector<std::string> columns;
  for (const Field& field : fields_of(format)) {
    const auto found = described.find(field.name);
    if (found != described.end()) {
      const std::string column = column_of(found->second);
      if (!column.empty()) columns.push_back(column);
    } else if (field.required) {
      columns.push_back(field.name);
    }
  }
  return columns;
}

const std::vector<std::string>& format_names() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const auto& item : formats()) names.push_back(item.first);
    return names;
  }();
  return kNames;
}

const std::vector<Field>& fields_of(const std::string& format) {
  const auto found = formats().find(format);
  if (found == formats().end())
    throw std::invalid_argument("unknown format '" + format + "'; allowed: " +
                                listed(format_names(), [](const auto& name) { return name; }));
  return found->second.fields;
}

FieldMapping::FieldMapping(const std::string& format,
                           const std::map<std::string, std::string>& described,
                           const recordings::CsvReader& csv) {
  const std::vector<Field>& fields = fields_of(format);
  for (const auto& item : described) {
    const bool exists = std::any_of(fields.begin(), fields.end(),
                                    [&](const Field& field) { return field.name == item.first; });
    if (!exists)
      throw std::invalid_argument(
          "format " + format + " has no field '" + item.first +
          "'; its fields: " + listed(fields, [](const Field& field) { return field.name; }));
  }
  for (const Field& field : fields) {
    Source source;
    const auto found = described.find(field.name);
    if (found == described.end()) {
      if (csv.has_column(field.name)) {
        source = {true, csv.column(field.name), 1, 0};
      } else if (field.required) {
        csv.column(field.name);  // throws, listing the existing columns
      }
      sources_.push_back(source);
      continue;
    }
    const std::string& text = found->second;
    source.known = true;
    try {
      if (!text.empty() && text.front() == '=') {
        std::size_t used = 0;
        source.constant = std::stod(text.substr(1), &used);
        if (used + 1 != text.size() || !std::isfinite(source.constant))
          throw std::invalid_argument("not a number");
      } else {
        if (!text.empty() && text.front() == '-') source.factor = -1;
        const std::size_t colon = text.find(':');
        if (colon != std::string::npos)
          source.factor *= unit_factor(field.dimension, text.substr(colon + 1));
        source.column = csv.column(column_of(text));
      }
    } catch (const std::logic_error& error) {
      throw std::invalid_argument("field " + field.name + ": '" + found->second +
                                  "': " + error.what());
    }
    sources_.push_back(source);
  }
}

bool FieldMapping::has_any(int first, int count) const {
  return std::any_of(sources_.begin() + first, sources_.begin() + first + count,
                     [](const Source& source) { return source.known; });
}

double FieldMapping::value(const recordings::CsvReader& csv, int i) const {
  const Source& source = sources_[i];
  return source.column < 0 ? source.constant : source.factor * csv.number(source.column);
}

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
