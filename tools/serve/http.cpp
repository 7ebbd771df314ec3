#include <algorithm>
#include <optional>

#include "tools/serve/page.hpp"

namespace palpate::serve {

namespace beast = boost::beast;
namespace http = beast::http;

namespace {

constexpr std::chrono::seconds kIdleTimeout{15};
constexpr std::uint32_t kLongestHeader = 8 * 1024;
constexpr std::size_t kMostPages = 16;

using Response = http::response<http::string_body>;

/// One HTTP connection.
class Session : public std::enable_shared_from_this<Session> {
 public:
  Session(Room& room, boost::asio::ip::tcp::socket socket)
      : room_(room), stream_(std::move(socket)) {}

  void read() {
    parser_.emplace();
    parser_->header_limit(kLongestHeader);
    parser_->body_limit(0);
    stream_.expires_after(kIdleTimeout);
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](beast::error_code error, std::size_t) {
                       if (error) return self->close();
                       self->handle(self->parser_->get());
                     });
  }

 private:
  void handle(const Page::Request& request) {
    ++room_.counters.requests;
    const std::string host(request[http::field::host]);
    if (!room_.doorman.knows_host(host)) {
      ++room_.counters.refused;
      return answer(request, http::status::forbidden, "text/plain",
                    "the server is not known by this name; palpate-view --name adds one\n");
    }
    if (beast::websocket::is_upgrade(request)) return upgrade(request, host);
    if (request.method() != http::verb::get && request.method() != http::verb::head)
      return answer(request, http::status::method_not_allowed, "text/plain", "GET alone\n");
    const std::string target(request.target());
    const Asset* asset = room_.assets.find(target.substr(0, target.find('?')));
    if (!asset) return answer(request, http::status::not_found, "text/plain", "not here\n");
    answer(request, http::status::ok, asset->type, asset->body);
  }

  /// The subprotocol of guests among those that the request names, or none.
  std::string guest_protocol(const Page::Request& request) const {
    if (room_.guests == nullptr) return {};
    http::token_list wanted(request[http::field::sec_websocket_protocol]);
    for (const std::string& known : room_.guests->protocols())
      if (wanted.exists(known)) return known;
    return {};
  }

  void upgrade(const Page::Request& request, const std::string& host) {
    const std::string origin(request[http::field::origin]);
    const std::string protocol = guest_protocol(request);
    if (!protocol.empty()) return admit_guest(request, origin, protocol);
    if (!room_.doorman.knows_origin(origin, host)) {
      ++room_.counters.refused;
      return answer(request, http::status::forbidden, "text/plain", "not a page of this server\n");
    }
    if (request.target() != "/live")
      return answer(request, http::status::not_found, "text/plain", "not here\n");
    begin(request, room_.content, {});
  }

  void admit_guest(const Page::Request& request, const std::string& origin,
                   const std::string& protocol) {
    const auto& known = room_.guest_origins;
    if (!origin.empty() && std::find(known.begin(), known.end(), origin) == known.end()) {
      ++room_.counters.refused;
      return answer(request, http::status::forbidden, "text/plain",
                    "pages of this origin may not read here; --foxglove-origin adds one\n");
    }
    begin(request, *room_.guests, protocol);
  }

  void begin(const Page::Request& request, Content& content, const std::string& protocol) {
    if (room_.pages.size() >= kMostPages)
      return answer(request, http::status::service_unavailable, "text/plain", "too many pages\n");
    std::make_shared<Page>(room_, content, std::move(stream_))->begin(request, protocol);
  }

  void answer(const Page::Request& request, http::status status, const std::string& type,
              const std::string& body) {
    response_ = Response(status, request.version());
    response_.set(http::field::content_type, type);
    // Another version of the program has another page.
    response_.set(http::field::cache_control, "no-cache");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Referrer-Policy", "no-referrer");
    response_.set("Cross-Origin-Resource-Policy", "same-origin");
    response_.set("Content-Security-Policy",
                  "default-src 'self'; img-src 'self' data: blob:; object-src 'none'; "
                  "base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
    response_.keep_alive(request.keep_alive() && status == http::status::ok);
    response_.body() = body;
    response_.prepare_payload();
    if (request.method() == http::verb::head) response_.body().clear();
    stream_.expires_after(kIdleTimeout);
    http::async_write(stream_, response_,
                      [self = shared_from_this()](beast::error_code error, std::size_t) {
                        if (error || !self->response_.keep_alive()) return self->close();
                        self->read();
                      });
  }

  void close() {
    boost::system::error_code ignored;
    stream_.socket().shutdown(boost::asio::ip::tcp::socket::shutdown_send, ignored);
    stream_.close();
  }

  Room& room_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{64 * 1024};
  std::optional<http::request_parser<http::empty_body>> parser_;
  Response response_;
};

}  // namespace

void serve_http(Room& room, boost::asio::ip::tcp::socket socket) {
  std::make_shared<Session>(room, std::move(socket))->read();
}

}  // namespace palpate::serve
