#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace palpate::bus {

/// A message of a log; valid until its reader goes on.
struct LoggedEvent {
  std::int64_t utime = 0;  // us, when it was recorded: 0 to kLatestEventTime
  std::string channel;     // 1 to kLongestChannel bytes
  const std::uint8_t* data = nullptr;
  int size = 0;         // of the data, bytes
  std::int64_t at = 0;  // byte of the file where the event begins
};

/// What of a log was no whole event.
struct LogDamage {
  long places = 0;               // pieces that were skipped
  std::int64_t skipped = 0;      // bytes in them
  std::int64_t first_place = 0;  // byte where the first of them begins
  bool cut_short = false;        // the last event: who recorded was killed while writing it
};

/// Reads an LCM event log and believes nothing that it says of itself: an event counts where its
/// lengths and time are possible, it fits the file, and the next one or the end follows. All else
/// is skipped up to the next event, and told by damage(). Never holds more than the largest event.
class EventLogReader {
 public:
  /// What is added to the file later is not read. Throws std::runtime_error where `path` is no
  /// file that can be read.
  explicit EventLogReader(std::string path);
  ~EventLogReader();
  EventLogReader(const EventLogReader&) = delete;
  EventLogReader& operator=(const EventLogReader&) = delete;

  /// The next event; nullptr at the end. Throws std::runtime_error, with the file's name and the
  /// byte, where the file cannot be read on, and where it holds bytes but no event at all.
  const LoggedEvent* next();

  /// Back to the first event.
  void rewind();

  /// Of what has been read since the beginning.
  const LogDamage& damage() const { return damage_; }
  /// The same in a line that names the file; empty where the log is whole.
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
  std::int64_t size_ = 0;   // of the file
  std::int64_t place_ = 0;  // where what has not been read begins
  bool any_ = false;        // event was found
  LoggedEvent event_;
  std::vector<std::uint8_t> data_;
  std::vector<std::uint8_t> window_;  // bytes of the file from window_begin_ on
  std::int64_t window_begin_ = 0, window_size_ = 0;
  LogDamage damage_;
};

}  // namespace palpate::bus
