#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <memory>
#include <set>

#include "tools/view/server.hpp"

namespace palpate::view {

class Page;

/// What all connections of one server share.
struct Room {
  const Assets& assets;
  Viewer& viewer;
  Doorman doorman;
  std::set<std::shared_ptr<Page>> pages;
  ServerCounters counters;
};

/// Answers requests of HTTP on a connection until it ends, or becomes a page's WebSocket.
void serve_http(Room& room, boost::asio::ip::tcp::socket socket);

/// Sends every page that has kept up what is new.
void deliver_to_pages(Room& room);

}  // namespace palpate::view
