#pragma once

#include <string>
#include <vector>

#include "tools/log/type_table.hpp"

namespace palpate::log {

/// One message of any type, decoded with the type table. Reused from message to message, so that a
/// log of many GB needs no allocation for each.
class Record {
 public:
  explicit Record(const TypeInfo& type);

  /// Decodes an encoded message. False if it is incomplete, or of another type; the contents are
  /// then undefined.
  bool decode(const std::uint8_t* data, int size);

  const TypeInfo& type() const { return *type_; }

  /// Number of values of a field as sent, and how many of them are in use: fewer if another field
  /// of the message is their count.
  int size(int field) const { return static_cast<int>(values_[field].size()); }
  int used(int field) const { return used_[field]; }

  /// The number at `index`, counted through all dimensions. Exact for types up to 32 bits; for
  /// 64-bit integers use integer().
  double number(int field, int index) const;
  std::int64_t integer(int field, int index) const { return values_[field][index].integer; }
  /// A number as written to a file: the shortest text that reads back as the same value.
  void append_number(int field, int index, std::string& text) const;

  /// Bytes of row `row` up to the first zero, if the field is text.
  std::string text(int field, int row) const;
  /// Number of texts of a field in use.
  int texts(int field) const;
  /// A hash, or bytes from `first` on, in hexadecimal.
  std::string hexadecimal(int field, int first, int count) const;

  /// First fields of every message.
  std::int64_t utime() const { return integer(0, 0); }  // us, clock of the sender
  std::int64_t seq() const { return integer(1, 0); }
  std::int64_t session() const { return integer(2, 0); }

 private:
  union Value {
    std::int64_t integer;
    double real;
  };

  const TypeInfo* type_;
  std::vector<std::vector<Value>> values_;  // by field
  std::vector<int> used_;
};

/// Appends the shortest text that reads back as the same number; "nan", "inf", "-inf".
void append_number(double value, std::string& text);
void append_number(float value, std::string& text);

}  // namespace palpate::log
