#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/types/decoder.hpp"

namespace palpate::types {

/// One number, text or block of bytes of a message.
class Leaf {
 public:
  enum class What { kInteger, kReal, kText, kBytes };

  const Member& member() const { return *member_; }
  What what() const { return what_; }
  /// The way to it: the member's index in its struct, indices of arrays, the index of a member of
  /// that struct, and so on. The order of keys is that of the type's description.
  const std::vector<std::int64_t>& key() const { return key_; }
  /// The same as a name, as contacts[2].force[0].
  std::string path() const;

  bool is_number() const { return what_ == What::kInteger || what_ == What::kReal; }
  double number() const { return what_ == What::kReal ? real_ : static_cast<double>(integer_); }
  std::int64_t integer() const { return integer_; }
  /// Text, or bytes.
  std::string_view text() const { return text_; }

  /// Appends a number as the shortest text that reads back as the same value, text as it is, and
  /// bytes in hexadecimal, or only their number where there are more than `most_bytes`.
  void append_to(std::string& text, std::int64_t most_bytes = 64) const;

 private:
  friend class LeafHandler;
  const Member* member_ = nullptr;
  What what_ = What::kInteger;
  std::vector<std::int64_t> key_;
  std::vector<const std::string*> names_;  // for each entry: the member's; nullptr: an index
  std::int64_t integer_ = 0;
  double real_ = 0;
  std::string_view text_;
};

/// Calls `take` for each leaf of a message, in order; the leaf is valid during the call. False, and
/// no call, unless the message fits its type.
bool each_leaf(const Struct& type, const void* data, int size,
               const std::function<void(const Leaf&)>& take);

}  // namespace palpate::types
