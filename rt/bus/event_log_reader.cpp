#include "rt/bus/event_log_reader.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "rt/bus/message_bus.hpp"

namespace palpate::bus {
namespace {

constexpr std::int64_t kWindow = 1 << 16;  // bytes read from the file at once
constexpr std::array<std::uint8_t, 4> kSyncBytes = {kSyncWord >> 24, kSyncWord >> 16 & 0xff,
                                                    kSyncWord >> 8 & 0xff, kSyncWord & 0xff};

std::uint64_t big_endian(const std::uint8_t* bytes, int count) {
  std::uint64_t number = 0;
  for (int i = 0; i < count; ++i) number = number << 8 | bytes[i];
  return number;
}

}  // namespace

struct EventLogReader::Header {
  std::int64_t utime = 0, channel_size = 0, data_size = 0;

  bool is_possible() const {
    return utime >= 0 && utime <= kLatestEventTime && channel_size > 0 &&
           channel_size <= kLongestChannel && data_size <= kLargestEventData;
  }
  std::int64_t size() const { return kEventHeaderSize + channel_size + data_size; }
};

EventLogReader::EventLogReader(std::string path)
    : path_(std::move(path)), descriptor_(open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
  struct stat status {};
  if (descriptor_ < 0 || fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) {
    const std::string why = descriptor_ < 0 ? std::strerror(errno) : "is no file";
    if (descriptor_ >= 0) close(descriptor_);
    throw std::runtime_error(path_ + ": cannot be read as a log: " + why);
  }
  size_ = status.st_size;
  window_.resize(static_cast<std::size_t>(std::min(kWindow, size_)));
}

EventLogReader::~EventLogReader() { close(descriptor_); }

void EventLogReader::rewind() {
  place_ = 0;
  any_ = false;
  damage_ = {};
}

const LoggedEvent* EventLogReader::next() {
  for (std::int64_t at = place_; at < size_; at = next_sync_word(at + 1)) {
    const Header header = header_at(at);
    if (!is_event(at, header)) continue;
    skip_to(at);
    any_ = true;
    const std::int64_t channel_at = at + kEventHeaderSize;
    const std::uint8_t* channel = view(channel_at, header.channel_size);
    event_.channel.assign(channel, channel + header.channel_size);
    data_.resize(static_cast<std::size_t>(header.data_size));
    copy(channel_at + header.channel_size, header.data_size, data_.data());
    event_.utime = header.utime;
    event_.data = data_.data();
    event_.size = static_cast<int>(header.data_size);
    event_.at = at;
    place_ = at + header.size();
    return &event_;
  }
  finish();
  return nullptr;
}

/// Header of the event at `place`; an invalid one if there is none.
EventLogReader::Header EventLogReader::header_at(std::int64_t place) {
  Header header;
  if (size_ - place < kEventHeaderSize) return header;
  const std::uint8_t* bytes = view(place, kEventHeaderSize);
  if (!std::equal(kSyncBytes.begin(), kSyncBytes.end(), bytes)) return header;
  header.utime = static_cast<std::int64_t>(big_endian(bytes + kEventTimeAt, 8));
  header.channel_size = static_cast<std::int64_t>(big_endian(bytes + kChannelSizeAt, 4));
  header.data_size = static_cast<std::int64_t>(big_endian(bytes + kDataSizeAt, 4));
  return header;
}

/// With an invalid length the next event is not found where this one ends.
bool EventLogReader::is_event(std::int64_t place, const Header& header) const {
  const std::int64_t end = place + header.size();
  return header.is_possible() && end <= size_ && is_sync_word(end);
}

/// Also true for a truncated sync word at the end of the file.
bool EventLogReader::is_sync_word(std::int64_t place) const {
  std::array<std::uint8_t, kSyncBytes.size()> bytes = kSyncBytes;
  copy(place, std::min<std::int64_t>(kSyncBytes.size(), size_ - place), bytes.data());
  return bytes == kSyncBytes;
}

/// Offset of the first sync word from `place` on; the end of the file if there is none.
std::int64_t EventLogReader::next_sync_word(std::int64_t place) {
  while (size_ - place >= kEventHeaderSize) {
    const std::uint8_t* begin = view(place, kEventHeaderSize);
    const std::uint8_t* end = window_.data() + window_size_;
    const std::uint8_t* found = std::search(begin, end, kSyncBytes.begin(), kSyncBytes.end());
    if (found != end) return place + (found - begin);
    place += (end - begin) - static_cast<std::int64_t>(kSyncBytes.size()) + 1;
  }
  return size_;
}

/// Bytes of the file, at most kWindow, valid until the next call.
const std::uint8_t* EventLogReader::view(std::int64_t place, std::int64_t size) {
  if (place < window_begin_ || place + size > window_begin_ + window_size_) {
    window_size_ = 0;
    copy(place, std::min(kWindow, size_ - place), window_.data());
    window_begin_ = place;
    window_size_ = std::min(kWindow, size_ - place);
  }
  return window_.data() + (place - window_begin_);
}

void EventLogReader::copy(std::int64_t place, std::int64_t size, std::uint8_t* into) const {
  const std::int64_t in_window = place - window_begin_;
  if (in_window >= 0 && in_window + size <= window_size_) {
    std::copy_n(window_.data() + in_window, size, into);
    return;
  }
  for (std::int64_t done = 0; done < size;) {
    const ssize_t got =
        pread(descriptor_, into + done, static_cast<std::size_t>(size - done), place + done);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) {
      throw std::runtime_error(
          path_ + ": byte " + std::to_string(place + done) +
          " cannot be read: " + (got < 0 ? std::strerror(errno) : "the file has become shorter"));
    }
    done += got;
  }
}

/// Counts the bytes between the last event and `place` as damage.
void EventLogReader::skip_to(std::int64_t place) {
  if (place == place_) return;
  if (damage_.places++ == 0) damage_.first_place = place_;
  damage_.skipped += place - place_;
  place_ = place;
}

/// The remainder contains no complete event: it is empty, a truncated event, or damage.
void EventLogReader::finish() {
  if (place_ == size_) return;
  const Header header = header_at(place_);
  const bool is_short = size_ - place_ < kEventHeaderSize;
  if (is_short ? is_sync_word(place_) : header.is_possible() && place_ + header.size() > size_) {
    damage_.cut_short = true;
    place_ = size_;
    return;
  }
  if (!any_) {
    throw std::runtime_error(path_ + ": is no LCM event log: no event in " + std::to_string(size_) +
                             " bytes from byte 0 on");
  }
  skip_to(size_);
}

std::string EventLogReader::complaint() const {
  std::string text;
  if (damage_.places > 0) {
    text = std::to_string(damage_.skipped) + " bytes that are no event in " +
           std::to_string(damage_.places) + " places skipped, the first at byte " +
           std::to_string(damage_.first_place);
  }
  if (damage_.cut_short)
    text += (text.empty() ? "the" : "; the") + std::string(" last event is cut short");
  return text.empty() ? text : path_ + ": " + text;
}

}  // namespace palpate::bus
