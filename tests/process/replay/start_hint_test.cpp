// palpate-replay on logs without a start command to the daemon.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <lcm/lcm-cpp.hpp>
#include <palpate/component_command_t.hpp>
#include <palpate/ft_wrench_t.hpp>

#include "rt/bus/text.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/rt/bus/messages.hpp"

namespace palpate {
namespace {

using std::chrono::seconds;
using support::ChildProcess;
using ::testing::HasSubstr;
using ::testing::Not;

class StartHint : public testing::Test {
 protected:
  template <class Message>
  static void write(lcm::LogFile& log, std::int64_t utime, const std::string& channel,
                    Message message) {
    message.utime = utime;
    auto data = bus::wire::encoded(message);
    lcm::LogEvent event{};
    event.timestamp = utime;
    event.channel = channel;
    event.datalen = static_cast<int>(data.size());
    event.data = data.data();
    log.writeEvent(&event);
  }

  /// Ten readings of the wrist's sensor, behind a command with `event` where there is one.
  std::string log(const std::string& event) const {
    const std::string path = (folder_.path() / ("run" + event + ".lcmlog")).string();
    lcm::LogFile file(path, "w");
    if (!event.empty()) {
      component_command_t command{};
      bus::put_text(command.slot, "all");
      bus::put_text(command.event, event.c_str());
      write(file, 1'000'000, "COMPONENT_COMMAND", command);
    }
    for (int i = 0; i < 10; ++i) write(file, 1'001'000 + 1000 * i, "FT_WRENCH", ft_wrench_t{});
    return path;
  }

  static std::vector<std::string> command(const std::string& log) {
    return {std::string(PALPATE_BIN_DIR) + "/palpate-replay", log, "--config",
            std::string(PALPATE_SOURCE_DIR) + "/rt/config/examples/bar_long_soft.yaml"};
  }

  support::ScratchFolder folder_;
};

TEST_F(StartHint, ALogWithoutStartEndsWithOneAndNamesTheOption) {
  for (const char* event : {"", "stop"}) {
    ChildProcess replay(command(log(event)));
    EXPECT_EQ(replay.wait(seconds(60)), 1) << replay.output();
    EXPECT_THAT(replay.output(), HasSubstr("0 shapes"));
    EXPECT_THAT(replay.output(), HasSubstr("--start"));
  }
}

TEST_F(StartHint, ALogWithStartOrTheOptionHasNoHint) {
  std::vector<std::string> started = command(log(""));
  started.push_back("--start");
  for (const std::vector<std::string>& words : {started, command(log("start"))}) {
    ChildProcess replay(words);
    EXPECT_EQ(replay.wait(seconds(60)), 0) << replay.output();
    EXPECT_THAT(replay.output(), Not(HasSubstr("--start")));
  }
}

}  // namespace
}  // namespace palpate
