#include "tools/lab/faults/transforms.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <set>

#include "tools/lab/faults/faulty_wire.hpp"

namespace palpate::faults {
namespace {

constexpr Window kWindow{0.1, 0.9};

template <class Message>
bus::Published encoded(const char* channel, const Message& message, std::int64_t time_ns) {
  bus::Published published{channel, std::vector<std::uint8_t>(message.getEncodedSize()), time_ns};
  message.encode(published.data.data(), 0, message.getEncodedSize());
  return published;
}

template <class Message>
Message decoded(const bus::Published& published) {
  Message message;
  EXPECT_GT(message.decode(published.data.data(), 0, static_cast<int>(published.data.size())), 0);
  return message;
}

/// One second of both, a message per millisecond, and a command that no fault may affect.
Stream one_second() {
  Stream stream;
  for (int tick = 1; tick <= 1000; ++tick) {
    ft_wrench_t wrench{};
    wrench.utime = 1000 * tick;
    wrench.seq = tick;
    wrench.session = 5;
    for (int i = 0; i < 6; ++i) wrench.wrench[i] = tick + 0.1 * i;
    stream.push_back(encoded("FT_WRENCH", wrench, 1'000'000LL * tick));
    robot_state_t state{};
    state.seq = tick;
    state.session = 5;
    state.joint_count = 7;
    for (int i = 0; i < 7; ++i) state.q[i] = 10 + i, state.dq[i] = 20 + i;
    for (int i = 0; i < 3; ++i) state.position[i] = 30 + i;
    for (int i = 0; i < 4; ++i) state.quaternion[i] = 40 + i;
    for (int i = 0; i < 6; ++i) state.twist[i] = 50 + i;
    stream.push_back(encoded("ROBOT_STATE", state, 1'000'000LL * tick));
  }
  stream.push_back({"COMPONENT_COMMAND", std::vector<std::uint8_t>(40), 1'000'000'000});
  return stream;
}

TEST(Messages, NumbersStandWhereTheTypesSay) {
  const Stream stream = one_second();
  const bus::Published& robot = stream[1];
  std::vector<double> numbers;
  for (const int offset : number_offsets(robot)) numbers.push_back(number_at(robot, offset));
  EXPECT_EQ(numbers, (std::vector<double>{10, 11, 12, 13, 14, 15, 16, 20, 21, 22, 23, 24, 25, 26,
                                          30, 31, 32, 40, 41, 42, 43, 50, 51, 52, 53, 54, 55}));
  bus::Published changed = stream[2 * 99];
  put_number(changed, number_offsets(changed)[2], -7.25);
  put_header(changed, {123456789012345, 17, -3});
  const auto wrench = decoded<ft_wrench_t>(changed);
  EXPECT_EQ(wrench.wrench[2], -7.25);
  EXPECT_EQ(wrench.wrench[3], 100.3);
  EXPECT_EQ(wrench.utime, 123456789012345);
  EXPECT_EQ(wrench.seq, 17);
  EXPECT_EQ(wrench.session, -3);
}

TEST(Transforms, LoseTheConfiguredShareWithinTheWindowOnly) {
  const Stream stream = one_second();
  math::Random random(1, "");
  const Stream left = lose(stream, sensors_in(kWindow), 0.3, random);
  EXPECT_NEAR(static_cast<double>(stream.size() - left.size()), 0.3 * 1600, 60);
  const auto outside = [](const Stream& s) {
    return std::count_if(s.begin(), s.end(),
                         [](const auto& m) { return !kWindow.holds(m.time_ns); });
  };
  EXPECT_EQ(outside(left), outside(stream));
}

TEST(Transforms, BurstsAreNoLongerThanTheyMay) {
  const Stream stream = one_second();
  for (int seed = 0; seed < 20; ++seed) {
    math::Random random(seed, "");
    const Stream left = lose_bursts(stream, kWindow, 0.02, random);
    EXPECT_LT(left.size(), stream.size());
    for (std::size_t i = 2; i < left.size(); ++i)
      EXPECT_LE(left[i].time_ns - left[i - 1].time_ns, 21'000'000) << "seed " << seed;
  }
}

TEST(Transforms, ReorderedMessagesAreTheSameOnesNoFartherThanTheyMay) {
  const Stream stream = one_second();
  for (const int reach : {1, 16}) {
    math::Random random(reach, "");
    const Stream mixed = reorder(stream, sensors_in(kWindow), reach, random);
    ASSERT_EQ(mixed.size(), stream.size());
    std::map<std::string, int> place, away, moved;
    for (const bus::Published& message : mixed) {
      if (!is_sensor(message.channel)) continue;
      const int by = std::abs(header_of(message).seq - ++place[message.channel]);
      away[message.channel] = std::max(away[message.channel], by);
      moved[message.channel] += by > 0 ? 1 : 0;
    }
    for (const auto& [channel, most] : away) {
      EXPECT_LE(most, reach) << channel;
      EXPECT_GT(moved[channel], 100) << channel;
    }
    std::map<std::string, int> last;
    for (const bus::Published& message : rising(mixed)) {
      if (!is_sensor(message.channel)) continue;
      EXPECT_GT(header_of(message).seq, last[message.channel]);
      last[message.channel] = header_of(message).seq;
    }
  }
}

TEST(Transforms, DuplicatesAddNothingNew) {
  const Stream stream = one_second();
  math::Random random(3, "");
  const Stream more = duplicate(stream, sensors_in(kWindow), 5, random);
  EXPECT_GE(more.size(), stream.size() + 2 * 1600u);
  EXPECT_LE(more.size(), stream.size() + 5 * 1600u);
  EXPECT_TRUE(std::is_sorted(more.begin(), more.end(),
                             [](const auto& a, const auto& b) { return a.time_ns < b.time_ns; }));
  const Stream once = rising(more);
  EXPECT_EQ(once.size(), stream.size());
}

TEST(Transforms, MutationTouchesNumbersAlone) {
  const Stream stream = one_second();
  math::Random random(4, "");
  const Stream bad = mutate(
      stream, sensors_in(kWindow, "FT_WRENCH"), 1.0, [](math::Random&) { return NAN; }, random);
  for (std::size_t i = 0; i < stream.size(); ++i) {
    if (stream[i].channel != "FT_WRENCH" || !kWindow.holds(stream[i].time_ns)) {
      EXPECT_EQ(bad[i].data, stream[i].data);
      continue;
    }
    const auto wrench = decoded<ft_wrench_t>(bad[i]);
    EXPECT_EQ(wrench.seq, decoded<ft_wrench_t>(stream[i]).seq);
    EXPECT_GE(std::count_if(std::begin(wrench.wrench), std::end(wrench.wrench),
                            [](double x) { return std::isnan(x); }),
              1);
  }
}

TEST(Transforms, FrozenSensorsGoOnCounting) {
  const Stream frozen = freeze(one_second(), sensors_in(kWindow, "FT_WRENCH"));
  const auto first = decoded<ft_wrench_t>(frozen[2 * 99]),
             later = decoded<ft_wrench_t>(frozen[2 * 500]);
  EXPECT_EQ(first.wrench[1], later.wrench[1]);
  EXPECT_EQ(later.seq, 501);
  EXPECT_EQ(later.utime, 501'000);
}

TEST(Transforms, ARestartStartsFromTheBeginningAfterItsPause) {
  const Stream restarted = restart(one_second(), 0.4, 0.2, 9);
  int before = 0, after = 0;
  for (const bus::Published& message : restarted) {
    if (message.channel != "FT_WRENCH") continue;
    const Header header = header_of(message);
    if (message.time_ns < 400'000'000) {
      ++before;
      EXPECT_EQ(header.session, 5);
      continue;
    }
    EXPECT_GE(message.time_ns, 600'000'000);
    EXPECT_EQ(header.session, 9);
    EXPECT_EQ(header.seq, ++after);
    EXPECT_EQ(header.utime, message.time_ns / 1000 - 600'000);
  }
  EXPECT_EQ(before, 399);
  EXPECT_EQ(after, 401);
}

TEST(Transforms, OfOneSeedAreAlike) {
  const Stream stream = one_second();
  const auto run = [&](int seed) {
    math::Random random(seed, "");
    return lose_bursts(reorder(stream, sensors_in(kWindow), 8, random), kWindow, 0.02, random);
  };
  const Stream a = run(1), b = run(1), c = run(2);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a[i].data, b[i].data);
  EXPECT_NE(a.size(), c.size());
}

/// Output of the wire, tick by tick.
Stream through(FaultyWire& wire, const Stream& stream, int ticks) {
  Stream all;
  auto next = stream.begin();
  for (int tick = 1; tick <= ticks; ++tick) {
    Stream sent;
    for (; next != stream.end() && next->time_ns <= 1'000'000LL * tick; ++next)
      sent.push_back(*next);
    for (bus::Published& message : wire.pass(sent, 1'000'000LL * tick)) {
      EXPECT_LE(message.time_ns, 1'000'000LL * tick);
      all.push_back(message);
    }
  }
  return all;
}

bool same(const bus::Published& a, const bus::Published& b) {
  return a.channel == b.channel && a.data == b.data && a.time_ns == b.time_ns;
}

TEST(FaultyWire, WithoutAFaultHandsOnWhatItIsGiven) {
  const Stream stream = one_second();
  FaultyWire wire;
  const Stream passed = through(wire, stream, 1000);
  ASSERT_EQ(passed.size(), stream.size());
  EXPECT_TRUE(std::equal(passed.begin(), passed.end(), stream.begin(), same));
}

TEST(FaultyWire, EachFaultTouchesItsTimeAlone) {
  const Stream stream = one_second();
  std::set<std::string> names, harmful;
  for (int seed = 0; seed < 200; ++seed) {
    math::Random random(seed);
    FaultyWire wire;
    const std::string name = wire.put_any(0.1, random);
    ASSERT_GT(wire.end(), 0.1);
    ASSERT_LT(wire.end(), 1.0);
    const Stream passed = through(wire, stream, 1000);
    const auto part = [](const Stream& of, double begin, double end) {
      Stream result;
      for (const bus::Published& message : of)
        if (Window{begin, end}.holds(message.time_ns)) result.push_back(message);
      return result;
    };
    const auto alike = [&](double begin, double end) {
      const Stream a = part(passed, begin, end), b = part(stream, begin, end);
      return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), same);
    };
    EXPECT_TRUE(alike(0, 0.1)) << name;
    EXPECT_TRUE(alike(wire.end(), 1.001)) << name;
    names.insert(name);
    if (!alike(0.1, wire.end())) harmful.insert(name);
  }
  EXPECT_EQ(names.size(), 9u);
  EXPECT_EQ(harmful, names);
}

}  // namespace
}  // namespace palpate::faults
