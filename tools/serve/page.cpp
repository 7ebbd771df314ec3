#include "tools/serve/page.hpp"

namespace palpate::serve {

namespace beast = boost::beast;
namespace websocket = beast::websocket;

namespace {

constexpr std::size_t kLargestRequest = 16 * 1024;  // bytes of a page's request
constexpr std::size_t kMostWaiting = 1'000;         // messages queued for a page that does not read
constexpr std::size_t kMostUndrawn = 2;             // frames
constexpr std::size_t kBehind = 200;  // messages queued, from which on a page gets no new data

}  // namespace

Page::Page(Room& room, Content& content, beast::tcp_stream stream)
    : room_(room), content_(content), socket_(std::move(stream)), client_(content.make_client()) {}

void Page::begin(const Request& request, const std::string& protocol) {
  beast::get_lowest_layer(socket_).expires_never();
  websocket::stream_base::timeout timeout =
      websocket::stream_base::timeout::suggested(beast::role_type::server);
  timeout.idle_timeout = std::chrono::seconds(20);
  timeout.keep_alive_pings = true;
  socket_.set_option(timeout);
  socket_.read_message_max(kLargestRequest);
  if (!protocol.empty())
    socket_.set_option(websocket::stream_base::decorator([protocol](auto& response) {
      response.set(beast::http::field::sec_websocket_protocol, protocol);
    }));
  // On one machine compression costs more than it saves.
  socket_.async_accept(request, [self = shared_from_this()](beast::error_code error) {
    if (error) return;
    boost::system::error_code ignored;
    beast::get_lowest_layer(self->socket_)
        .socket()
        .set_option(boost::asio::ip::tcp::no_delay(true), ignored);
    self->client_->send_text = [page = std::weak_ptr<Page>(self)](std::string text) {
      if (const auto there = page.lock()) there->send_text(std::move(text));
    };
    self->room_.pages.insert(self);
    self->send_text(self->content_.greeting(bus::wall_clock_us()));
    self->read();
  });
}

void Page::read() {
  socket_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
    if (error || self->left_) return self->leave();
    const bool text = self->socket_.got_text();
    const std::string said = beast::buffers_to_string(self->buffer_.data());
    self->buffer_.consume(self->buffer_.size());
    if (!text || !self->content_.receive(self->client_, said, bus::wall_clock_us())) {
      return self->leave();
    }
    self->catch_up();
    self->read();
  });
}

bool Page::is_behind() {
  while (!undrawn_.empty() && undrawn_.front() <= client_->acknowledged) undrawn_.pop_front();
  // Sent is not drawn: the system's buffers alone would hold seconds of frames for a slow page.
  return undrawn_.size() >= kMostUndrawn || waiting_.size() >= kBehind;
}

/// A page that drew slightly late does not wait for the next period: it would lose a frame each
/// time.
void Page::catch_up() {
  if (!owed_ || is_behind()) return;
  const std::int64_t now_us = bus::wall_clock_us();
  content_.prepare(now_us);
  deliver(now_us);
}

void Page::deliver(std::int64_t now_us) {
  if (left_) return;
  owed_ = is_behind();
  if (owed_) {
    ++room_.counters.frames_skipped;
    return;
  }
  Delivery delivery = content_.deliver(*client_, now_us);
  for (std::string& text : delivery.texts) send_text(std::move(text));
  for (auto& parcel : delivery.parcels) {
    room_.counters.bytes += static_cast<std::int64_t>(parcel->size());
    send(true, std::move(parcel));
  }
  undrawn_.push_back(delivery.frame);
  ++room_.counters.frames;
}

void Page::send(bool binary, std::shared_ptr<const std::string> data) {
  if (left_) return;
  if (waiting_.size() >= kMostWaiting) return leave();
  waiting_.push_back({binary, std::move(data)});
  if (!writing_) write();
}

void Page::write() {
  writing_ = true;
  socket_.binary(waiting_.front().binary);
  socket_.async_write(boost::asio::buffer(*waiting_.front().data),
                      [self = shared_from_this()](beast::error_code error, std::size_t) {
                        self->writing_ = false;
                        if (error) return self->leave();
                        self->waiting_.pop_front();
                        if (!self->waiting_.empty()) self->write();
                      });
}

void Page::leave() {
  if (left_) return;
  left_ = true;
  boost::system::error_code ignored;
  beast::get_lowest_layer(socket_).socket().shutdown(boost::asio::ip::tcp::socket::shutdown_both,
                                                     ignored);
  beast::get_lowest_layer(socket_).close();
  client_->send_text = nullptr;
  room_.pages.erase(shared_from_this());
}

void deliver_to_pages(Room& room) {
  const std::int64_t now_us = bus::wall_clock_us();
  room.content.prepare(now_us);
  if (room.guests != nullptr) room.guests->prepare(now_us);
  const auto pages = room.pages;  // one may disconnect meanwhile
  for (const auto& page : pages) page->deliver(now_us);
}

}  // namespace palpate::serve
