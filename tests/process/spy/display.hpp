#pragma once

#include <array>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>

#include "tests/support/child_process.hpp"

namespace palpate {

/// True as soon as the condition is, within a time that no busy machine takes.
inline bool eventually(const std::function<bool()>& condition,
                       std::chrono::seconds limit = std::chrono::seconds(60)) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return true;
}

/// What a command prints; empty where it fails.
inline std::string output_of(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen((command + " 2>/dev/null").c_str(), "r"),
                                                   pclose);
  std::string text;
  std::array<char, 4096> bytes{};
  while (pipe && std::fgets(bytes.data(), bytes.size(), pipe.get()) != nullptr)
    text += bytes.data();
  return text;
}

/// A screen in memory that this process and its children draw upon while it lives.
class Display {
 public:
  static bool is_installed() { return std::filesystem::exists(kServer); }

  /// The server takes the first number that is free, and says which.
  Display()
      : server_({kServer, "-displayfd", "1", "-screen", "0", "1280x1024x24", "-nolisten", "tcp"}) {
    const auto number = [this] { return std::atoi(server_.output().c_str()); };
    works_ = eventually([&] {
      const std::string text = server_.output();
      return !server_.running() || text.find('\n') != std::string::npos;
    });
    works_ = works_ && server_.running();
    setenv("DISPLAY", (":" + std::to_string(number())).c_str(), 1);
  }
  ~Display() { unsetenv("DISPLAY"); }
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;

  bool works() const { return works_; }
  std::string complaint() const { return server_.output(); }

  /// Number of the window whose title begins so; empty where there is none.
  static std::string window(const std::string& title) {
    std::string number = output_of("xdotool search --name '^" + title + "'");
    return number.substr(0, number.find('\n'));
  }
  /// Presses a button of the mouse within a window, which is raised first.
  static void click(const std::string& window, int x, int y, const std::string& what) {
    output_of("xdotool windowraise " + window + " mousemove --window " + window + " " +
              std::to_string(x) + " " + std::to_string(y) + " click " + what);
  }

 private:
  static constexpr char kServer[] = "/usr/bin/Xvfb";
  support::ChildProcess server_;
  bool works_ = false;
};

}  // namespace palpate
