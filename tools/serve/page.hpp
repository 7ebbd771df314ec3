#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <memory>
#include <set>

#include "rt/bus/authentication.hpp"
#include "tools/serve/server.hpp"

namespace palpate::serve {

class Page;

/// State shared by all connections of a server.
struct Room {
  const Assets& assets;
  Content& content;
  Content* guests;  // nullptr: none are served
  std::vector<std::string> guest_origins;
  Doorman doorman;
  std::set<std::shared_ptr<Page>> pages;
  ServerCounters counters;
};

/// WebSocket connection of one page, or of a guest.
class Page : public std::enable_shared_from_this<Page> {
 public:
  using Request = boost::beast::http::request<boost::beast::http::empty_body>;

  Page(Room& room, Content& content, boost::beast::tcp_stream stream);

  /// Answers the upgrade request, with the subprotocol if it is not empty, then serves the page.
  void begin(const Request& request, const std::string& protocol);
  /// Sends new data, unless earlier frames have not been drawn yet.
  void deliver(std::int64_t now_us);

 private:
  struct Message {
    bool binary;
    std::shared_ptr<const std::string> data;  // may be that of other pages as well
  };
  void read();
  void catch_up();
  bool is_behind();
  void send(bool binary, std::shared_ptr<const std::string> data);
  void send_text(std::string text) {
    send(false, std::make_shared<const std::string>(std::move(text)));
  }
  void write();
  void leave();

  Room& room_;
  Content& content_;
  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
  boost::beast::flat_buffer buffer_;
  std::deque<Message> waiting_;
  bool writing_ = false;
  bool left_ = false;
  bool owed_ = false;                 // a frame was due while the page lagged
  std::deque<std::int64_t> undrawn_;  // frames sent and not acknowledged
  std::shared_ptr<Client> client_;
};

/// Answers HTTP requests on a connection until it ends, or becomes a page's WebSocket.
void serve_http(Room& room, boost::asio::ip::tcp::socket socket);

/// Sends new data to every page that has kept up.
void deliver_to_pages(Room& room);

}  // namespace palpate::serve
