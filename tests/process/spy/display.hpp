#pragma once

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/child_process.hpp"
#include "tests/support/scratch_folder.hpp"

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

/// A virtual screen, white at first, for this process and its children.
class Display {
 public:
  static bool is_installed() { return std::filesystem::exists(kServer); }

  /// The server selects the first free number, and reports it. Without -noreset it would restart
  /// whenever its last client disconnects, and terminate one that is just connecting.
  Display()
      : server_({kServer, "-displayfd", "1", "-screen", "0", "1280x1024x24", "-nolisten", "tcp",
                 "-noreset", "-wr", "-fbdir", pixels_.path().string()}) {
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

  /// Number of dark pixels, as of text. The server keeps the screen as a file: a header and a table
  /// of colours (X11/XWDFile.h), then blue, green, red and a filler of each pixel.
  int dark_pixels() const {
    std::ifstream file(pixels_.path() / "Xvfb_screen0", std::ios::binary);
    const std::vector<unsigned char> bytes{std::istreambuf_iterator<char>(file), {}};
    constexpr std::size_t kHeaderSize = 0, kColours = 76, kColourSize = 12;  // bytes
    if (bytes.size() < kColours + 4) return 0;
    const auto number = [&](std::size_t at) {
      return std::size_t{bytes[at]} << 24 | bytes[at + 1] << 16 | bytes[at + 2] << 8 |
             bytes[at + 3];
    };
    int dark = 0;
    for (std::size_t i = number(kHeaderSize) + kColourSize * number(kColours); i + 3 < bytes.size();
         i += 4)
      dark += bytes[i] + bytes[i + 1] + bytes[i + 2] < 200 ? 1 : 0;
    return dark;
  }

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

  support::ScratchFolder pixels_;
  support::ChildProcess server_;
  bool works_ = false;
};

}  // namespace palpate
