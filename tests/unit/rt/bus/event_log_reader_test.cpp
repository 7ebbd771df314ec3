#include "rt/bus/event_log_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <lcm/lcm-cpp.hpp>

#include "rt/bus/log_ring.hpp"
#include "tests/support/scratch_folder.hpp"

namespace palpate::bus {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string event(std::int64_t utime, const std::string& data,
                  const std::string& channel = "STREAM") {
  LogRing ring(kEventHeaderSize + channel.size() + data.size(), 1);
  ring.add(utime, channel, data.data(), static_cast<int>(data.size()));
  const LogRing::Piece whole = ring.pieces()[0];
  return {reinterpret_cast<const char*>(whole.data), whole.size};
}

std::string with_number(std::string bytes, int at, std::uint64_t number, int size) {
  for (int i = 0; i < size; ++i)
    bytes[at + i] = static_cast<char>(number >> 8 * (size - 1 - i) & 0xff);
  return bytes;
}

class EventLogReaderTest : public testing::Test {
 protected:
  std::string log(const std::string& bytes) const {
    std::ofstream file(path_, std::ios::binary);
    file << bytes;
    return path_;
  }

  /// Data of the events of a file with these bytes.
  std::vector<std::string> read(const std::string& bytes) {
    EventLogReader reader(log(bytes));
    std::vector<std::string> data;
    while (const LoggedEvent* event = reader.next())
      data.emplace_back(reinterpret_cast<const char*>(event->data), event->size);
    damage_ = reader.damage();
    complaint_ = reader.complaint();
    return data;
  }

  /// Exception text of next() for a file with these bytes.
  std::string error(const std::string& bytes) {
    try {
      read(bytes);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "none";
  }

  support::ScratchFolder folder_;
  const std::string path_ = (folder_.path() / "run.log").string();
  const std::string a_ = event(1, "first"), b_ = event(2, "second"), c_ = event(3, "third"),
                    d_ = event(4, "fourth");
  LogDamage damage_;
  std::string complaint_;
};

TEST_F(EventLogReaderTest, ReadsWhatLiblcmWritesTwice) {
  std::string large(300'000, '\0');
  for (std::size_t i = 0; i < large.size(); ++i) large[i] = static_cast<char>(i * i >> 3);
  const std::string long_name(63, 'X');
  {
    lcm::LogFile file(path_, "w");
    for (int i = 0; i < 3000; ++i) {
      std::string data = i == 1000 ? large : large.substr(i, i % 200);
      lcm::LogEvent event{};
      event.timestamp = 1'700'000'000'000'000 + i;
      event.channel = i % 2 == 0 ? long_name : "Y";
      event.data = data.data();
      event.datalen = static_cast<int>(data.size());
      ASSERT_EQ(file.writeEvent(&event), 0);
    }
  }
  EventLogReader reader(path_);
  for (int round = 0; round < 2; ++round, reader.rewind()) {
    for (int i = 0; i < 3000; ++i) {
      const LoggedEvent* event = reader.next();
      ASSERT_NE(event, nullptr);
      EXPECT_EQ(event->utime, 1'700'000'000'000'000 + i);
      EXPECT_EQ(event->channel, i % 2 == 0 ? long_name : "Y");
      EXPECT_EQ(std::string(reinterpret_cast<const char*>(event->data), event->size),
                i == 1000 ? large : large.substr(i, i % 200));
    }
    EXPECT_EQ(reader.next(), nullptr);
    EXPECT_EQ(reader.next(), nullptr);
    EXPECT_EQ(reader.complaint(), "");
  }
}

TEST_F(EventLogReaderTest, CutAnywhereItGivesTheWholeEventsAndSaysSo) {
  const std::string whole = a_ + b_ + c_;
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    const std::size_t events =
        (size >= a_.size()) + (size >= (a_ + b_).size()) + (size >= whole.size());
    EXPECT_EQ(read(whole.substr(0, size)).size(), events) << size;
    const std::size_t ends[] = {0, a_.size(), (a_ + b_).size(), whole.size()};
    EXPECT_EQ(damage_.cut_short, size != ends[events]) << size;
    EXPECT_EQ(damage_.places, 0) << size;
  }
  read(a_ + b_.substr(0, 30));
  EXPECT_EQ(complaint_, path_ + ": the last event is cut short");
}

TEST_F(EventLogReaderTest, SkipsEventsWithImpossibleNumbersAndNoOthers) {
  const std::pair<int, std::uint64_t> damages[] = {
      {kDataSizeAt, 0xffffffff}, {kDataSizeAt, 0x7fffffff},
      {kDataSizeAt, 64 << 20},   {kDataSizeAt, (64 << 20) + 1},
      {kDataSizeAt, 7},          {kDataSizeAt, 0},
      {kDataSizeAt, 100},        {kChannelSizeAt, 0xffffffff},
      {kChannelSizeAt, 0},       {kChannelSizeAt, 64},
      {kChannelSizeAt, 5},       {kEventTimeAt, 0xffffffff},
      {kEventTimeAt, 0x7fffffff}};
  for (const auto& [at, number] : damages) {
    EXPECT_THAT(read(a_ + with_number(b_, at, number, 4) + c_), ElementsAre("first", "third"))
        << at << " " << number;
    EXPECT_EQ(damage_.places, 1);
    EXPECT_EQ(damage_.skipped, static_cast<std::int64_t>(b_.size()));
    EXPECT_EQ(damage_.first_place, static_cast<std::int64_t>(a_.size()));
    EXPECT_FALSE(damage_.cut_short);
  }
  EXPECT_EQ(complaint_, path_ +
                            ": 40 bytes that are no event in 1 places skipped, the first at "
                            "byte 39");
}

// An event before damage is indistinguishable from one with a wrong length.
TEST_F(EventLogReaderTest, BrokenSyncWordTakesTheEventBeforeAlong) {
  for (int bit = 0; bit < 32; ++bit) {
    std::string broken = c_;
    broken[bit / 8] ^= static_cast<char>(1 << bit % 8);
    EXPECT_THAT(read(a_ + b_ + broken + d_), ElementsAre("first", "fourth"));
    EXPECT_EQ(damage_.skipped, static_cast<std::int64_t>((b_ + c_).size()));
  }
}

TEST_F(EventLogReaderTest, FindsTheEventsAfterOneThatWasCutShort) {
  constexpr std::size_t kSyncSize = 4;
  for (std::size_t size = 1; size < b_.size(); ++size) {
    std::vector<std::string> expected{"first", "third", "fourth"};
    if (size < kSyncSize) expected.erase(expected.begin());
    EXPECT_EQ(read(a_ + b_.substr(0, size) + c_ + d_), expected) << size;
  }
}

TEST_F(EventLogReaderTest, StrangeBytesInFrontBetweenAndBehindAreCounted) {
  for (const std::string& noise :
       {std::string(512, '\0'), std::string("\xed\xa1\xda"), std::string(200'000, '\xed')}) {
    EXPECT_THAT(read(noise + a_ + b_), ElementsAre("first", "second"));
    EXPECT_EQ(damage_.skipped, static_cast<std::int64_t>(noise.size()));
    EXPECT_EQ(damage_.first_place, 0);
    EXPECT_THAT(read(a_ + b_ + noise + c_), ElementsAre("first", "third"));
    EXPECT_EQ(damage_.places, 1);
    EXPECT_THAT(read(noise + a_ + b_ + noise + c_ + d_), ElementsAre("first", "third", "fourth"));
    EXPECT_EQ(damage_.places, 2);
  }
  EXPECT_THAT(read(a_ + b_ + std::string(100, '\0')), ElementsAre("first"));
  EXPECT_FALSE(damage_.cut_short);
}

TEST_F(EventLogReaderTest, ALogWithinAMessageIsData) {
  const std::string inner = a_ + b_ + c_;
  EXPECT_THAT(read(event(9, inner) + d_), ElementsAre(inner, "fourth"));
  EXPECT_EQ(complaint_, "");
}

// An endless sequence of sync words, each of which requests resynchronisation.
TEST_F(EventLogReaderTest, SyncWordsByTheMillionAreNoTrap) {
  const std::string header =
      with_number(event(0, "", "X").substr(0, kEventHeaderSize), kDataSizeAt, 200'000, 4);
  std::string bytes;
  while (bytes.size() < 10'000'000) bytes += header;
  bytes[bytes.size() - 7] = 'X';
  bytes += a_;
  EXPECT_THAT(read(bytes).back(), "first");
}

TEST_F(EventLogReaderTest, NamesFileAndByteOfWhatIsNoLog) {
  EXPECT_THAT(read(""), IsEmpty());
  EXPECT_EQ(complaint_, "");
  EXPECT_EQ(error("t_s,x\n0,1\n"),
            path_ + ": is no LCM event log: no event in 10 bytes from byte 0 on");
  EXPECT_THAT(error(with_number(a_, kChannelSizeAt, 99, 4)), HasSubstr("no event in 39 bytes"));
  EXPECT_THROW(EventLogReader(path_ + ".absent"), std::runtime_error);
  EXPECT_THROW(EventLogReader(folder_.path().string()), std::runtime_error);
  const std::string pipe = path_ + ".pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THROW(EventLogReader{pipe}, std::runtime_error);
}

TEST_F(EventLogReaderTest, AFileThatBecomesShorterIsAnErrorAtItsEnd) {
  std::string bytes;
  while (bytes.size() < 200'000) bytes += a_;
  EventLogReader reader(log(bytes));
  ASSERT_NE(reader.next(), nullptr);
  std::filesystem::resize_file(path_, 100'000);
  try {
    while (reader.next() != nullptr) {
    }
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(), path_ + ": byte 100000 cannot be read: the file has become shorter");
  }
}

}  // namespace
}  // namespace palpate::bus
