#include "tools/bridge/ur/rtde_client.hpp"

#include <gtest/gtest.h>

#include <random>

namespace palpate::ur_bridge {
namespace {

/// Bytes that a test puts; what the client sends is kept.
class PutStream final : public bridge::Stream {
 public:
  void open() override { is_open = true, ++openings; }
  State state() override { return is_open ? State::kOpen : State::kClosed; }
  int read(std::uint8_t* to, int size) override {
    const auto count = std::min(static_cast<std::size_t>(size), bytes.size());
    std::copy_n(bytes.begin(), count, to);
    bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
    return static_cast<int>(count);
  }
  bool write(const std::uint8_t* data, int size) override {
    sent.assign(data, data + size);
    return is_open;
  }
  void close() override { is_open = false, bytes.clear(); }
  const std::string& name() const override { return name_; }

  bool is_open = false;
  int openings = 0;
  std::vector<std::uint8_t> bytes, sent;

 private:
  std::string name_ = "put:1";
};

struct Client {
  PutStream* stream = new PutStream;
  RtdeClient client{
      std::unique_ptr<bridge::Stream>(stream),
      {{{"timestamp", "DOUBLE"}, {"robot_mode", "INT32"}}, {{"input_int_register_24", "INT32"}}}};
  std::int64_t now_ns = 1;

  void put(std::vector<std::uint8_t> package) {
    stream->bytes.insert(stream->bytes.end(), package.begin(), package.end());
  }
  void put(PackageType type, const std::vector<std::uint8_t>& fields) {
    PackageWriter writer(type);
    for (const std::uint8_t byte : fields) writer.put(byte);
    put(writer.finish());
  }
  void put(PackageType type, std::uint8_t recipe, const std::string& text) {
    put(PackageWriter(type).put(recipe).put_text(text).finish());
  }
  const std::uint8_t* turn() {
    client.poll(now_ns += 1'000'000);
    return client.take();
  }
  /// Through the whole set-up.
  void start() {
    turn();
    put(PackageType::kProtocolVersion, {1});
    turn();
    put(PackageType::kControllerVersion, {0, 0, 0, 5, 0, 0, 0, 12, 0, 0, 0, 0, 0, 0, 0, 0});
    turn();
    put(PackageType::kSetupOutputs, 3, "DOUBLE,INT32");
    turn();
    put(PackageType::kSetupInputs, 7, "INT32");
    turn();
    put(PackageType::kStart, {1});
    turn();
  }
  void put_data(double timestamp, std::int32_t mode) {
    put(PackageWriter(PackageType::kData).put(std::uint8_t{3}).put(timestamp).put(mode).finish());
  }
};

TEST(RtdeClient, SetsUpAndReadsWhateverThePieces) {
  Client one;
  one.start();
  ASSERT_TRUE(one.client.is_running());
  EXPECT_EQ(one.stream->sent, (std::vector<std::uint8_t>{0, 3, 'S'}));
  PackageWriter data(PackageType::kData);
  const std::vector<std::uint8_t> bytes =
      data.put(std::uint8_t{3}).put(12.5).put(std::int32_t{-7}).finish();
  for (std::size_t i = 0; i + 1 < bytes.size(); ++i) {
    one.put({bytes[i]});
    EXPECT_EQ(one.turn(), nullptr);
  }
  one.put({bytes.back()});
  one.put_data(13, 7);
  const std::uint8_t* first = one.turn();
  ASSERT_NE(first, nullptr);
  PackageReader reader(first, one.client.output_size());
  EXPECT_EQ(reader.get<double>(), 12.5);
  EXPECT_EQ(reader.get<std::int32_t>(), -7);
  EXPECT_TRUE(reader.is_complete());
  EXPECT_NE(one.client.take(), nullptr);
  EXPECT_EQ(one.client.take(), nullptr);
}

TEST(RtdeClient, SendsInputsInTheirOrder) {
  Client one;
  one.client.begin_inputs().put(std::int32_t{5});
  one.client.send_inputs();
  EXPECT_TRUE(one.stream->sent.empty()) << "not connected";
  one.start();
  one.client.begin_inputs().put(std::int32_t{258});
  one.client.send_inputs();
  EXPECT_EQ(one.stream->sent, (std::vector<std::uint8_t>{0, 8, 'U', 7, 0, 0, 1, 2}));
}

TEST(RtdeClient, EachMalformedPackageEndsTheConnectionAndIsNamed) {
  const std::vector<std::pair<std::vector<std::uint8_t>, std::string>> cases{
      {{0, 0, 'U'}, "a package of 0 bytes"},
      {{0, 2, 'U'}, "a package of 2 bytes"},
      {{0xff, 0xff, 'U', 3}, "a package of 65535 bytes"},
      {{0, 4, 'U', 3}, "data of another recipe or size"},
      {{0, 16, 'U', 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "data of another recipe or size"},
      {{0, 17, 'U', 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "data of another recipe or size"},
      {{0, 4, 'S', 1}, "an unexpected package"},
      {{0, 3, 'x'}, "an unexpected package"},
      {{0, 6, 'M', 200, 'a', 'b'}, "a text message is malformed"},
      {{0, 3, 'M'}, "a text message is malformed"}};
  for (const auto& [bytes, text] : cases) {
    Client one;
    one.start();
    while (!one.client.next_remark().empty()) {
    }
    one.put(bytes);
    EXPECT_EQ(one.turn(), nullptr);
    EXPECT_FALSE(one.client.is_running()) << text;
    EXPECT_NE(one.client.next_remark().find(text), std::string::npos) << text;
    EXPECT_EQ(one.stream->openings, 1);
    one.now_ns += 600'000'000;
    one.start();
    EXPECT_TRUE(one.client.is_running()) << "connects again";
  }
}

TEST(RtdeClient, SaysWhatTheControllerSays) {
  Client one;
  one.start();
  while (!one.client.next_remark().empty()) {
  }
  one.put({0, 12, 'M', 3, 'h', 'o', 't', 3, 'J', '1', 'x', 2});
  one.turn();
  EXPECT_EQ(one.client.next_remark(), "the controller says: J1x: hot");
  EXPECT_TRUE(one.client.is_running());
}

TEST(RtdeClient, SilenceEndsTheConnection) {
  Client one;
  one.start();
  one.now_ns += 2'100'000'000;
  one.turn();
  EXPECT_FALSE(one.client.is_running());
}

/// Whatever arrives in the place of the controller's answers, nothing is read past it.
TEST(RtdeClient, SurvivesRandomBytes) {
  std::mt19937 random(1);
  for (int round = 0; round < 2000; ++round) {
    Client one;
    if (round % 2 == 0) one.start();
    for (int i = 0; i < 20; ++i) {
      std::vector<std::uint8_t> bytes(random() % 40);
      for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
      const char types[] = "VvMUOISP";
      if (bytes.size() > 3) bytes[0] = 0, bytes[1] = static_cast<std::uint8_t>(bytes.size());
      if (bytes.size() > 3) bytes[2] = static_cast<std::uint8_t>(types[random() % 8]);
      one.put(bytes);
      one.turn();
      one.now_ns += 100'000'000;
    }
  }
}

}  // namespace
}  // namespace palpate::ur_bridge
