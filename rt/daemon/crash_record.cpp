#include "rt/daemon/crash_record.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>
#include <stdexcept>
#include <utility>
#include <vector>

namespace palpate::daemon {
namespace {

namespace fs = std::filesystem;

constexpr char kPrefix[] = "palpated-";
constexpr char kExtension[] = ".lcmlog";

/// Bytes for the messages of every cycle with their framing, and for those with their own rates.
std::size_t room_for(double seconds, double period) {
  constexpr double kEachCycle = 4000, kEachSecond = 2e6;
  return static_cast<std::size_t>(seconds * (kEachSecond + kEachCycle / period));
}

/// File name that is unique on this machine.
std::string file_name(const char* cause) {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  tm utc{};
  gmtime_r(&now.tv_sec, &utc);
  char time[32], name[96];
  std::strftime(time, sizeof(time), "%Y%m%dT%H%M%S", &utc);
  std::snprintf(name, sizeof(name), "%s%s.%09ldZ-%d-%s%s", kPrefix, time, now.tv_nsec,
                static_cast<int>(getpid()), cause, kExtension);
  return name;
}

bool is_record(const fs::directory_entry& entry) {
  const std::string name = entry.path().filename().string();
  return entry.is_regular_file() && name.rfind(kPrefix, 0) == 0 &&
         entry.path().extension() == kExtension;
}

bool write_all(int file, const std::uint8_t* data, std::size_t size) noexcept {
  while (size > 0) {
    const ssize_t written = write(file, data, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    data += written;
    size -= static_cast<std::size_t>(written);
  }
  return true;
}

constexpr std::array<int, 5> kCrashes = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
std::atomic<CrashRecord*> record_of_process{nullptr};

void say(const char* text) noexcept {
  write_all(STDERR_FILENO, reinterpret_cast<const std::uint8_t*>(text), std::strlen(text));
}

/// calls only functions that POSIX permits in a handler
void on_crash(int signal) {
  if (CrashRecord* record = record_of_process.exchange(nullptr)) {
    const bool written = record->write_in_crash() == 0;
    say(written ? "crash: the last seconds are in " : "crash: no record could be written to ");
    say(record->crash_path());
    say("\n");
  }
  // the default action follows as soon as this handler returns
  raise(signal);
}

}  // namespace

CrashRecord::CrashRecord(const RecordSettings& settings, double period, bus::MessageBus& bus)
    : settings_(settings),
      folder_(fs::absolute(settings.folder)),
      crash_path_((folder_ / file_name("crash")).string()),
      bus_(bus),
      rings_{bus::LogRing(room_for(settings.seconds, period), settings.seconds),
             bus::LogRing(room_for(settings.seconds, period), settings.seconds)} {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (access(folder_.c_str(), W_OK | X_OK) != 0)
    throw std::runtime_error("record.folder: " + folder_.string() +
                             " cannot be written: " + std::strerror(errno));
  bus_.set_tap(this);
}

CrashRecord::~CrashRecord() { bus_.set_tap(nullptr); }

void CrashRecord::begin_cycle(std::int64_t monotonic_ns, std::int64_t utime) noexcept {
  if (!clock_set_) clock_offset_us_ = utime - monotonic_ns / 1000;
  clock_set_ = true;
  now_us_ = monotonic_ns / 1000 + clock_offset_us_;
  if (requested_.exchange(false, std::memory_order_relaxed)) hand_over("request");
  if (wanted_ != nullptr) exchange_rings();
}

void CrashRecord::note(const std::string& channel, const void* data, int size) noexcept {
  if (stopped_.load(std::memory_order_relaxed)) return;
  rings_[filled_.load(std::memory_order_relaxed)].add(now_us_, channel, data, size);
}

void CrashRecord::exchange_rings() noexcept {
  const char* cause = std::exchange(wanted_, nullptr);
  if (handed_over_.load(std::memory_order_acquire) != kNone) return;
  const int full = filled_.load(std::memory_order_relaxed);
  rings_[1 - full].clear();
  filled_.store(1 - full, std::memory_order_release);
  cause_.store(cause, std::memory_order_relaxed);
  handed_over_.store(full, std::memory_order_release);
}

std::string CrashRecord::write_handed_over() {
  const int full = handed_over_.load(std::memory_order_acquire);
  if (full == kNone) return "";
  const fs::path path = folder_ / file_name(cause_.load(std::memory_order_relaxed));
  std::ofstream file(path, std::ios::binary);
  for (const bus::LogRing::Piece& piece : rings_[full].pieces())
    file.write(reinterpret_cast<const char*>(piece.data), static_cast<std::streamsize>(piece.size));
  file.close();
  handed_over_.store(kNone, std::memory_order_release);
  if (!file) throw std::runtime_error(path.string() + ": cannot be written");
  remove_old_ones();
  return path.string();
}

void CrashRecord::remove_old_ones() const {
  std::vector<std::pair<fs::file_time_type, fs::path>> records;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, error))
    if (is_record(entry)) records.emplace_back(entry.last_write_time(error), entry.path());
  std::sort(records.rbegin(), records.rend());
  for (std::size_t i = static_cast<std::size_t>(settings_.keep); i < records.size(); ++i)
    fs::remove(records[i].second, error);
}

int CrashRecord::write_in_crash() noexcept {
  stopped_.store(true, std::memory_order_seq_cst);
  const int file = open(crash_path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) return -1;
  bool written = true;
  for (const bus::LogRing::Piece& piece : rings_[filled_.load(std::memory_order_acquire)].pieces())
    written = written && write_all(file, piece.data, piece.size);
  return close(file) == 0 && written ? 0 : -1;
}

CrashHandler::CrashHandler(CrashRecord* record) {
  if (record == nullptr) return;
  record_of_process.store(record);
  struct sigaction action {};
  action.sa_handler = on_crash;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  for (int signal : kCrashes) sigaction(signal, &action, nullptr);
}

CrashHandler::~CrashHandler() {
  if (record_of_process.exchange(nullptr) == nullptr) return;
  for (int number : kCrashes) std::signal(number, SIG_DFL);
}

}  // namespace palpate::daemon
