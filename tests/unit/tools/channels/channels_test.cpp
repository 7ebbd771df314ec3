// Every channel of lcmtypes/channels.csv appears in palpate-spy, -top, -record, -export and -view.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <palpate/channels.hpp>
#include <sstream>

#include "tests/support/scratch_folder.hpp"
#include "tests/unit/lcmtypes/all_types.hpp"
#include "tests/unit/tools/export/log_writer.hpp"
#include "tools/export/columns.hpp"
#include "tools/export/source.hpp"
#include "tools/record/message_types.hpp"
#include "tools/top/channel_table.hpp"
#include "tools/view/scene.hpp"

namespace palpate {
namespace {

/// Channels that a program leaves out.
struct LeftOut {
  const char* program;
  const char* channel;
  const char* reason;
};
constexpr LeftOut kLeftOut[] = {
    {"view", channel::kFtWrench, "raw: CONTACTS and ESTIMATE show the wrenches"},
    {"view", channel::kImu, "raw: the arm moves by ROBOT_STATE"},
    {"view", channel::kFingertip, "CONTACTS shows the contact"},
    {"view", channel::kShapeTarget, "FEATURE contains the target that is active"},
    {"view", channel::kComponentCommand, "COMPONENT_EVENT acknowledges it"},
    {"view", channel::kTouchRequest, "TOUCH acknowledges it"},
    {"view", channel::kTouch, "palpate-command touch and the Python package report it"},
    {"view", channel::kUnknownContact, "ESTIMATE contains it"},
    {"view", channel::kWrenchCompensated, "CONTACTS contains the same wrench, in O"},
    {"view", channel::kTwistCommand1, "the second arm moves by ROBOT_STATE_1"},
    {"view", channel::kJointVelocityCommand, "the arm moves by ROBOT_STATE"},
    {"view", channel::kHandCommand, "the hand moves by HAND_STATE"},
    {"view", channel::kSimTick, "synchronisation of lock-step mode"},
    {"view", channel::kTickDone, "synchronisation of lock-step mode"},
    {"view", channel::kTruthTouch, "for evaluation"},
    {"view", channel::kPicture, "on a URL that it does not join; the page draws the object itself"},
};

bool is_left_out(const std::string& program, std::string_view channel) {
  return std::any_of(std::begin(kLeftOut), std::end(kLeftOut), [&](const LeftOut& one) {
    return one.program == program && one.channel == channel;
  });
}

/// Names with the number of each arm or finger.
std::vector<std::string> names_of(const channel::Channel& channel) {
  const std::string name(channel.name);
  if (channel.number == channel::Number::kArm) return {name, name + "_1"};
  if (channel.number == channel::Number::kNone) return {name};
  std::vector<std::string> names;
  for (int finger = 0; finger < 5; ++finger) names.push_back(name + "_" + std::to_string(finger));
  return names;
}

/// An encoded message of each type, by name.
const std::map<std::string, std::vector<std::uint8_t>, std::less<>>& messages() {
  static const auto all = [] {
    std::map<std::string, std::vector<std::uint8_t>, std::less<>> made;
    const auto add = [&made](const auto& message) {
      std::vector<std::uint8_t> data(static_cast<std::size_t>(message.getEncodedSize()));
      message.encode(data.data(), 0, static_cast<int>(data.size()));
      made[message.getTypeName()] = std::move(data);
    };
    for_each_fixed_size_type(add);
    for_each_variable_size_type(add);
    return made;
  }();
  return all;
}

const std::vector<std::uint8_t>& message_of(const channel::Channel& channel) {
  return messages().find(channel.type)->second;
}

TEST(ChannelsOfPrograms, RecordKnowsTheTypeOfEach) {
  record::ChannelFilter filter;
  for (const channel::Channel& channel : channel::kAll) {
    const auto& data = message_of(channel);
    const int size = static_cast<int>(data.size());
    const record::MessageType* type = record::type_of(data.data(), size);
    ASSERT_NE(type, nullptr) << channel.name;
    EXPECT_EQ(type->name, channel.type);
    EXPECT_TRUE(type->fits(data.data(), size)) << channel.name;
    for (const std::string& name : names_of(channel)) EXPECT_TRUE(filter.wants(name)) << name;
  }
}

TEST(ChannelsOfPrograms, TopListsEachWithItsType) {
  top::ChannelTable table;
  for (const channel::Channel& channel : channel::kAll)
    for (const std::string& name : names_of(channel)) {
      const auto& data = message_of(channel);
      table.take({0, 1, 1, name, data.data(), static_cast<int>(data.size())});
    }
  std::map<std::string, std::string> listed;
  for (const top::ChannelRow& row : table.rows(2)) listed[row.channel] = row.type;
  for (const channel::Channel& channel : channel::kAll)
    for (const std::string& name : names_of(channel)) EXPECT_EQ(listed[name], channel.type) << name;
}

TEST(ChannelsOfPrograms, ExportReadsEachFromALog) {
  const support::ScratchFolder scratch;
  const std::filesystem::path path = scratch.path() / "all.log";
  {
    exporting::LogWriter log(path);
    for (const channel::Channel& channel : channel::kAll)
      for (const std::string& name : names_of(channel))
        log.write_bytes(name, 1000, message_of(channel));
  }
  exporting::SourceOptions options;
  options.logs = {path};
  options.quiet = true;
  const exporting::Source source(options);
  std::map<std::string, const exporting::ChannelSurvey*> found;
  for (const exporting::ChannelSurvey& one : source.found().channels) found[one.channel] = &one;
  for (const channel::Channel& channel : channel::kAll)
    for (const std::string& name : names_of(channel)) {
      ASSERT_NE(found[name], nullptr) << name;
      ASSERT_NE(found[name]->type, nullptr) << name;
      EXPECT_EQ(found[name]->type->name, channel.type) << name;
      EXPECT_EQ(found[name]->broken, 0) << name;
      EXPECT_FALSE(exporting::columns(*found[name]->type, found[name]->widths).empty()) << name;
    }
}

TEST(ChannelsOfPrograms, ViewShowsEachOrLeavesItOutForAReason) {
  const auto& shown = view::Scene::channels();
  for (const channel::Channel& channel : channel::kAll)
    for (const std::string& name : names_of(channel)) {
      const bool is_shown = std::find(shown.begin(), shown.end(), name) != shown.end();
      EXPECT_TRUE(is_shown || is_left_out("view", channel.name) || is_left_out("view", name))
          << name;
    }
  for (const LeftOut& one : kLeftOut) EXPECT_NE(channel::find(one.channel), nullptr) << one.channel;
}

TEST(ChannelsOfPrograms, SpyHasTheJavaTypeOfEach) {
  const std::filesystem::path folder = PALPATE_JAVA_TYPES;
  std::ifstream file(folder / "Channels.java");
  std::ostringstream text;
  text << file.rdbuf();
  for (const channel::Channel& channel : channel::kAll) {
    const std::string name(channel.name), type(channel.type);
    EXPECT_NE(text.str().find("new Channel(" + name + ", \"" + type + "\""), std::string::npos)
        << name;
    EXPECT_TRUE(std::filesystem::exists(folder / (type + ".java"))) << type;
  }
}

}  // namespace
}  // namespace palpate
