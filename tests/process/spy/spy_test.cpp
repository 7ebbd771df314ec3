// palpate-spy on a virtual screen, with messages sent to it.

#include <gtest/gtest.h>
#include <png.h>

#include <fstream>

#include "tests/process/bus_udpm/injector.hpp"
#include "tests/process/spy/display.hpp"
#include "tests/process/spy/scene.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tools/lab/inject/packets.hpp"

namespace palpate {
namespace {

using bus::wire::Injector;
using std::chrono::seconds;
using support::ChildProcess;

const std::string kSpy = std::string(PALPATE_BIN_DIR) + "/palpate-spy";

struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;

  template <class Wanted>
  int count(Wanted wanted) const {
    int pixels = 0;
    for (std::size_t i = 0; i + 2 < rgb.size(); i += 3)
      pixels += wanted(rgb[i], rgb[i + 1], rgb[i + 2]) ? 1 : 0;
    return pixels;
  }
};

Picture read_png(const std::filesystem::path& path) {
  Picture picture;
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&image, path.c_str()) == 0) return picture;
  image.format = PNG_FORMAT_RGB;
  picture.rgb.resize(PNG_IMAGE_SIZE(image));
  if (png_image_finish_read(&image, nullptr, picture.rgb.data(), 0, nullptr) == 0) return {};
  picture.width = static_cast<int>(image.width);
  picture.height = static_cast<int>(image.height);
  return picture;
}

class Spy : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kSpy))
      GTEST_SKIP() << "built without Java: default-jdk-headless, liblcm-java, libjchart2d-java";
    if (!Display::is_installed()) GTEST_SKIP() << "Xvfb is absent; install xvfb";
    for (bus::UdpmUrl& url : urls_) url = bus::private_url();
    PALPATE_REQUIRE_MULTICAST(urls_[0]);
    display_ = std::make_unique<Display>();
    ASSERT_TRUE(display_->works()) << display_->complaint();
  }
  std::vector<std::string> command(const std::vector<std::string>& more) const {
    std::vector<std::string> words{kSpy, "--url", urls_[0].text(), "--url", urls_[1].text()};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  static bool says(const ChildProcess& spy, const std::string& words) {
    return eventually([&] { return spy.output().find(words) != std::string::npos; });
  }

  bus::UdpmUrl urls_[2];
  std::unique_ptr<Display> display_;
  support::ScratchFolder folder_;
};

TEST_F(Spy, FindsTypesAndShowsEachWindowAmongPacketsThatEndOthers) {
  ChildProcess spy(command({"--open", "mesh", "--open", "error", "--open", "electrodes=BIOTAC_2",
                            "--seconds", "3", "--pictures", folder_.path().string()}));
  ASSERT_TRUE(says(spy, "listens to")) << spy.output();
  EXPECT_NE(spy.output().find("LCM types"), std::string::npos) << spy.output();
  EXPECT_NE(spy.output().find("Found 3 plugins"), std::string::npos) << spy.output();
  Injector injector(urls_[1]);
  inject::PacketSource source(3, inject::malformed_kinds(), inject::usual_targets());
  for (int i = 0; i < 600; ++i) {
    const std::vector<std::uint8_t>& packet = source.next();
    ASSERT_TRUE(injector.send(packet.data(), packet.size()));
    if (i % 20 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const Scene scene(urls_[0].text(), urls_[1].text());
  EXPECT_EQ(spy.wait(seconds(150)), 0) << spy.output();

  const std::string words = spy.output();
  EXPECT_NE(words.find("error: mean 2.00 mm, RMS 2.24 mm, largest 3.00 mm, at 8 nodes"),
            std::string::npos)
      << words;
  EXPECT_NE(words.find("mesh: 8 nodes, current"), std::string::npos) << words;
  EXPECT_NE(words.find("electrodes: farthest from rest: E"), std::string::npos) << words;
  EXPECT_EQ(words.find("refused 0 datagrams"), std::string::npos) << words;

  const Picture table = read_png(folder_.path() / "spy.png");
  EXPECT_GT(table.count([](int r, int g, int b) { return r + g + b < 200; }), 500) << "text";
  const Picture mesh = read_png(folder_.path() / "mesh.png");
  EXPECT_GT(mesh.count([](int r, int g, int b) { return std::abs(r - b) + std::abs(g - b) > 60; }),
            20'000)
      << "a coloured surface";
  EXPECT_GT(mesh.count([](int r, int g, int b) { return r > 150 && g < 60 && b < 90; }), 50)
      << "the arrow of a force";
  const Picture error = read_png(folder_.path() / "error.png");
  EXPECT_GT(error.count([](int r, int g, int b) { return b > 140 && r < 80 && g < 130; }), 200)
      << "the line of the mean";
  const Picture electrodes = read_png(folder_.path() / "electrodes.png");
  EXPECT_GT(electrodes.width, 600);
  EXPECT_GT(electrodes.count([](int r, int g, int b) { return std::abs(r - b) > 40 && g < 200; }),
            1000)
      << "a touch, or that it has gone since the tare";
}

TEST_F(Spy, OpensWindowsByTheMouse) {
  if (output_of("xdotool version").empty()) GTEST_SKIP() << "xdotool is absent; install xdotool";
  ChildProcess spy(command({}));
  ASSERT_TRUE(says(spy, "listens to")) << spy.output();
  const Scene scene(urls_[0].text(), urls_[1].text());
  ASSERT_TRUE(eventually([] { return !Display::window("LCM Spy").empty(); }));
  const std::string table = Display::window("LCM Spy");
  // Rows in alphabetical order: BIOTAC_2, CONTACTS, HEALTH, SHAPE, ...
  constexpr int kX = 60, kFirstRow = 28, kRow = 16;
  // The effect of a click is visible only once the row exists and is drawn: retry.
  const auto opens = [&](const std::string& title, const auto& act) {
    for (int attempt = 0; attempt < 20; ++attempt) {
      act();
      if (eventually([&] { return !Display::window(title).empty(); }, seconds(3))) return true;
    }
    return false;
  };
  EXPECT_TRUE(opens("HEALTH", [&] {
    Display::click(table, kX, kFirstRow + 2 * kRow, "--repeat 2 --delay 60 1");
  })) << spy.output();
  EXPECT_TRUE(opens("Electrode map: BIOTAC_2", [&] {
    Display::click(table, kX, kFirstRow, "3");
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    Display::click(table, kX + 30, kFirstRow + 32, "1");  // the second entry of the menu
  })) << spy.output();
  EXPECT_TRUE(spy.running()) << spy.output();
}

TEST_F(Spy, RefusesWhatItShouldAndSaysWhy) {
  const auto refused = [](const std::vector<std::string>& more, const std::string& words) {
    std::vector<std::string> all{kSpy};
    all.insert(all.end(), more.begin(), more.end());
    ChildProcess spy(all);
    EXPECT_EQ(spy.wait(seconds(60)), 1) << spy.output();
    EXPECT_NE(spy.output().find(words), std::string::npos) << spy.output();
  };
  refused({"--open", "nonsense"}, "electrodes, error or mesh");
  refused({"--url", "udpm://10.0.0.1:1"}, "multicast");
  refused({"--seconds"}, "needs a value");
  refused({"--pictures", "x"}, "--seconds");
  unsetenv("DISPLAY");
  refused({}, "DISPLAY");
  ChildProcess version({kSpy, "--version"});
  EXPECT_EQ(version.wait(seconds(20)), 0);
  EXPECT_EQ(version.output(), std::string(PALPATE_VERSION) + "\n");
}

}  // namespace
}  // namespace palpate
