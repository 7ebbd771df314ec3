// palpate-top in a separate terminal, and as plain text and JSON.

#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <sys/ioctl.h>

#include <atomic>
#include <nlohmann/json.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/health_t.hpp>
#include <regex>
#include <thread>

#include "rt/bus/message_bus.hpp"
#include "tests/process/bus_udpm/injector.hpp"
#include "tests/support/child_process.hpp"

namespace palpate {
namespace {

const std::string kTop = std::string(PALPATE_BIN_DIR) + "/palpate-top";

/// Publishes wrenches at about 100 Hz and HEALTH at 10 Hz until it is destroyed.
class Traffic {
 public:
  Traffic(const bus::UdpmUrl& control, const bus::UdpmUrl& housekeeping)
      : thread_([this, control, housekeeping] {
          const auto wrenches = bus::make_lcm_bus(control.text());
          const auto health = bus::make_lcm_bus(housekeeping.text());
          bus::TypedPublisher<ft_wrench_t> wrench_publisher(*wrenches, "FT_WRENCH");
          bus::TypedPublisher<health_t> health_publisher(*health, "HEALTH");
          ft_wrench_t wrench{};
          health_t state{};
          wrench.session = state.session = 3;
          state.state = 2;
          state.phase_count = 10;
          for (int i = 0; !stop_; ++i) {
            wrench.seq += i % 10 == 9 ? 2 : 1;  // as if one were lost
            wrench_publisher.publish(wrench);
            if (i % 10 == 0) health_publisher.publish(state);
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
          }
        }) {}
  ~Traffic() {
    stop_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// A program on the other side of a pseudo-terminal.
class InTerminal {
 public:
  InTerminal(std::vector<std::string> command, int columns, int rows) {
    winsize size{};
    size.ws_col = static_cast<unsigned short>(columns);
    size.ws_row = static_cast<unsigned short>(rows);
    child_ = forkpty(&terminal_, nullptr, nullptr, &size);
    if (child_ != 0) return;
    setenv("TERM", "xterm", 1);
    std::vector<char*> arguments;
    for (std::string& word : command) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    execv(arguments[0], arguments.data());
    _exit(127);
  }
  ~InTerminal() {
    if (child_ > 0) {
      kill(child_, SIGKILL);
      waitpid(child_, nullptr, 0);
    }
    close(terminal_);
  }
  InTerminal(const InTerminal&) = delete;
  InTerminal& operator=(const InTerminal&) = delete;

  void resize(int columns, int rows) const {
    winsize size{};
    size.ws_col = static_cast<unsigned short>(columns);
    size.ws_row = static_cast<unsigned short>(rows);
    ioctl(terminal_, TIOCSWINSZ, &size);  // the kernel sends SIGWINCH
  }
  void type(const std::string& keys) const {
    ASSERT_EQ(write(terminal_, keys.data(), keys.size()), static_cast<ssize_t>(keys.size()));
  }
  /// Reads until a complete frame satisfies the condition; returns the frame, or empty on time-out.
  template <class Condition>
  std::string frame_where(Condition condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (std::chrono::steady_clock::now() < end) {
      if (!read_some()) break;
      const std::size_t last = text_.rfind("\x1b[H");
      const std::size_t before = last == 0 ? last : text_.rfind("\x1b[H", last - 1);
      if (last == std::string::npos || before == std::string::npos) continue;
      std::string frame = text_.substr(before, last - before);
      if (condition(frame)) return frame;
    }
    return "";
  }
  std::string frame_with(const std::string& words) {
    return frame_where(
        [&](const std::string& frame) { return frame.find(words) != std::string::npos; });
  }
  /// Exit code; reads the remaining output.
  int wait() {
    while (read_some()) {
    }
    int status = 0;
    waitpid(child_, &status, 0);
    child_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  const std::string& text() const { return text_; }

 private:
  /// False at the end, or after a long time without output.
  bool read_some() {
    pollfd watched{terminal_, POLLIN, 0};
    if (poll(&watched, 1, 20'000) <= 0) return false;
    char bytes[4096];
    const ssize_t size = read(terminal_, bytes, sizeof(bytes));
    if (size <= 0) return false;
    text_.append(bytes, static_cast<std::size_t>(size));
    return true;
  }

  pid_t child_ = -1;
  int terminal_ = -1;
  std::string text_;
};

class Top : public testing::Test {
 protected:
  void SetUp() override {
    for (bus::UdpmUrl& url : urls_) url = bus::private_url();
    PALPATE_REQUIRE_MULTICAST(urls_[0]);
  }
  std::vector<std::string> command(const std::vector<std::string>& more) const {
    const char* labels[] = {"control", "housekeeping", "pictures"};
    std::vector<std::string> words{kTop};
    for (int i = 0; i < 3; ++i) {
      words.push_back("--url");
      words.push_back(std::string(labels[i]) + "=" + urls_[i].text());
    }
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  static int rows_of(const std::string& frame) {
    return static_cast<int>(std::count(frame.begin(), frame.end(), '\n')) + 1;
  }

  bus::UdpmUrl urls_[3];
};

TEST_F(Top, ShowsChannelsResizesScrollsAndQuits) {
  const Traffic traffic(urls_[0], urls_[1]);
  InTerminal top(command({"--interval", "0.05"}), 130, 40);
  std::string frame = top.frame_with("FT_WRENCH");
  ASSERT_NE(frame, "") << top.text();
  EXPECT_NE(top.text().find("\x1b[?1049h"), std::string::npos);
  EXPECT_NE(frame.find("ft_wrench_t"), std::string::npos) << frame;
  EXPECT_NE(top.frame_with("palpated: active"), "") << top.text();
  EXPECT_NE(frame.find("(name)"), std::string::npos);
  top.type("s");
  EXPECT_NE(top.frame_with("(rate)"), "");

  top.resize(60, 8);
  frame = top.frame_where([](const std::string& text) { return rows_of(text) == 8; });
  ASSERT_NE(frame, "") << "it never became smaller";
  EXPECT_NE(frame.find("palpated"), std::string::npos);
  top.type("\x1b[6~");  // a page down
  EXPECT_NE(top.frame_where([](const std::string& text) {
    return rows_of(text) == 8 && text.find("palpated") == std::string::npos;
  }),
            "");
  top.type("q");
  EXPECT_EQ(top.wait(), 0);
  EXPECT_NE(top.text().find("\x1b[?1049l"), std::string::npos) << "the screen is given back";
}

TEST_F(Top, WithoutColoursThereAreNone) {
  const Traffic traffic(urls_[0], urls_[1]);
  InTerminal top(command({"--plain", "--interval", "0.05"}), 100, 30);
  const std::string frame = top.frame_with("FT_WRENCH");
  ASSERT_NE(frame, "");
  EXPECT_FALSE(std::regex_search(frame, std::regex("\x1b\\[[0-9;]*m"))) << "bold or coloured";
  top.type("\x03");  // control and C
  EXPECT_EQ(top.wait(), 0);
}

TEST_F(Top, PrintsPlainTextOnce) {
  const Traffic traffic(urls_[0], urls_[1]);
  support::ChildProcess top(command({"--once", "--seconds", "2"}));
  EXPECT_EQ(top.wait(std::chrono::seconds(40)), 0) << top.output();
  EXPECT_NE(top.output().find("palpated: active"), std::string::npos) << top.output();
  EXPECT_NE(top.output().find("ft_wrench_t"), std::string::npos) << top.output();
  EXPECT_EQ(top.output().find('\x1b'), std::string::npos);
}

TEST_F(Top, PrintsJson) {
  const Traffic traffic(urls_[0], urls_[1]);
  support::ChildProcess top(command({"--json", "--seconds", "2"}));
  EXPECT_EQ(top.wait(std::chrono::seconds(40)), 0) << top.output();
  const nlohmann::json json = nlohmann::json::parse(top.output());
  EXPECT_EQ(json["daemon"]["state"], "active");
  bool found = false;
  for (const nlohmann::json& channel : json["channels"]) {
    if (channel["channel"] != "FT_WRENCH") continue;
    found = true;
    EXPECT_EQ(channel["url"], "control");
    EXPECT_TRUE(channel["known"]);
    EXPECT_GT(channel["rate"], 5);
    EXPECT_LT(channel["rate"], 110);
    EXPECT_GT(channel["lost"], 0);
  }
  EXPECT_TRUE(found);
}

TEST_F(Top, SaysThatNothingIsHeardAndThatThereIsNoTerminal) {
  support::ChildProcess once(command({"--once", "--seconds", "0.2"}));
  EXPECT_EQ(once.wait(std::chrono::seconds(20)), 69) << once.output();
  EXPECT_NE(once.output().find("nothing heard"), std::string::npos);
  support::ChildProcess none(command({}));
  EXPECT_EQ(none.wait(std::chrono::seconds(20)), 1);
  EXPECT_NE(none.output().find("--once"), std::string::npos) << none.output();
}

}  // namespace
}  // namespace palpate
