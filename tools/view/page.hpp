#pragma once

#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>

#include "tools/view/sessions.hpp"

namespace palpate::view {

/// WebSocket connection of one page.
class Page : public std::enable_shared_from_this<Page> {
 public:
  using Request = boost::beast::http::request<boost::beast::http::empty_body>;

  Page(Room& room, boost::beast::tcp_stream stream);

  /// Answers the upgrade request, then serves the page.
  void begin(const Request& request);
  /// Sends new data, unless earlier frames have not been drawn yet.
  void deliver(std::int64_t now_us);

 private:
  struct Message {
    bool binary;
    std::string data;
  };
  void read();
  void catch_up();
  bool is_behind();
  void send(bool binary, std::string data);
  void write();
  void leave();

  Room& room_;
  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
  boost::beast::flat_buffer buffer_;
  std::deque<Message> waiting_;
  bool writing_ = false;
  bool left_ = false;
  bool owed_ = false;                 // a frame was due while the page lagged
  std::deque<std::int64_t> undrawn_;  // frames sent and not acknowledged
  std::shared_ptr<Client> client_ = std::make_shared<Client>();
};

}  // namespace palpate::view
