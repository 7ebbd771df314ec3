#pragma once

#include <array>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <sstream>
#include <string>

#include "tests/support/child_process.hpp"

namespace palpate {

/// Returns true as soon as the condition is met, within a time-out sufficient for busy machines.
inline bool eventually(const std::function<bool()>& condition,
                       std::chrono::seconds limit = std::chrono::seconds(60)) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return true;
}

/// Output of a command; empty if it fails.
inline std::string output_of(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen((command + " 2>/dev/null").c_str(), "r"),
                                                   pclose);
  std::string text;
  std::array<char, 4096> bytes{};
  while (pipe && std::fgets(bytes.data(), bytes.size(), pipe.get()) != nullptr)
    text += bytes.data();
  return text;
}

/// A virtual screen for this process and its children.
class Display {
 public:
  static bool is_installed() { return std::filesystem::exists(kServer); }

  /// The server selects the first free number, and reports it. Without -noreset it would restart
  /// whenever its last client disconnects, and terminate one that is just connecting.
  Display()
      : server_({kServer, "-displayfd", "1", "-screen", "0", "1280x1024x24", "-nolisten", "tcp",
                 "-noreset"}) {
    std::string number;
    eventually([&] {
      number = number_in(server_.output());
      return !server_.running() || !number.empty();
    });
    works_ = server_.running() && !number.empty();
    setenv("DISPLAY", (":" + number).c_str(), 1);
  }
  ~Display() { unsetenv("DISPLAY"); }
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;

  bool works() const { return works_; }
  std::string complaint() const { return server_.output(); }

  /// Number of the window whose title has this prefix; empty if there is none.
  static std::string window(const std::string& title) {
    std::string number = output_of("xdotool search --name '^" + title + "'");
    return number.substr(0, number.find('\n'));
  }
  /// Clicks within a window, which is raised first.
  static void click(const std::string& window, int x, int y, const std::string& what) {
    output_of("xdotool windowraise " + window + " mousemove --window " + window + " " +
              std::to_string(x) + " " + std::to_string(y) + " click " + what);
  }

 private:
  static constexpr char kServer[] = "/usr/bin/Xvfb";

  /// The line with digits only: the server also complains about numbers that are taken.
  static std::string number_in(const std::string& output) {
    std::istringstream lines(output);
    for (std::string line; std::getline(lines, line) && !lines.eof();) {
      if (!line.empty() && line.find_first_not_of("0123456789") == std::string::npos) return line;
    }
    return "";
  }

  support::ChildProcess server_;
  bool works_ = false;
};

}  // namespace palpate
