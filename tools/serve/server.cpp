#include "tools/serve/server.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "tools/serve/page.hpp"

namespace palpate::serve {
namespace {

std::string type_of(const std::string& name) {
  const std::string suffix = name.substr(name.rfind('.') + 1);
  if (suffix == "html") return "text/html; charset=utf-8";
  if (suffix == "css") return "text/css; charset=utf-8";
  if (suffix == "svg") return "image/svg+xml";
  return "text/javascript; charset=utf-8";
}

std::string read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file || text.str().empty())
    throw std::runtime_error(path +
                             ": cannot be read; apt-get install libjs-three, or name the folder "
                             "of three.min.js by --three");
  return text.str();
}

}  // namespace

Assets::Assets(const Files& page, const std::string& three) {
  for (const Files* files : {&shared_page_files(), &page})
    for (const auto& [name, body] : *files) assets_["/" + name] = {type_of(name), body};
  assets_["/"] = assets_.at("/index.html");
  const std::string script = type_of(".js");
  assets_["/three.js"] = {script, read(three + "/three.min.js")};
  assets_["/orbit_controls.js"] = {script, read(three + "/examples/js/controls/OrbitControls.js")};
}

const Asset* Assets::find(std::string_view path) const {
  const auto found = assets_.find(path);
  return found == assets_.end() ? nullptr : &found->second;
}

struct Server::Impl {
  Impl(const Options& wanted, const Assets& assets, Content& shown, Content* guests)
      : options(wanted),
        content(shown),
        context(1),
        acceptor(context),
        receive_timer(context),
        frame_timer(context) {
    listen();
    std::vector<std::string> names = options.names;
    for (const char* name : {"127.0.0.1", "localhost", "[::1]"}) names.emplace_back(name);
    const auto address = acceptor.local_endpoint().address();
    if (!address.is_unspecified())
      names.push_back(address.is_v6() ? "[" + address.to_string() + "]" : address.to_string());
    room = std::make_unique<Room>(Room{assets,
                                       content,
                                       guests,
                                       options.guest_origins,
                                       Doorman(names, acceptor.local_endpoint().port()),
                                       {},
                                       {}});
  }

  void listen() {
    using tcp = boost::asio::ip::tcp;
    const std::string where = options.address + ":" + std::to_string(options.port);
    try {
      const tcp::endpoint endpoint(boost::asio::ip::make_address(options.address),
                                   static_cast<std::uint16_t>(options.port));
      acceptor.open(endpoint.protocol());
      acceptor.set_option(tcp::acceptor::reuse_address(true));
      acceptor.bind(endpoint);
      acceptor.listen();
    } catch (const boost::system::system_error& error) {
      throw std::runtime_error("cannot listen on " + where + ": " + error.code().message() +
                               "; --listen ADDRESS and --port choose another place");
    }
  }

  void accept() {
    acceptor.async_accept(
        [this](boost::system::error_code error, boost::asio::ip::tcp::socket socket) {
          if (error == boost::asio::error::operation_aborted) return;
          if (!error) serve_http(*room, std::move(socket));
          accept();
        });
  }

  /// Messages are read from the sockets in batches: a wake-up for each of thousands costs more than
  /// their processing.
  void receive() {
    constexpr std::chrono::milliseconds kEvery{5};
    receive_timer.expires_after(kEvery);
    receive_timer.async_wait([this](boost::system::error_code error) {
      if (error) return;
      receive();  // first: the timer continues in any case
      content.advance(bus::wall_clock_us());
    });
  }

  void send_frames() {
    const auto period = std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(1 / options.rate));
    const auto now = std::chrono::steady_clock::now();
    next_frame = next_frame + period < now ? now : next_frame + period;
    frame_timer.expires_at(next_frame);
    frame_timer.async_wait([this](boost::system::error_code error) {
      if (error) return;
      send_frames();
      if (room->pages.empty())
        content.prepare(bus::wall_clock_us());
      else
        deliver_to_pages(*room);
    });
  }

  /// An error with one message or page must not affect the others.
  void serve() {
    while (!context.stopped()) {
      try {
        context.run();
      } catch (const std::exception& error) {
        std::fprintf(stderr, "error: %s\n", error.what());
      }
    }
  }

  Options options;
  Content& content;
  boost::asio::io_context context;
  boost::asio::ip::tcp::acceptor acceptor;
  boost::asio::steady_timer receive_timer, frame_timer;
  std::chrono::steady_clock::time_point next_frame = std::chrono::steady_clock::now();
  std::unique_ptr<Room> room;
};

Server::Server(const Options& options, const Assets& assets, Content& content, Content* guests)
    : impl_(std::make_unique<Impl>(options, assets, content, guests)) {}

Server::~Server() = default;

int Server::port() const { return impl_->acceptor.local_endpoint().port(); }

void Server::run() {
  impl_->accept();
  impl_->receive();
  impl_->send_frames();
  impl_->serve();
  timespec used{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
  impl_->room->counters.work =
      static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

void Server::stop() { impl_->context.stop(); }

const ServerCounters& Server::counters() const { return impl_->room->counters; }

}  // namespace palpate::serve
