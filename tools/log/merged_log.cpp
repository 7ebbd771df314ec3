#include "tools/log/merged_log.hpp"

#include <stdexcept>

#include "rt/bus/event_log_reader.hpp"

namespace palpate::log {

MergedLog::MergedLog(const std::vector<std::filesystem::path>& logs) {
  if (logs.empty()) throw std::runtime_error("no log is given");
  for (const std::filesystem::path& path : logs) {
    Source source;
    source.path = path;
    source.reader = std::make_unique<bus::EventLogReader>(path.string());
    source.size = static_cast<std::int64_t>(std::filesystem::file_size(path));
    size_ += source.size;
    sources_.push_back(std::move(source));
  }
}

void MergedLog::advance(Source& source) {
  source.head = source.reader->next();
  if (source.head == nullptr) return;
  ++source.events;
  const std::int64_t end = source.head->at + bus::kEventHeaderSize +
                           static_cast<std::int64_t>(source.head->channel.size()) +
                           source.head->size;
  place_ += end - std::max<std::int64_t>(source.last, 0);
  source.last = end;
}

const bus::LoggedEvent* MergedLog::next() {
  if (!begun_) {
    for (Source& source : sources_) advance(source);
    begun_ = true;
  } else if (current_ != nullptr) {
    advance(*current_);
  }
  current_ = nullptr;
  for (Source& source : sources_)
    if (source.head != nullptr &&
        (current_ == nullptr || source.head->utime < current_->head->utime))
      current_ = &source;
  return current_ == nullptr ? nullptr : current_->head;
}

void MergedLog::rewind() {
  for (Source& source : sources_) {
    source.reader->rewind();
    source.head = nullptr;
    source.last = -1;
    source.events = 0;
  }
  current_ = nullptr;
  begun_ = false;
  place_ = 0;
}

std::vector<std::string> MergedLog::complaints() const {
  std::vector<std::string> lines;
  for (const Source& source : sources_) {
    const std::string complaint = source.reader->complaint();
    if (complaint.empty()) continue;
    lines.push_back(complaint + "; " + std::to_string(source.events) +
                    " events could be read, the last of them ends at byte " +
                    std::to_string(source.last) + " of " + std::to_string(source.size));
  }
  return lines;
}

}  // namespace palpate::log
