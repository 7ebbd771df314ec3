#include <fcntl.h>
#include <gtest/gtest.h>
#include <lcm/eventlog.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <functional>
#include <palpate/ft_wrench_t.hpp>
#include <string>
#include <thread>
#include <vector>

#include "rt/bus/message_bus.hpp"
#include "tests/process/bus_udpm/injector.hpp"
#include "tests/unit/rt/bus/messages.hpp"

namespace palpate::bus {
namespace {

/// A program that runs until it ends or this object is destroyed.
class Program {
 public:
  explicit Program(std::vector<std::string> command) {
    std::vector<char*> arguments;
    for (std::string& word : command) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    process_ = fork();
    if (process_ != 0) return;
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    execvp(arguments[0], arguments.data());
    _exit(127);
  }
  ~Program() {
    if (process_ <= 0) return;
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// Exit code, or minus the signal.
  int wait() {
    int status = 0;
    waitpid(process_, &status, 0);
    process_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  int interrupt_and_wait() {
    kill(process_, SIGINT);
    return wait();
  }

 private:
  pid_t process_ = -1;
};

class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "palpate-XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

bool eventually(const std::function<bool()>& condition) {
  for (int i = 0; i < 20'000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

bool installed(const char* program) { return Program({program, "--help"}).wait() != 127; }

ft_wrench_t wrench_number(int number) {
  ft_wrench_t message{};
  message.utime = 1000 * number;
  message.seq = number;
  message.session = 9;
  message.wrench[0] = -0.25 * number;
  return message;
}

/// Payloads of FT_WRENCH, as far as the log is written.
std::vector<std::vector<std::uint8_t>> wrenches_of(const std::string& file) {
  std::vector<std::vector<std::uint8_t>> wrenches;
  lcm_eventlog_t* log = lcm_eventlog_create(file.c_str(), "r");
  if (log == nullptr) return wrenches;
  while (lcm_eventlog_event_t* event = lcm_eventlog_read_next_event(log)) {
    const auto* data = static_cast<const std::uint8_t*>(event->data);
    if (std::string(event->channel) == "FT_WRENCH")
      wrenches.emplace_back(data, data + event->datalen);
    lcm_eventlog_free_event(event);
  }
  lcm_eventlog_destroy(log);
  return wrenches;
}

void write_log(const std::string& file, int count) {
  lcm_eventlog_t* log = lcm_eventlog_create(file.c_str(), "w");
  ASSERT_NE(log, nullptr);
  const std::string channel = "FT_WRENCH";
  for (int i = 0; i < count; ++i) {
    auto data = wire::encoded(wrench_number(i));
    auto name = channel;
    lcm_eventlog_event_t event{};
    event.timestamp = 1'000'000 + 1000 * i;
    event.channellen = static_cast<std::int32_t>(name.size());
    event.channel = name.data();
    event.datalen = static_cast<std::int32_t>(data.size());
    event.data = data.data();
    ASSERT_EQ(lcm_eventlog_write_event(log, &event), 0);
  }
  lcm_eventlog_destroy(log);
}

TEST(StockPrograms, LcmLoggerRecordsWhatTheBusPublishes) {
  UdpmUrl url = private_url();
  url.receive_buffer_size = 2 << 20;  // the logger may be delayed while all are sent
  PALPATE_REQUIRE_MULTICAST(url);
  if (!installed("lcm-logger")) GTEST_SKIP() << "lcm-logger is absent; install liblcm-bin";
  const Folder folder;
  const std::string file = folder.file("bus.log");
  Program logger({"lcm-logger", "-q", "-f", "--lcm-url=" + url.text(), file});
  const auto bus = make_lcm_bus(url.text());
  TypedPublisher<ft_wrench_t> publisher(*bus, "FT_WRENCH");
  TypedPublisher<ft_wrench_t> marker(*bus, "MARKER");
  // The logger writes its self-test when it receives from the network; from then on it records.
  ASSERT_TRUE(eventually([&] {
    marker.publish(wrench_number(0));
    return std::filesystem::exists(file) && std::filesystem::file_size(file) > 0;
  }));
  constexpr int kCount = 300;
  for (int i = 1; i <= kCount; ++i) {
    ASSERT_TRUE(publisher.publish(wrench_number(i)));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  // It writes to the disk only when further messages arrive.
  EXPECT_TRUE(eventually([&] {
    marker.publish(wrench_number(0));
    return wrenches_of(file).size() >= kCount;
  }));
  logger.interrupt_and_wait();
  const auto recorded = wrenches_of(file);
  ASSERT_EQ(recorded.size(), static_cast<std::size_t>(kCount));
  for (int i = 1; i <= kCount; ++i)
    EXPECT_EQ(recorded[static_cast<std::size_t>(i - 1)], wire::encoded(wrench_number(i)));
}

TEST(StockPrograms, LcmLogplayerIsHeardByTheBus) {
  const UdpmUrl url = private_url();
  PALPATE_REQUIRE_MULTICAST(url);
  if (!installed("lcm-logplayer")) GTEST_SKIP() << "lcm-logplayer is absent; install liblcm-bin";
  constexpr int kCount = 300;
  const Folder folder;
  write_log(folder.file("in.log"), kCount);
  const auto bus = make_lcm_bus(url.text());
  TypedSubscription<ft_wrench_t> subscription(*bus, "FT_WRENCH", kCount);
  bus->start();
  Program player({"lcm-logplayer", "--lcm-url=" + url.text(), folder.file("in.log")});
  EXPECT_EQ(player.wait(), 0);
  EXPECT_TRUE(eventually([&] { return subscription.counters().received == kCount; }))
      << subscription.counters().received << " of " << kCount;
  ft_wrench_t message{};
  std::int64_t arrival_ns = 0;
  for (int i = 0; subscription.take(message, arrival_ns); ++i) {
    EXPECT_EQ(message.seq, i);
    EXPECT_EQ(message.wrench[0], -0.25 * i);
  }
}

}  // namespace
}  // namespace palpate::bus
