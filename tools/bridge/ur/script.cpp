#include "script.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <stdexcept>
#include <utility>

namespace palpate::ur_bridge {
namespace {

std::string decimal(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.9f", value);
  return text.data();
}

}  // namespace

std::string fill_script(const std::string& text, const ScriptNumbers& numbers) {
  const std::array<std::pair<std::string, std::string>, 5> values{
      {{"$FIRST", std::to_string(numbers.first)},
       {"$RUN", std::to_string(numbers.run)},
       {"$ACCELERATION", decimal(numbers.acceleration)},
       {"$MOST_SPEED", decimal(numbers.most_speed)},
       {"$WATCHDOG", decimal(numbers.watchdog)}}};
  std::string filled;
  std::size_t begin = 0;
  while (begin < text.size()) {  // without comments, which an old controller reads slowly
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    if (text.compare(begin, 1, "#") != 0) filled += text.substr(begin, end - begin) + "\n";
    begin = end + 1;
  }
  for (const auto& [name, value] : values) {
    std::size_t at = filled.find(name);
    if (at == std::string::npos) throw std::invalid_argument("the script has no " + name);
    for (; at != std::string::npos; at = filled.find(name)) filled.replace(at, name.size(), value);
  }
  if (const std::size_t at = filled.find('$'); at != std::string::npos)
    throw std::invalid_argument("the script has an unknown " + filled.substr(at, 16));
  return filled;
}

void ScriptSender::send(std::string script) {
  script_ = std::move(script);
  stream_->open();
}

void ScriptSender::poll() {
  if (stream_->state() != bridge::Stream::State::kOpen) return;
  if (!script_.empty()) {
    stream_->write(reinterpret_cast<const std::uint8_t*>(script_.data()),
                   static_cast<int>(script_.size()));
    script_.clear();
  }
  std::array<std::uint8_t, 4096> unused;
  while (stream_->read(unused.data(), static_cast<int>(unused.size())) > 0) {
  }
}

}  // namespace palpate::ur_bridge
