#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "tools/record/listener.hpp"
#include "tools/top/channel_table.hpp"
#include "tools/top/daemon_watch.hpp"
#include "tools/types/message_values.hpp"

namespace palpate::top {

/// Emphasis of a line on terminals with colours; without them bad lines begin with "!".
enum class Tone { kPlain, kTitle, kGood, kWarning, kBad };

struct Line {
  std::string text;
  Tone tone = Tone::kPlain;
};

/// All data shown at one time.
struct View {
  const record::Listener* listener = nullptr;  // its counters; nullptr: none are shown
  std::vector<record::Source> sources;
  std::vector<ChannelRow> rows;
  const DaemonWatch* daemon = nullptr;
  std::int64_t now_ns = 0;
  std::vector<types::ShownMessage> messages = {};  // whose values are shown
};

/// The daemon's state with cycle times by phase and inputs, then the channels, one line each, and
/// the values of messages.
std::vector<Line> lines_of(const View& view);

/// The same as data for programs.
nlohmann::json json_of(const View& view);

/// The part of `lines` that a screen of this size shows from line `first` on, as bytes for the
/// terminal: never more rows, none wider, the last one with the keys.
std::string frame(const std::vector<Line>& lines, int columns, int rows, int first, bool colours,
                  const std::string& keys);

}  // namespace palpate::top
