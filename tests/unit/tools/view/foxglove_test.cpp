#include <gtest/gtest.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <thread>

#include "tests/unit/tools/view/shapes.hpp"
#include "tools/view/foxglove_content.hpp"
#include "tools/view/viewer.hpp"

namespace palpate::view {
namespace {

using nlohmann::json;

constexpr const char* kOther = R"(
package lab;
struct gripper_t { double width; int32_t count; float samples[count]; string state; })";

/// One client of the content, without sockets.
class FoxgloveTest : public ::testing::Test {
 protected:
  FoxgloveTest() {
    client_->send_text = [this](const std::string& text) { said_.push_back(json::parse(text)); };
  }
  template <class Message>
  void take(const char* channel, const Message& message, std::int64_t time_us = 7) {
    const auto data = encoded(message);
    topics_.take(channel, data.data(), static_cast<int>(data.size()), time_us);
    scene_.accept(channel, data.data(), static_cast<int>(data.size()), time_us);
  }
  /// What is delivered now; new channels are added to `channels_`.
  std::vector<std::string> deliver() {
    scene_.refresh();
    content_.prepare(0);
    const serve::Delivery delivery = content_.deliver(*client_, 0);
    EXPECT_EQ(delivery.frame, 0) << "nothing that a client would have to acknowledge";
    for (const std::string& text : delivery.texts) {
      const json advertised = json::parse(text);
      EXPECT_EQ(advertised["op"], "advertise");
      for (const json& channel : advertised["channels"]) channels_[channel["topic"]] = channel;
    }
    std::vector<std::string> messages;
    for (const auto& parcel : delivery.parcels) messages.push_back(*parcel);
    return messages;
  }
  bool send(const json& request) { return content_.receive(client_, request.dump(), 0); }
  bool subscribe(std::uint32_t id, const std::string& topic) {
    return send({{"op", "subscribe"},
                 {"subscriptions", {{{"id", id}, {"channelId", channels_.at(topic)["id"]}}}}});
  }
  static json body(const std::string& message) { return json::parse(message.substr(13)); }

  types::TypeSet types_{kOther, "other.lcm"};
  Scene scene_;
  FoxgloveTopics topics_{types_, math::Pose::Identity()};
  FoxgloveContent content_{topics_, scene_};
  std::shared_ptr<serve::Client> client_ = content_.make_client();
  std::vector<json> said_;
  std::map<std::string, json> channels_;
};

ft_wrench_t wrench(double z) {
  ft_wrench_t message{};
  message.wrench[2] = z;
  return message;
}

TEST_F(FoxgloveTest, SendsTheLastMessageOfWhatIsSubscribed) {
  EXPECT_EQ(json::parse(content_.greeting(5))["op"], "serverInfo");
  take("FT_WRENCH", wrench(1));
  EXPECT_TRUE(deliver().empty()) << "nothing is subscribed";
  ASSERT_EQ(channels_.size(), 1U);
  EXPECT_EQ(channels_["FT_WRENCH"]["schemaName"], "palpate.ft_wrench_t");
  EXPECT_EQ(channels_["FT_WRENCH"]["schemaEncoding"], "jsonschema");
  EXPECT_EQ(json::parse(channels_["FT_WRENCH"]["schema"].get<std::string>())["type"], "object");
  EXPECT_TRUE(subscribe(0x01020304, "FT_WRENCH"));
  take("FT_WRENCH", wrench(2), 3'000'000);
  const auto messages = deliver();
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(messages[0].substr(0, 5), std::string("\x01\x04\x03\x02\x01", 5));
  std::uint64_t nanoseconds = 0;
  std::memcpy(&nanoseconds, messages[0].data() + 5, 8);
  EXPECT_EQ(nanoseconds, 3'000'000'000U);
  EXPECT_EQ(body(messages[0])["wrench"][2], 2);
  EXPECT_TRUE(deliver().empty()) << "it has been sent";
  take("FT_WRENCH", wrench(3));
  EXPECT_TRUE(send({{"op", "unsubscribe"}, {"subscriptionIds", {0x01020304}}}));
  EXPECT_TRUE(deliver().empty());
  EXPECT_TRUE(said_.empty());
}

TEST_F(FoxgloveTest, SendsDescribedTypes) {
  // Fingerprint; 0.5; 1; 0.25; "ok".
  std::int64_t fingerprint = types_.structs().front()->fingerprint;
  std::vector<std::uint8_t> data(8);
  for (int i = 0; i < 8; ++i)
    data[i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(fingerprint) >> (56 - 8 * i));
  for (const int byte : {0x3f, 0xe0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0x3e, 0x80, 0, 0, 0, 0, 0, 3})
    data.push_back(static_cast<std::uint8_t>(byte));
  for (const char letter : {'o', 'k', '\0'}) data.push_back(static_cast<std::uint8_t>(letter));
  topics_.take("GRIPPER", data.data(), static_cast<int>(data.size()), 1);
  deliver();
  subscribe(1, "GRIPPER");
  const auto messages = deliver();
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(body(messages[0]).dump(), R"({"count":1,"samples":[0.25],"state":"ok","width":0.5})");
}

TEST_F(FoxgloveTest, IgnoresWhatItCannotRead) {
  auto data = encoded(wrench(1));
  topics_.take("FT_WRENCH", data.data(), 5, 1);
  data[0] ^= 1;
  topics_.take("FT_WRENCH", data.data(), static_cast<int>(data.size()), 1);
  EXPECT_EQ(topics_.size(), 0U) << "no type known";
  data[0] ^= 1;
  topics_.take("FT_WRENCH", data.data(), static_cast<int>(data.size()) - 1, 1);
  deliver();
  subscribe(1, "FT_WRENCH");
  EXPECT_TRUE(deliver().empty()) << "a byte is missing";
  for (std::size_t i = 0; i < 2 * FoxgloveTopics::kMost; ++i)
    take(("C" + std::to_string(i)).c_str(), wrench(1));
  EXPECT_EQ(topics_.size(), FoxgloveTopics::kMost);
  take("\xff\xfe", wrench(1));
  deliver();
}

TEST_F(FoxgloveTest, DrawsTheShape) {
  const auto mesh = box_mesh({2, 1, 1});
  take("SHAPE_MESH", *mesh);
  take("SHAPE", shape_of(*mesh, [](const Eigen::Vector3f& x) -> Eigen::Vector3f { return 2 * x; }),
       9'000'000);
  robot_state_t robot{};
  robot.quaternion[0] = 1;
  robot.position[1] = 0.5;
  take("ROBOT_STATE", robot);
  deliver();
  for (const char* topic : {"/shape/estimate", "/tf/object", "/tf/flange", "/flange"})
    ASSERT_TRUE(channels_.count(topic)) << topic;
  EXPECT_EQ(channels_["/shape/estimate"]["schemaName"], "foxglove.SceneUpdate");
  subscribe(1, "/shape/estimate");
  subscribe(2, "/tf/flange");
  const auto messages = deliver();
  ASSERT_EQ(messages.size(), 2U);
  const json points = body(messages[0])["entities"][0]["triangles"][0]["points"];
  ASSERT_EQ(points.size(), mesh->rest_xyz.size() / 3);
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_NEAR(points[i]["x"].get<double>(), 2 * mesh->rest_xyz[3 * i], 1e-6);
  EXPECT_EQ(body(messages[1])["translation"]["y"], 0.5);
  EXPECT_TRUE(deliver().empty()) << "nothing has moved";
}

TEST_F(FoxgloveTest, ComplainsOfRequestsThatMakeNoSense) {
  take("FT_WRENCH", wrench(1));
  deliver();
  for (const char* text :
       {"", "{", "[]", "{}", R"({"op":1})", R"({"op":"advertise","channels":[]})",
        R"({"op":"subscribe"})", R"({"op":"subscribe","subscriptions":[{"id":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":9}]})",
        R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":0}]})",
        R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":0.5}]})",
        R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1e300}]})",
        R"({"op":"unsubscribe","subscriptionIds":["x"]})"}) {
    said_.clear();
    EXPECT_TRUE(content_.receive(client_, text, 0)) << text;
    ASSERT_EQ(said_.size(), 1U) << text;
    EXPECT_EQ(said_[0]["op"], "status") << text;
  }
  EXPECT_TRUE(deliver().empty());
  bool is_kept = true;
  for (std::uint32_t id = 0; id <= FoxgloveContent::kMostSubscriptions && is_kept; ++id)
    is_kept = subscribe(id, "FT_WRENCH");
  EXPECT_FALSE(is_kept) << "who subscribes without end is sent away";
}

/// By sockets: who gets in.
TEST_F(FoxgloveTest, ServesItsProtocolToProgramsAndToKnownPages) {
  namespace asio = boost::asio;
  namespace websocket = boost::beast::websocket;
  Viewer viewer(Viewer::Options{}, serve::Token());
  const serve::Assets assets{page_files(), PALPATE_THREE_FOLDER};
  serve::Server::Options options;
  options.port = 0;
  options.rate = 100;
  options.guest_origins = {"https://lab.example"};
  take("FT_WRENCH", wrench(4));
  serve::Server server(options, assets, viewer, &content_);
  std::thread thread([&server] { server.run(); });
  asio::io_context context;
  const std::string host = "127.0.0.1:" + std::to_string(server.port());
  const auto open = [&](const std::string& protocol, const std::string& origin) {
    auto socket = std::make_unique<websocket::stream<asio::ip::tcp::socket>>(context);
    socket->next_layer().connect(
        {asio::ip::make_address("127.0.0.1"), static_cast<std::uint16_t>(server.port())});
    socket->set_option(websocket::stream_base::decorator([&](websocket::request_type& request) {
      request.set(boost::beast::http::field::sec_websocket_protocol, protocol);
      if (!origin.empty()) request.set(boost::beast::http::field::origin, origin);
    }));
    boost::system::error_code error;
    websocket::response_type answer;
    socket->handshake(answer, host, "/", error);
    const auto chosen = answer[boost::beast::http::field::sec_websocket_protocol];
    return std::pair(error ? nullptr : std::move(socket), std::string(chosen));
  };
  EXPECT_FALSE(open("foxglove.websocket.v1", "https://evil.example").first);
  EXPECT_FALSE(open("another.v1", "").first) << "our own page's protocol needs its origin";
  for (const char* origin : {"", "https://lab.example"}) {
    const auto [socket, chosen] = open("other, foxglove.websocket.v1", origin);
    ASSERT_TRUE(socket) << origin;
    EXPECT_EQ(chosen, "foxglove.websocket.v1");
    boost::beast::flat_buffer buffer;
    const auto read = [&, &from = socket] {
      buffer.clear();
      from->read(buffer);
      return boost::beast::buffers_to_string(buffer.data());
    };
    EXPECT_EQ(json::parse(read())["op"], "serverInfo");
    EXPECT_EQ(json::parse(read())["op"], "advertise");
    socket->write(asio::buffer(
        json{{"op", "subscribe"}, {"subscriptions", {{{"id", 3}, {"channelId", 0}}}}}.dump()));
    EXPECT_EQ(body(read())["wrench"][2], 4);
  }
  server.stop();
  thread.join();
}

}  // namespace
}  // namespace palpate::view
