#include "tools/types/message_values.hpp"

#include <algorithm>

namespace palpate::types {
namespace {

constexpr std::size_t kLongestText = 200;  // bytes
constexpr std::size_t kNumbersInALine = 8;

bool is_printable(char c) { return c >= 32 && c < 127; }

/// Text as it is; bytes as text where they are one, padded with zeros, else in hexadecimal.
std::string leaf_text(const Leaf& leaf) {
  std::string text;
  std::string_view content = leaf.text();
  if (leaf.what() == Leaf::What::kBytes) {
    const std::size_t end = std::min(content.find('\0'), content.size());
    const bool is_text = std::all_of(content.begin(), content.begin() + end, is_printable) &&
                         content.find_first_not_of('\0', end) == std::string_view::npos;
    if (!is_text || end == 0) {
      leaf.append_to(text);
      return text;
    }
    content = content.substr(0, end);
  }
  for (const char c : content.substr(0, kLongestText)) text += is_printable(c) ? c : '?';
  if (content.size() > kLongestText) text += "...";
  return text;
}

ShownMessage::Value value_of(const Leaf& leaf) {
  ShownMessage::Value value;
  value.path = leaf.path();
  value.is_number = leaf.is_number();
  if (!value.is_number) {
    value.text = leaf_text(leaf);
    return value;
  }
  leaf.append_to(value.text);
  if (value.path.back() != ']') return value;
  value.array = value.path.substr(0, value.path.rfind('['));
  value.index = leaf.key().back();
  return value;
}

}  // namespace

std::size_t line_end(const std::vector<ShownMessage::Value>& values, std::size_t first) {
  std::size_t end = first + 1;
  while (!values[first].array.empty() && end < values.size() && end - first < kNumbersInALine &&
         values[end].array == values[first].array)
    ++end;
  return end;
}

std::pair<std::string, std::string> line_of(const std::vector<ShownMessage::Value>& values,
                                            std::size_t first, std::size_t end) {
  std::string text = values[first].text;
  for (std::size_t i = first + 1; i < end; ++i) text += "  " + values[i].text;
  if (end - first == 1) return {values[first].path, text};
  return {values[first].array + "[" + std::to_string(values[first].index) + ":" +
              std::to_string(values[end - 1].index + 1) + "]",
          text};
}

MessageValues::MessageValues(TypeSet types, std::vector<std::string> channels)
    : types_(std::move(types)), channels_(std::move(channels)) {}

bool MessageValues::take(int source, std::string_view channel, const void* data, int size,
                         std::int64_t time_us) {
  const bool is_named = std::find(channels_.begin(), channels_.end(), channel) != channels_.end();
  if (!channels_.empty() && !is_named) return false;
  const Struct* type = is_named ? own_types().type_of(data, size) : nullptr;
  if (type == nullptr) type = types_.type_of(data, size);
  if (type == nullptr && !is_named) return false;
  const auto key = std::make_pair(std::string(channel), source);
  if (last_.size() >= kMostChannels && last_.count(key) == 0) return false;
  Message& message = last_[key];
  message.time_us = time_us;
  message.type = type;
  ++message.messages;
  if (type != nullptr && !fits(*type, data, size)) ++message.malformed;
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  message.data.assign(bytes, bytes + size);
  return true;
}

std::vector<ShownMessage> MessageValues::shown(std::size_t most) const {
  std::vector<ShownMessage> result;
  for (const auto& [key, message] : last_) {
    ShownMessage shown;
    shown.channel = key.first;
    shown.source = key.second;
    shown.time_us = message.time_us;
    shown.messages = message.messages;
    shown.malformed = message.malformed;
    if (message.type != nullptr) {
      shown.type = message.type->name;
      shown.fits = each_leaf(*message.type, message.data.data(),
                             static_cast<int>(message.data.size()), [&](const Leaf& leaf) {
                               if (shown.values.size() < most)
                                 shown.values.push_back(value_of(leaf));
                               else
                                 ++shown.left_out;
                             });
    }
    result.push_back(std::move(shown));
  }
  return result;
}

}  // namespace palpate::types
