#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <memory>
#include <set>

#include "tools/view/server.hpp"

namespace palpate::view {

class Page;

/// State shared by all connections of a server.
struct Room {
  const Assets& assets;
  Viewer& viewer;
  Doorman doorman;
  std::set<std::shared_ptr<Page>> pages;
  ServerCounters counters;
};

/// Answers HTTP requests on a connection until it ends, or becomes a page's WebSocket.
void serve_http(Room& room, boost::asio::ip::tcp::socket socket);

/// Sends new data to every page that has kept up.
void deliver_to_pages(Room& room);

}  // namespace palpate::view
