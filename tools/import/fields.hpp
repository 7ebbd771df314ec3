#pragma once

#include <map>
#include <string>
#include <vector>

#include "tools/recordings/csv_reader.hpp"

namespace palpate::import {

/// Dimension of a field; determines the units that a column may have.
enum class Dimension {
  kForce,
  kTorque,
  kLength,
  kAngle,
  kSpeed,
  kAngularSpeed,
  kAcceleration,
  kNone
};

/// Factor from `unit` to SI; throws std::invalid_argument listing the units.
double unit_factor(Dimension dimension, const std::string& unit);

/// The units of a dimension, SI first: "N (mN, kN)"; "-" where it has none.
std::string units_text(Dimension dimension);

/// One number of a message.
struct Field {
  std::string name;
  Dimension dimension = Dimension::kNone;
  bool required = false;
  std::string effect;  // what it sets; alike for fields that belong together
};

/// Message types that can be imported: force_torque, imu, robot_state, biotac.
const std::vector<std::string>& format_names();
/// Fields of a format; throws std::invalid_argument listing the formats.
const std::vector<Field>& fields_of(const std::string& format);

/// The columns that a file must have for a format described so: see FieldMapping.
std::vector<std::string> needed_columns(const std::string& format,
                                        const std::map<std::string, std::string>& described);

/// Sources of the fields of one format in one file. A field is described by "[-]column[:unit]" or
/// "=constant" (in SI); by default it is read from the column of its own name, in SI, if there is
/// one.
class FieldMapping {
 public:
  /// Throws CsvError or std::invalid_argument: unknown field, column or unit, or a required field
  /// without a column.
  FieldMapping(const std::string& format, const std::map<std::string, std::string>& described,
               const recordings::CsvReader& csv);

  /// Whether field `i` of fields_of(format) is available.
  bool has(int i) const { return sources_[i].known; }
  bool has_any(int first, int count) const;
  /// Value of the current row in SI; 0 if the field is absent.
  double value(const recordings::CsvReader& csv, int i) const;
  /// Column of field `i`, -1 for a constant or an absent field.
  int column(int i) const { return sources_[i].column; }

 private:
  struct Source {
    bool known = false;
    int column = -1;
    double factor = 1;
    double constant = 0;
  };
  std::vector<Source> sources_;
};

/// What palpate-import reads, in Markdown: a table of fields, unit, whether required and effect for
/// each of format_names(), from the table that the import itself goes by. It is docs/import.md.
std::string formats_page();

}  // namespace palpate::import
