#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace palpate::bus {

/// LCM event log: a sequence of events, each consisting of kSyncWord (4 bytes), event number (8),
/// time in us (8), lengths of channel and data (4 each), all in network order, then channel and
/// data.
inline constexpr std::uint32_t kSyncWord = 0xEDA1DA01;
inline constexpr int kEventTimeAt = 12, kChannelSizeAt = 20, kDataSizeAt = 24;
inline constexpr int kEventHeaderSize = 28;

/// Limits of a valid event: size of its data, and times >= 0, in us, that are representable in ns
/// as an int64.
inline constexpr std::int64_t kLargestEventData = std::int64_t{64} << 20;
inline constexpr std::int64_t kLatestEventTime = std::numeric_limits<std::int64_t>::max() / 1000;

/// Logged message; valid until the reader's next call.
struct LoggedEvent {
  std::int64_t utime = 0;  // us, recording time: 0 to kLatestEventTime
  std::string channel;     // 1 to kLongestChannel bytes
  const std::uint8_t* data = nullptr;
  int size = 0;         // bytes of data
  std::int64_t at = 0;  // offset of the event in the file
};

/// Parts of a log that are not complete events.
struct LogDamage {
  long places = 0;               // number of skipped parts
  std::int64_t skipped = 0;      // their total size, bytes
  std::int64_t first_place = 0;  // offset of the first one in the file
  bool cut_short = false;        // the last event is incomplete: recording was interrupted
};

/// Reads an untrusted LCM event log: an event is valid if its lengths and time are possible, it
/// fits into the file, and another event or the end of file follows. Everything else is skipped up
/// to the next event and reported by damage(). Memory use is limited to the largest event.
class EventLogReader {
 public:
  /// Data appended to the file later is not read. Throws std::runtime_error if `path` is not a
  /// readable file.
  explicit EventLogReader(std::string path);
  ~EventLogReader();
  EventLogReader(const EventLogReader&) = delete;
  EventLogReader& operator=(const EventLogReader&) = delete;

  /// Next event; nullptr at the end. Throws std::runtime_error, with file name and offset, if the
  /// file cannot be read further, or contains bytes but no event.
  const LoggedEvent* next();

  /// Returns to the first event.
  void rewind();

  /// Damage in the part read so far.
  const LogDamage& damage() const { return damage_; }
  /// The same as a one-line message naming the file; empty if the log is intact.
  std::string complaint() const;

 private:
  struct Header;

  Header header_at(std::int64_t place);
  bool is_event(std::int64_t place, const Header& header) const;
  bool is_sync_word(std::int64_t place) const;
  std::int64_t next_sync_word(std::int64_t place);
  const std::uint8_t* view(std::int64_t place, std::int64_t size);
  void copy(std::int64_t place, std::int64_t size, std::uint8_t* into) const;
  void skip_to(std::int64_t place);
  void finish();

  std::string path_;
  int descriptor_;
  std::int64_t size_ = 0;   // file size
  std::int64_t place_ = 0;  // offset of the unread part
  bool any_ = false;        // an event has been found
  LoggedEvent event_;
  std::vector<std::uint8_t> data_;
  std::vector<std::uint8_t> window_;  // bytes of the file from offset window_begin_ on
  std::int64_t window_begin_ = 0, window_size_ = 0;
  LogDamage damage_;
};

}  // namespace palpate::bus
