#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "tools/import/fields.hpp"

namespace palpate::import {

/// First fields of every message.
struct MessageHead {
  std::int64_t utime = 0;  // us
  std::int32_t seq = 0;
  std::int64_t session = 0;
};

/// Turns the current row of a file into the bytes of one message.
class Encoder {
 public:
  virtual ~Encoder() = default;
  /// Throws CsvError if a value does not fit the message.
  virtual std::vector<std::uint8_t> encode(const recordings::CsvReader& csv,
                                           const MessageHead& head) const = 0;
  virtual const FieldMapping& mapping() const = 0;
};

/// Throws as FieldMapping, and std::invalid_argument if a biotac has only some of its electrodes,
/// or no fields at all.
std::unique_ptr<Encoder> make_encoder(const std::string& format,
                                      const std::map<std::string, std::string>& described,
                                      const recordings::CsvReader& csv);

}  // namespace palpate::import
