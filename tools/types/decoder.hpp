#pragma once

#include <cstdint>
#include <string_view>

#include "tools/types/description.hpp"

namespace palpate::types {

/// Receives the contents of a message in their order.
class Handler {
 public:
  virtual ~Handler() = default;
  virtual void begin_struct(const Struct&) {}
  virtual void end_struct() {}
  /// Before each member of the struct that was begun last.
  virtual void begin_member(const Member&, int /*index*/) {}
  /// One dimension of an array; those within are arrays as well.
  virtual void begin_array(std::int64_t /*size*/) {}
  virtual void begin_element(std::int64_t /*index*/) {}
  virtual void end_array() {}

  /// Integers, single bytes, enumerations; booleans as 0 or 1.
  virtual void integer(const Member&, std::int64_t) = 0;
  virtual void real(const Member&, double) = 0;
  /// As sent, without the final zero.
  virtual void text(const Member&, std::string_view) = 0;
  /// The last dimension of an array of bytes as a whole; valid during the call.
  virtual void bytes(const Member&, const std::uint8_t* data, std::int64_t size) = 0;
};

/// Whether `size` bytes at `data`, the fingerprint among them, are one whole message of the type.
/// Safe for any bytes: allocates a few numbers for each struct within a struct, at most 64 of them
/// deep, and visits at most a million elements that are not in the bytes (of size zero) before it
/// gives up.
bool fits(const Struct& type, const void* data, int size);

/// Passes a message on; false, and no call of the handler, unless it fits.
bool decode(const Struct& type, const void* data, int size, Handler& handler);

}  // namespace palpate::types
