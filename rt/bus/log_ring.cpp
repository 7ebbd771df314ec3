#include "rt/bus/log_ring.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "rt/bus/event_log_reader.hpp"

namespace palpate::bus {
namespace {

class Header {
 public:
  void put(std::uint64_t value, int bytes) noexcept {
    for (int i = bytes - 1; i >= 0; --i)
      bytes_[at_++] = static_cast<std::uint8_t>(value >> (8 * i) & 0xff);
  }
  const std::uint8_t* data() const noexcept { return bytes_.data(); }

 private:
  std::array<std::uint8_t, kEventHeaderSize> bytes_{};
  std::size_t at_ = 0;
};

}  // namespace

LogRing::LogRing(std::size_t room, double span) : span_us_(static_cast<std::int64_t>(span * 1e6)) {
  if (room == 0 || !(span > 0))
    throw std::invalid_argument("a ring of messages needs room and a span above zero");
  bytes_.assign(room, 0);
}

void LogRing::add(std::int64_t time_us, const std::string& channel, const void* data,
                  int size) noexcept {
  const std::size_t data_size = static_cast<std::size_t>(std::max(0, size));
  const std::size_t total = kEventHeaderSize + channel.size() + data_size;
  if (total > bytes_.size()) return;
  while (head() - tail() + total > bytes_.size()) forget_oldest();
  while (head() != tail() &&
         static_cast<std::int64_t>(get(tail() + kEventTimeAt, 8)) < time_us - span_us_)
    forget_oldest();
  Header header;
  header.put(kSyncWord, 4);
  header.put(static_cast<std::uint64_t>(events_++), 8);
  header.put(static_cast<std::uint64_t>(time_us), 8);
  header.put(channel.size(), 4);
  header.put(data_size, 4);
  std::uint64_t at = head();
  put(at, header.data(), kEventHeaderSize);
  put(at += kEventHeaderSize, channel.data(), channel.size());
  put(at += channel.size(), data, data_size);
  head_.store(at + data_size, std::memory_order_release);
}

void LogRing::clear() noexcept { tail_.store(head(), std::memory_order_release); }

std::array<LogRing::Piece, 2> LogRing::pieces() const noexcept {
  const std::uint64_t from = tail_.load(std::memory_order_acquire);
  const std::uint64_t to = head_.load(std::memory_order_acquire);
  const std::size_t begin = from % bytes_.size();
  const std::size_t size = std::min<std::size_t>(to - from, bytes_.size());
  const std::size_t first = std::min(size, bytes_.size() - begin);
  return {Piece{bytes_.data() + begin, first}, Piece{bytes_.data(), size - first}};
}

void LogRing::put(std::uint64_t at, const void* data, std::size_t size) noexcept {
  const std::size_t begin = at % bytes_.size();
  const std::size_t first = std::min(size, bytes_.size() - begin);
  std::memcpy(bytes_.data() + begin, data, first);
  std::memcpy(bytes_.data(), static_cast<const std::uint8_t*>(data) + first, size - first);
}

std::uint64_t LogRing::get(std::uint64_t at, int bytes) const noexcept {
  std::uint64_t value = 0;
  for (int i = 0; i < bytes; ++i) value = value << 8 | bytes_[(at + i) % bytes_.size()];
  return value;
}

void LogRing::forget_oldest() noexcept {
  const std::uint64_t from = tail();
  tail_.store(from + kEventHeaderSize + get(from + kChannelSizeAt, 4) + get(from + kDataSizeAt, 4),
              std::memory_order_release);
}

}  // namespace palpate::bus
