#include "tools/record/recorder.hpp"

#include <cmath>
#include <filesystem>
#include <stdexcept>

namespace palpate::record {
namespace {

constexpr double kRecorderMegabyte = 1e6;
constexpr std::int64_t kLookEvery = 1'000'000'000;  // ns, check interval of the free space
constexpr std::size_t kMostChannels =
    4096;  // distinguished; a sender of random names must not exhaust memory
constexpr std::int64_t kPendingOverhead = 128;  // bytes of a queued message in addition to its own

std::string folder_of(const std::string& file) {
  const std::filesystem::path parent = std::filesystem::path(file).parent_path();
  return parent.empty() ? "." : parent.string();
}

std::string megabytes(double count) { return std::to_string(std::llround(count)) + " MB"; }

}  // namespace

std::int64_t free_space_of_system(const std::string& folder) {
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(folder, error);
  if (error) throw std::runtime_error(folder + ": " + error.message());
  return static_cast<std::int64_t>(space.available);
}

Recorder::Recorder(RecorderOptions options, FreeSpace free_space)
    : options_(std::move(options)),
      free_space_(std::move(free_space)),
      filter_(options_.channels, options_.invert_channels) {
  if (!is_space_left()) {
    throw std::runtime_error(
        folder_of(options_.name) + ": only " +
        megabytes(static_cast<double>(free_space_(folder_of(options_.name))) / kRecorderMegabyte) +
        " are free, less than the " + megabytes(options_.min_free_mb) +
        " that --min-free-mb keeps");
  }
  const bool several = options_.labels.size() > 1 && !options_.merge;
  const std::size_t count = several ? options_.labels.size() : 1;
  for (std::size_t i = 0; i < count; ++i) {
    logs_.push_back(std::make_unique<LogFiles>(
        several ? labelled(options_.name, options_.labels[i]) : options_.name, options_.files));
  }
}

void Recorder::take(const Heard& heard) {
  if (!filter_.wants(heard.channel)) return;
  const Recognised message = recognise(heard.data, heard.size, options_.types);
  const std::lock_guard<std::mutex> lock(mutex_);
  Channel& channel = channel_of(heard);
  ChannelSummary& summary = channel.summary;
  if (message.type != nullptr && !message.fits) ++summary.misfits;
  if (!message.fits && options_.known_only) return;
  if (message.fits) summary.type = *message.type;
  if (message.has_header) channel.gaps.take(header_of(heard.data));
  const std::int64_t room = heard.size + kPendingOverhead;
  if (static_cast<double>(pending_bytes_ + room) > options_.max_unwritten_mb * kRecorderMegabyte) {
    ++unwritten_;
    return;
  }
  pending_bytes_ += room;
  pending_.push_back({heard.source,
                      heard.utime,
                      std::string(heard.channel),
                      {heard.data, heard.data + heard.size}});
  if (summary.messages++ == 0) summary.first_utime = heard.utime;
  summary.last_utime = heard.utime;
  summary.bytes += heard.size;
}

Recorder::Channel& Recorder::channel_of(const Heard& heard) {
  const std::string name(channels_.size() < kMostChannels ||
                                 channels_.count({heard.source, std::string(heard.channel)}) > 0
                             ? heard.channel
                             : "(others)");
  Channel& channel = channels_[{heard.source, name}];
  channel.summary.source = heard.source;
  channel.summary.channel = name;
  return channel;
}

void Recorder::write_pending() {
  std::vector<Pending> taken;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    taken.swap(pending_);
  }
  std::int64_t bytes = 0;
  for (const Pending& one : taken) {
    const std::size_t log = logs_.size() > 1 ? static_cast<std::size_t>(one.source) : 0;
    logs_[log]->write(one.utime, one.channel, one.data.data(), static_cast<int>(one.data.size()));
    bytes += static_cast<std::int64_t>(one.data.size()) + kPendingOverhead;
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  pending_bytes_ -= bytes;
}

bool Recorder::write(std::int64_t now_ns) {
  write_pending();
  if (static_cast<double>(now_ns - flush_ns_) >= options_.flush_interval * 1e9) {
    flush_ns_ = now_ns;
    for (const auto& log : logs_) log->flush();
  }
  if (now_ns - look_ns_ < kLookEvery) return true;
  look_ns_ = now_ns;
  return is_space_left();
}

bool Recorder::is_space_left() const {
  return static_cast<double>(free_space_(folder_of(options_.name))) >=
         options_.min_free_mb * kRecorderMegabyte;
}

void Recorder::split() {
  for (const auto& log : logs_) log->split();
}

void Recorder::finish() {
  write_pending();
  for (const auto& log : logs_) log->close();
}

Recorder::Totals Recorder::totals() const {
  Totals totals;
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const auto& [key, channel] : channels_) {
    totals.messages += channel.summary.messages;
    totals.bytes += channel.summary.bytes;
    totals.lost += channel.gaps.lost();
    totals.misfits += channel.summary.misfits;
  }
  totals.unwritten = unwritten_;
  return totals;
}

std::vector<ChannelSummary> Recorder::channels() const {
  std::vector<ChannelSummary> all;
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const auto& [key, channel] : channels_) {
    all.push_back(channel.summary);
    all.back().lost = channel.gaps.lost();
    all.back().senders = channel.gaps.sessions();
  }
  return all;
}

std::vector<std::string> Recorder::files() const {
  std::vector<std::string> all;
  for (const auto& log : logs_) {
    for (const std::string& file : log->files()) all.push_back(file);
  }
  return all;
}

}  // namespace palpate::record
