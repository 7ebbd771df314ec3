#include "tools/import/fields.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::import {
namespace {

using Units = std::map<std::string, double>;

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

std::vector<Field> vector_fields(const std::string& prefix, Dimension dimension, bool required) {
  std::vector<Field> fields;
  for (const char* axis : {"x", "y", "z"}) fields.push_back({prefix + axis, dimension, required});
  return fields;
}

std::vector<Field> numbered(const std::string& prefix, int first, int count, Dimension dimension) {
  std::vector<Field> fields;
  for (int i = first; i < first + count; ++i)
    fields.push_back({prefix + std::to_string(i), dimension, false});
  return fields;
}

std::vector<Field> joined(const std::vector<std::vector<Field>>& groups) {
  std::vector<Field> all;
  for (const std::vector<Field>& group : groups) all.insert(all.end(), group.begin(), group.end());
  return all;
}

/// The encoders index into these lists.
const std::map<std::string, std::vector<Field>>& formats() {
  static const std::map<std::string, std::vector<Field>> kFormats = {
      {"force_torque", joined({vector_fields("f", Dimension::kForce, true),
                               vector_fields("t", Dimension::kTorque, true)})},
      {"imu", joined({vector_fields("a", Dimension::kAcceleration, true),
                      vector_fields("w", Dimension::kAngularSpeed, false)})},
      {"robot_state", joined({vector_fields("p", Dimension::kLength, true),
                              {{"qw", Dimension::kNone, true}},
                              vector_fields("q", Dimension::kNone, true),
                              vector_fields("v", Dimension::kSpeed, false),
                              vector_fields("w", Dimension::kAngularSpeed, false),
                              numbered("q", 1, 16, Dimension::kAngle),
                              numbered("dq", 1, 16, Dimension::kAngularSpeed),
                              numbered("tau", 1, 16, Dimension::kTorque)})},
      {"biotac", joined({numbered("e", 1, 19, Dimension::kNone),
                         numbered("pac", 0, 22, Dimension::kNone),
                         {{"pdc", Dimension::kNone, false},
                          {"tac", Dimension::kNone, false},
                          {"tdc", Dimension::kNone, false}}})},
  };
  return kFormats;
}

template <class Container, class Name>
std::string listed(const Container& container, Name name) {
  std::string list;
  for (const auto& item : container) list += (list.empty() ? "" : ", ") + name(item);
  return list;
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
  return found->second;
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
    std::string text = found->second;
    source.known = true;
    try {
      if (!text.empty() && text.front() == '=') {
        std::size_t used = 0;
        source.constant = std::stod(text.substr(1), &used);
        if (used + 1 != text.size() || !std::isfinite(source.constant))
          throw std::invalid_argument("not a number");
      } else {
        if (!text.empty() && text.front() == '-') {
          source.factor = -1;
          text.erase(0, 1);
        }
        const std::size_t colon = text.find(':');
        if (colon != std::string::npos)
          source.factor *= unit_factor(field.dimension, text.substr(colon + 1));
        source.column = csv.column(text.substr(0, colon));
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

}  // namespace palpate::import
