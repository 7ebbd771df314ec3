#include "rt/bus/authentication.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <limits>
#include <palpate/component_command_t.hpp>
#include <palpate/hand_command_t.hpp>
#include <palpate/joint_velocity_command_t.hpp>
#include <palpate/manual_force_t.hpp>
#include <palpate/shape_target_t.hpp>
#include <palpate/touch_request_t.hpp>
#include <palpate/twist_command_t.hpp>
#include <vector>

#include "rt/loop/allocation_counter.hpp"
#include "tests/unit/rt/bus/messages.hpp"

namespace palpate::bus {
namespace {

constexpr const char* kChannel = "TWIST_COMMAND";

Key key_of(std::uint8_t first) {
  Key key;
  for (int i = 0; i < kKeySize; ++i) key[i] = static_cast<std::uint8_t>(first + 7 * i);
  return key;
}

twist_command_t command() {
  twist_command_t message{};
  message.utime = 1234567;
  message.seq = 8;
  message.session = 9;
  message.counter = 10;
  message.valid = 1;
  for (int i = 0; i < 6; ++i) message.twist[i] = 0.1 * i - 0.2;
  return message;
}

// As computed in Python: hmac.new(key, b"TWIST_COMMAND\0" + bytes(range(50)),
// "sha512").digest()[:32].
TEST(Authentication, TheCodeIsHmacSha512CutToHalf) {
  const std::array<std::uint8_t, kCodeSize> expected = {
      0x4e, 0x4c, 0x91, 0xac, 0x8e, 0xf7, 0x5e, 0x18, 0x6d, 0x49, 0x60,
      0x2f, 0x49, 0x0a, 0x25, 0x80, 0x92, 0xc6, 0x32, 0xde, 0xf1, 0xbe,
      0x96, 0xd2, 0x90, 0x8d, 0x11, 0x69, 0x5f, 0x05, 0x42, 0x98};
  std::uint8_t data[50], code[kCodeSize];
  for (int i = 0; i < 50; ++i) data[i] = static_cast<std::uint8_t>(i);
  compute_code(key_of(1), kChannel, data, sizeof(data), code);
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), code));
}

TEST(Authentication, SealedMessagesOfEveryTypeVerify) {
  const Key key = key_of(1);
  const auto check = [&](auto message) {
    message.counter = 3;
    EXPECT_FALSE(verify(key, kChannel, message)) << message.getTypeName() << " without a code";
    seal(key, kChannel, message);
    EXPECT_TRUE(verify(key, kChannel, message)) << message.getTypeName();
    seal(key, kChannel, message);
    EXPECT_TRUE(verify(key, kChannel, message)) << "the old code is no part of the message";
  };
  check(twist_command_t{});
  check(joint_velocity_command_t{});
  check(hand_command_t{});
  check(component_command_t{});
  check(shape_target_t{});
  check(manual_force_t{});
  check(touch_request_t{});
}

TEST(Authentication, AnyFlippedBitIsSeen) {
  const Key key = key_of(1);
  twist_command_t message = command();
  seal(key, kChannel, message);
  std::vector<std::uint8_t> data = wire::encoded(message);
  int flipped = 0;
  for (std::size_t byte = 8; byte < data.size(); ++byte) {  // after the fingerprint
    for (int bit = 0; bit < 8; ++bit) {
      data[byte] ^= static_cast<std::uint8_t>(1 << bit);
      twist_command_t changed{};
      ASSERT_GT(changed.decode(data.data(), 0, static_cast<int>(data.size())), 0);
      EXPECT_FALSE(verify(key, kChannel, changed)) << "byte " << byte << ", bit " << bit;
      data[byte] ^= static_cast<std::uint8_t>(1 << bit);
      ++flipped;
    }
  }
  EXPECT_EQ(flipped, 8 * static_cast<int>(data.size() - 8));
}

TEST(Authentication, AnotherKeyOrChannelIsSeen) {
  twist_command_t message = command();
  seal(key_of(1), kChannel, message);
  EXPECT_FALSE(verify(key_of(2), kChannel, message));
  EXPECT_FALSE(verify(key_of(1), "TWIST_COMMAND_1", message));
  EXPECT_FALSE(verify(key_of(1), "TWIST_COMMAN", message));
  Key near = key_of(1);
  near.back() ^= 1;
  EXPECT_FALSE(verify(near, kChannel, message));
}

/// A sender and a receiver that share a key.
class AdmissionTest : public ::testing::Test {
 protected:
  static constexpr std::int64_t kStart = 1'000'000;
  twist_command_t sent(MessageSigner& sealer, std::int64_t now_us) {
    twist_command_t message = command();
    sealer.put(message, now_us);
    return message;
  }
  Access access_{key_of(1), kStart};
  MessageSigner sender_{kChannel, access_};
  ReplayGuard receiver_{kChannel, access_};
};

TEST_F(AdmissionTest, FreshMessagesComeThroughOnceAndInOrder) {
  const twist_command_t first = sent(sender_, kStart + 5), second = sent(sender_, kStart + 9);
  EXPECT_EQ(receiver_.judge(first), Admitted::kFresh);
  EXPECT_EQ(receiver_.judge(first), Admitted::kRepeated);
  EXPECT_EQ(receiver_.judge(second), Admitted::kFresh);
  EXPECT_EQ(receiver_.rejected(), 0);
  EXPECT_EQ(receiver_.judge(first), Admitted::kRejected) << "replayed within the session";
  EXPECT_EQ(receiver_.rejected(), 1);
  EXPECT_STREQ(receiver_.reason(), "counter of an older message");
  EXPECT_EQ(receiver_.before_start(), -1) << "it may have been obeyed";
}

TEST_F(AdmissionTest, ReplayOfAnotherSessionIsRefused) {
  const twist_command_t recorded = sent(sender_, kStart + 5);
  EXPECT_EQ(receiver_.judge(recorded), Admitted::kFresh);
  MessageSigner restarted(kChannel, {key_of(1), kStart + 100});
  EXPECT_EQ(receiver_.judge(sent(restarted, kStart + 100)), Admitted::kFresh);
  EXPECT_EQ(receiver_.judge(recorded), Admitted::kRejected);
}

TEST_F(AdmissionTest, WhatWasRecordedBeforeAReceiversRestartIsRefused) {
  std::vector<twist_command_t> recorded;
  for (int i = 0; i < 10; ++i) recorded.push_back(sent(sender_, kStart + 1000 * i));
  ReplayGuard restarted(kChannel, {key_of(1), kStart + 60'000});
  ReplayGuard begun(kChannel, {key_of(1), 0});
  begun.begin(kStart + 60'000);
  for (const twist_command_t& message : recorded) {
    EXPECT_EQ(restarted.judge(message), Admitted::kRejected);
    EXPECT_EQ(begun.judge(message), Admitted::kRejected);
    EXPECT_EQ(restarted.before_start(), message.counter);
    EXPECT_EQ(begun.before_start(), message.counter);
  }
  EXPECT_STREQ(begun.reason(), "sent before this program started");
  EXPECT_EQ(restarted.judge(sent(sender_, kStart + 60'001)), Admitted::kFresh);
}

TEST_F(AdmissionTest, ForgedCountersDoNotMoveTheReceiver) {
  twist_command_t forged = sent(sender_, kStart + 1);
  forged.counter = std::numeric_limits<std::int64_t>::max();
  EXPECT_EQ(receiver_.judge(forged), Admitted::kRejected);
  EXPECT_STREQ(receiver_.reason(), "no valid authentication code");
  EXPECT_EQ(receiver_.judge(sent(sender_, kStart + 2)), Admitted::kFresh);
}

TEST_F(AdmissionTest, CountersRiseWhateverTheWallClockDoes) {
  std::int64_t last = 0;
  for (const std::int64_t now : {kStart + 50, kStart + 50, kStart - 900'000, kStart + 51}) {
    const twist_command_t message = sent(sender_, now);
    EXPECT_GT(message.counter, last);
    EXPECT_EQ(receiver_.judge(message), Admitted::kFresh);
    last = message.counter;
  }
}

TEST(Access, WithoutAKeyEveryMessageIsFreshAndCarriesNoCode) {
  ReplayGuard receiver(kChannel, {});
  MessageSigner sender(kChannel, {});
  for (int i = 1; i < 4; ++i) {
    twist_command_t message = command();
    sender.put(message, 0);
    EXPECT_EQ(message.counter, i) << "a deterministic run starts from the beginning";
    EXPECT_EQ(std::count(std::begin(message.authentication), std::end(message.authentication), 0),
              kCodeSize);
    EXPECT_EQ(receiver.judge(message), Admitted::kFresh);
    EXPECT_EQ(receiver.judge(message), Admitted::kFresh);
  }
}

TEST(Access, SealingAndCheckingAllocateNothing) {
  MessageSigner sender("SHAPE_TARGET", {key_of(3), 1});
  ReplayGuard receiver("SHAPE_TARGET", {key_of(3), 1});
  shape_target_t message{};
  const loop::NoAllocationScope scope;
  for (int i = 0; i < 10; ++i) {
    sender.put(message, 100 + i);
    ASSERT_EQ(receiver.judge(message), Admitted::kFresh);
  }
  EXPECT_EQ(scope.count(), 0);
}

/// us of this thread's processor time.
double thread_time_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

template <class Message>
double cost_us(int count) {
  const Key key = key_of(1);
  Message message{};
  int good = 0;
  const double begin = thread_time_us();
  for (int i = 0; i < count; ++i) {
    message.counter = i;
    seal(key, kChannel, message);
    good += verify(key, kChannel, message);
  }
  const double took = thread_time_us() - begin;
  EXPECT_EQ(good, count);
  return took / count;
}

TEST(Access, PrintsItsCost) {
  std::printf("seal and verify: %.2f us a twist, %.2f us a command, %.2f us a target\n",
              cost_us<twist_command_t>(2000), cost_us<component_command_t>(500),
              cost_us<shape_target_t>(500));
}

class KeyFile : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string folder = (std::filesystem::temp_directory_path() / "palpate_key_XXXXXX").string();
    ASSERT_NE(mkdtemp(folder.data()), nullptr);
    folder_ = folder;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& text, mode_t mode = 0600) {
    const std::string path = folder_ / "key";
    std::ofstream(path, std::ios::binary) << text;
    EXPECT_EQ(chmod(path.c_str(), mode), 0);
    return path;
  }
  static std::string error_of(const std::string& path) {
    try {
      read_key_file(path);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }
  std::filesystem::path folder_;
};

TEST_F(KeyFile, RawBytesAndHexadecimalDigitsAreTheSameKey) {
  const Key key = key_of(200);
  const std::string raw(key.begin(), key.end());
  std::string digits;
  for (const std::uint8_t byte : key) {
    char two[3];
    std::snprintf(two, sizeof(two), "%02X", byte);
    digits += two;
  }
  EXPECT_EQ(read_key_file(write(raw)), key);
  EXPECT_EQ(read_key_file(write(digits)), key);
  EXPECT_EQ(read_key_file(write(digits + "\n")), key);
  EXPECT_EQ(read_key_file(write(digits + "\r\n")), key);
}

TEST_F(KeyFile, OtherContentsAreRefused) {
  for (const std::string& text : {std::string(), std::string(31, 'a'), std::string(33, 'a'),
                                  std::string(63, 'a'), std::string(65, 'a'), std::string(64, 'g'),
                                  std::string(63, 'a') + "\n", std::string(1000, 'a')}) {
    EXPECT_NE(error_of(write(text)).find("64 hexadecimal digits"), std::string::npos)
        << text.size() << " bytes: " << error_of(write(text));
  }
}

TEST_F(KeyFile, IsItsOwnersAlone) {
  for (const mode_t mode : {0640, 0604, 0620, 0601})
    EXPECT_NE(error_of(write(std::string(64, 'a'), mode)).find("chmod 600"), std::string::npos);
  EXPECT_EQ(error_of(write(std::string(64, 'a'), 0400)), "");
}

TEST_F(KeyFile, AbsentOnesAndFoldersAreNamed) {
  EXPECT_NE(error_of(folder_ / "nowhere").find("nowhere"), std::string::npos);
  EXPECT_NE(error_of(folder_).find("is no file"), std::string::npos);
}

TEST_F(KeyFile, MadeOnesAreUnlikeAndNeverOverwritten) {
  const std::string a = folder_ / "a", b = folder_ / "b";
  make_key_file(a);
  make_key_file(b);
  EXPECT_NE(read_key_file(a), read_key_file(b));
  const Key before = read_key_file(a);
  EXPECT_THROW(make_key_file(a), std::runtime_error);
  EXPECT_EQ(read_key_file(a), before);
}

}  // namespace
}  // namespace palpate::bus
