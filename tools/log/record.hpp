#pragma once

#include <string>
#include <vector>

#include "tools/log/type_table.hpp"

namespace palpate::log {

/// One message of any type, taken apart by the table. Reused from message to message, so that a
/// log of many GB needs no memory for each.
class Record {
 public:
  explicit Record(const TypeInfo& type);

  /// Takes an encoded message apart. False where it is not whole, or of another type; what is held
  /// then means nothing.
  bool decode(const std::uint8_t* data, int size);

  const TypeInfo& type() const { return *type_; }

  /// Numbers of a field as they were sent, and how many of them are in use: fewer where another
  /// field of the message is their count.
  int size(int field) const { return static_cast<int>(values_[field].size()); }
  int used(int field) const { return used_[field]; }

  /// The number at `index`, counted through all dimensions. No conversion loses anything of types
  /// up to 32 bits; 64-bit integers are whole in integer() alone.
  double number(int field, int index) const;
  std::int64_t integer(int field, int index) const { return values_[field][index].integer; }
  /// A number as it is written to a file: the shortest text that reads back the same.
  void append_number(int field, int index, std::string& text) const;

  /// Bytes of row `row` up to the first zero, where the field is text.
  std::string text(int field, int row) const;
  /// How many texts a field has in use.
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
