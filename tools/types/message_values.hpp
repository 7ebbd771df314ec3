#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/types/leaves.hpp"
#include "tools/types/type_set.hpp"

namespace palpate::types {

/// The contents of the last message of one channel of one URL, for people.
struct ShownMessage {
  struct Value {
    std::string path;         // as contacts[2].force[0]
    std::string text;         // printable
    bool is_number = false;   // text is that of a number
    std::string array;        // of a number in an array: the array's path; else empty
    std::int64_t index = -1;  // of it in that array
  };
  int source = 0;
  std::string channel, type;   // type: empty if the last message is of an unknown one
  std::int64_t time_us = 0;    // as given
  bool fits = false;           // it could be decoded as its type
  std::int64_t messages = 0;   // on this channel
  std::int64_t malformed = 0;  // of them
  std::vector<Value> values;   // in order; the first `most`
  std::int64_t left_out = 0;   // values beyond those
};

/// Consecutive numbers of one array from `first` on: as many as one line shows.
std::size_t line_end(const std::vector<ShownMessage::Value>& values, std::size_t first);
/// Name and values of such a line: {"force[0:3]", "1  2  3"}.
std::pair<std::string, std::string> line_of(const std::vector<ShownMessage::Value>& values,
                                            std::size_t first, std::size_t end);

/// Keeps the last message of some channels, and counts those that do not fit their type.
class MessageValues {
 public:
  static constexpr std::size_t kMostChannels = 256;  // by URL; later ones are left out

  /// Messages of `types` and of palpate's own can be shown; of the named channels, or without names
  /// of all whose messages are of `types`.
  explicit MessageValues(TypeSet types, std::vector<std::string> channels = {});

  /// Whether the message is one of those that are kept. `source`: number of its URL.
  bool take(int source, std::string_view channel, const void* data, int size, std::int64_t time_us);
  /// By channel and URL. `most`: values of each message.
  std::vector<ShownMessage> shown(std::size_t most) const;
  void clear() { last_.clear(); }

  const TypeSet& types() const { return types_; }

 private:
  struct Message {
    std::int64_t time_us = 0, messages = 0, malformed = 0;
    const Struct* type = nullptr;
    std::vector<std::uint8_t> data;
  };
  TypeSet types_;
  std::vector<std::string> channels_;
  std::map<std::pair<std::string, int>, Message> last_;  // by channel and URL
};

}  // namespace palpate::types
