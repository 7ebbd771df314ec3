#include "tools/serve/server.hpp"

#include <gtest/gtest.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/sensing/biotac_geometry.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/tools/view/shapes.hpp"
#include "tools/log/event_log.hpp"
#include "tools/view/viewer.hpp"

namespace palpate::view {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using nlohmann::json;

/// A server that plays a log of one shape, and sends commands to a bus without receivers.
class ServerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    log::EventLog log(path_);
    const auto mesh = box_mesh({2, 1, 1});
    log.write("SHAPE_MESH", 1'000'000, *box_mesh({2, 1, 1}));
    log.write("SHAPE", 1'000'001,
              shape_of(*mesh, [](const Eigen::Vector3f& x) -> Eigen::Vector3f { return 2 * x; }));
    biotac_t fingertip{};
    fingertip.valid = biotac_t::VALID_ELECTRODES | biotac_t::VALID_PAC;
    for (int i = 0; i < 19; ++i) fingertip.electrodes[i] = static_cast<std::int16_t>(100 + i);
    fingertip.pac_count = 2;
    fingertip.pac[1] = 7;
    log.write("BIOTAC_3", 31'000'000, fingertip);
    log.write("HEALTH", 61'000'000, health_t{});
  }
  void serve(bool control) {
    Viewer::Options options;
    options.control = control;
    viewer_ = std::make_unique<Viewer>(options, token_);
    std::vector<std::string> complaints;
    viewer_->show_log(std::make_unique<LogSource>(
        std::vector<std::string>{path_}, [](const std::string&, double) {}, complaints));
    viewer_->command_by(std::make_unique<client::Client>(*bus_, *bus_));
    serve::Server::Options server;
    server.port = 0;
    server.rate = 100;
    server_ = std::make_unique<serve::Server>(server, assets_, *viewer_);
    thread_ = std::thread([this] { server_->run(); });
    host_ = "127.0.0.1:" + std::to_string(server_->port());
  }
  void TearDown() override {
    if (!server_) return;
    server_->stop();
    thread_.join();
  }

  asio::ip::tcp::socket connect() {
    asio::ip::tcp::socket socket(context_);
    socket.connect(
        {asio::ip::make_address("127.0.0.1"), static_cast<std::uint16_t>(server_->port())});
    return socket;
  }
  http::response<http::string_body> get(const std::string& target, const std::string& host,
                                        http::verb verb = http::verb::get) {
    auto socket = connect();
    http::request<http::empty_body> request(verb, target, 11);
    if (!host.empty()) request.set(http::field::host, host);
    http::write(socket, request);
    beast::flat_buffer buffer;
    http::response_parser<http::string_body> parser;
    parser.body_limit(8 << 20);
    http::read(socket, buffer, parser);
    return parser.release();
  }

  using Socket = beast::websocket::stream<asio::ip::tcp::socket>;
  std::unique_ptr<Socket> open() {
    auto socket = std::make_unique<Socket>(connect());
    socket->set_option(beast::websocket::stream_base::decorator(
        [&](auto& request) { request.set(http::field::origin, "http://" + host_); }));
    socket->handshake(host_, "/live");
    return socket;
  }
  /// The server's answer to a WebSocket request.
  unsigned upgrade(const std::string& host, const std::string& origin,
                   const std::string& target = "/live") {
    auto socket = connect();
    http::request<http::empty_body> request(http::verb::get, target, 11);
    request.set(http::field::host, host);
    if (!origin.empty()) request.set(http::field::origin, origin);
    request.set(http::field::connection, "Upgrade");
    request.set(http::field::upgrade, "websocket");
    request.set(http::field::sec_websocket_version, "13");
    request.set(http::field::sec_websocket_key, "dGhlIHNhbXBsZSBub25jZQ==");
    http::write(socket, request);
    beast::flat_buffer buffer;
    http::response_parser<http::empty_body> parser;
    http::read_header(socket, buffer, parser);
    return parser.get().result_int();
  }
  static void send(Socket& socket, const json& message) {
    socket.text(true);
    socket.write(asio::buffer(message.dump()));
  }
  /// The next message of a type; frames are acknowledged if `acknowledge`.
  static json next(Socket& socket, const std::string& type, std::string* whole = nullptr,
                   bool acknowledge = true) {
    for (;;) {
      beast::flat_buffer buffer;
      socket.read(buffer);
      std::string data = beast::buffers_to_string(buffer.data());
      json head;
      if (socket.got_text()) {
        head = json::parse(data);
      } else {
        std::uint32_t length = 0;
        std::memcpy(&length, data.data(), 4);
        head = json::parse(data.substr(4, length));
      }
      if (acknowledge && head["type"] == "frame")
        send(socket, {{"type", "ack"}, {"frame", head["frame"]}});
      if (head["type"] != type) continue;
      if (whole != nullptr) *whole = data;
      return head;
    }
  }

  support::ScratchFolder folder_;
  std::string path_ = (folder_.path() / "run.log").string(), host_;
  serve::Token token_;
  serve::Assets assets_{page_files(), PALPATE_THREE_FOLDER};
  std::shared_ptr<bus::MemoryHub> hub_ = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> bus_ = bus::make_memory_bus(hub_);
  std::unique_ptr<Viewer> viewer_;
  std::unique_ptr<serve::Server> server_;
  std::thread thread_;
  asio::io_context context_;
};

TEST_F(ServerTest, GivesOutThePageAndNothingElse) {
  serve(false);
  const auto page = get("/", host_);
  EXPECT_EQ(page.result_int(), 200U);
  EXPECT_EQ(page[http::field::content_type], "text/html; charset=utf-8");
  EXPECT_NE(page.body().find("main.js"), std::string::npos);
  EXPECT_NE(page["Content-Security-Policy"].find("default-src 'self'"), beast::string_view::npos);
  // All files requested by the page exist, and are served from here.
  for (const auto& [name, asset] : assets_.all()) {
    EXPECT_EQ(get(name, host_).result_int(), 200U) << name;
    if (name.find("three") == std::string::npos && name.find("orbit") == std::string::npos) {
      EXPECT_EQ(asset.body.find("https://"), std::string::npos) << name;
    }
  }
  for (const char* target : {"/../../etc/passwd", "/%2e%2e/main.cpp", "/etc/passwd", "//three.js",
                             "/three.js/", "/page/main.js"})
    EXPECT_EQ(get(target, host_).result_int(), 404U) << target;
  EXPECT_EQ(get("/", host_, http::verb::post).result_int(), 405U);
}

TEST_F(ServerTest, RefusesOtherNamesAndOtherPages) {
  serve(true);
  for (const std::string& host : {std::string("evil.example"), std::string(), host_ + "0"})
    EXPECT_EQ(get("/", host).result_int(), 403U) << host;
  for (const std::string& origin :
       {std::string("http://evil.example"), std::string(), std::string("null")})
    EXPECT_EQ(upgrade(host_, origin), 403U) << origin;
  EXPECT_EQ(upgrade("evil.example", "http://evil.example"), 403U);
  EXPECT_EQ(upgrade(host_, "http://" + host_, "/other"), 404U);
  EXPECT_EQ(upgrade(host_, "http://" + host_), 101U);
}

TEST_F(ServerTest, SendsMeshAndFramesWithTheNumbersOfTheLog) {
  serve(false);
  const auto socket = open();
  EXPECT_EQ(next(*socket, "hello")["mode"], "log");
  const json mesh = next(*socket, "mesh");
  EXPECT_EQ(mesh["role"], "estimate");
  std::string whole;
  const json frame = next(*socket, "frame", &whole);
  EXPECT_EQ(frame["mesh"], mesh["hash"]);
  ASSERT_EQ(frame["arrays"][0]["name"], "x");
  const auto expected = box_mesh({2, 1, 1});
  std::uint32_t length = 0;
  std::memcpy(&length, whole.data(), 4);
  std::vector<float> x(frame["arrays"][0]["count"].get<std::size_t>());
  ASSERT_EQ(x.size(), expected->rest_xyz.size());
  std::memcpy(x.data(), whole.data() + 4 + length, 4 * x.size());
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_FLOAT_EQ(x[i], 2 * expected->rest_xyz[i]);
  send(*socket, {{"type", "colour"}, {"field", "strain"}});
  while (next(*socket, "frame", &whole)["field"] != "strain") {
  }
  float last = 0;
  std::memcpy(&last, whole.data() + whole.size() - 4, 4);
  EXPECT_NEAR(last, 1, 1e-4) << "twice as long";
}

TEST_F(ServerTest, SendsTheFingertipsThatThereAre) {
  serve(false);
  const auto socket = open();
  send(*socket, {{"type", "play"}, {"action", "pause"}});
  EXPECT_FALSE(next(*socket, "frame").contains("fingertips")) << "not yet";
  send(*socket, {{"type", "play"}, {"action", "seek"}, {"value", 30.5}});
  std::string whole;
  json frame;
  do frame = next(*socket, "frame", &whole);
  while (frame["player"]["time"] != 30.5);
  ASSERT_EQ(frame["fingertips"].size(), 1U);
  const json& fingertip = frame["fingertips"][0];
  EXPECT_EQ(fingertip["channel"], "BIOTAC_3");
  EXPECT_EQ(fingertip["age_ms"], 500);
  EXPECT_EQ(fingertip["electrodes"].size(), 19U);
  EXPECT_EQ(fingertip["electrodes"][18], 118);
  ASSERT_EQ(frame["arrays"].back()["name"], "BIOTAC_3_pac");
  std::int32_t pac[2];
  std::memcpy(pac, whole.data() + whole.size() - 8, 8);
  EXPECT_EQ(pac[0], 0);
  EXPECT_EQ(pac[1], 7);
}

/// On the cylinder, whose radius exceeds that of the electrodes, the way along the skin is longer
/// than that through the finger; lengths along its axis remain.
TEST_F(ServerTest, UnrollsTheSkinWithTheElectrodes) {
  serve(false);
  const json places = next(*open(), "hello")["electrodes"];
  ASSERT_EQ(places.size(), 19U);
  const Eigen::Matrix3Xd positions = 1e3 * sensing::electrode_positions();
  for (int i = 0; i < 19; ++i) {
    const Eigen::Vector2d place(places[i][0], places[i][1]);
    EXPECT_EQ(place.y() > 0, positions(1, i) > 0) << "E" << i + 1;
    EXPECT_LT(std::abs(place.y()), 11.2) << "within the page's outline of the skin, E" << i + 1;
    if (positions(0, i) > 0) {
      EXPECT_GT(place.x(), 0) << "E" << i + 1;
      continue;
    }
    EXPECT_DOUBLE_EQ(place.x(), positions(0, i)) << "E" << i + 1;
    for (int j = 0; j < i; ++j) {
      if (positions(0, j) > 0) continue;
      const double direct = (positions.col(i) - positions.col(j)).norm();
      EXPECT_GE((place - Eigen::Vector2d(places[j][0], places[j][1])).norm(), direct * (1 - 1e-9))
          << "E" << i + 1 << " and E" << j + 1;
    }
  }
}

TEST_F(ServerTest, AFrameWaitsForThePageToHaveDrawn) {
  serve(false);
  const auto socket = open();
  const std::int64_t first = next(*socket, "frame", nullptr, false)["frame"];
  const std::int64_t second = next(*socket, "frame", nullptr, false)["frame"];
  // Frames are due every 10 ms, but two are not drawn yet.
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  boost::system::error_code error;
  EXPECT_EQ(socket->next_layer().available(error), 0U);
  EXPECT_EQ(second, first + 1);
  send(*socket, {{"type", "ack"}, {"frame", second}});
  EXPECT_GT(next(*socket, "frame", nullptr, false)["frame"], second);
  send(*socket, {{"type", "ack"}, {"frame", 1'000'000'000}});
  EXPECT_GT(next(*socket, "frame")["frame"], second) << "what was never sent counts for nothing";
  server_->stop();
  thread_.join();
  EXPECT_GT(server_->counters().frames_skipped, 5);
  server_.reset();
}

TEST_F(ServerTest, CommandsNeedTheToken) {
  serve(true);
  std::vector<bus::Published> published;
  bus::record(*hub_, &published);
  const auto socket = open();
  const json start = {{"type", "command"}, {"id", 1}, {"event", "start"}};
  const json push = {{"type", "push"}, {"point", {0, 0, 0}}, {"force", {1, 0, 0}}};
  for (const json& request : {start, push}) {
    send(*socket, request);
    EXPECT_NE(next(*socket, "error")["reason"].get<std::string>().find("token"), std::string::npos);
  }
  send(*socket, {{"type", "control"}, {"token", serve::Token().text()}});
  EXPECT_EQ(next(*socket, "control")["granted"], false);
  EXPECT_TRUE(published.empty());
  send(*socket, {{"type", "control"}, {"token", token_.text()}});
  EXPECT_EQ(next(*socket, "control")["granted"], true);
  send(*socket, push);
  send(*socket, start);
  send(*socket, {{"type", "nonsense"}});
  next(*socket, "error");
  ASSERT_GE(published.size(), 2U);
  EXPECT_EQ(published[0].channel, "MANUAL_FORCE");
  EXPECT_EQ(published[1].channel, "COMPONENT_COMMAND");
}

TEST_F(ServerTest, WhoGuessesTokensIsSentAway) {
  serve(true);
  const auto socket = open();
  for (int i = 0; i < 3; ++i)
    send(*socket, {{"type", "control"}, {"token", serve::Token().text()}});
  EXPECT_THROW(for (;;) next(*socket, "control"), boost::system::system_error);
}

TEST_F(ServerTest, WithoutControlTheTokenOpensNothing) {
  serve(false);
  const auto socket = open();
  send(*socket, {{"type", "control"}, {"token", token_.text()}});
  EXPECT_EQ(next(*socket, "control")["granted"], false);
  send(*socket, {{"type", "command"}, {"id", 1}, {"event", "start"}});
  EXPECT_NE(next(*socket, "error")["reason"].get<std::string>().find("--control"),
            std::string::npos);
}

TEST_F(ServerTest, LongMessagesAndOtherThanTextEndTheConnection) {
  serve(true);
  for (const bool text : {true, false}) {
    const auto socket = open();
    socket->text(text);
    socket->write(asio::buffer(std::string(text ? 17'000 : 10, ' ')));
    EXPECT_THROW(for (;;) next(*socket, "none"), boost::system::system_error);
  }
  EXPECT_EQ(get("/", host_).result_int(), 200U) << "others are served on";
}

TEST_F(ServerTest, ATimelineIsMovedByThePage) {
  serve(false);
  const auto socket = open();
  EXPECT_NEAR(next(*socket, "hello")["log"]["duration"].get<double>(), 60, 1e-3);
  send(*socket, {{"type", "play"}, {"action", "pause"}});
  send(*socket, {{"type", "play"}, {"action", "seek"}, {"value", 30.5}});
  json frame;
  do frame = next(*socket, "frame");
  while (frame["player"]["time"] != 30.5);
  EXPECT_EQ(frame["player"]["playing"], false);
  send(*socket, {{"type", "play"}, {"action", "rate"}, {"value", 100}});
  send(*socket, {{"type", "play"}, {"action", "play"}});
  do frame = next(*socket, "frame");
  while (frame["player"]["time"] < 60.0);
  EXPECT_EQ(frame["player"]["playing"], false) << "at its end";
}

}  // namespace
}  // namespace palpate::view
