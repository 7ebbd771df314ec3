#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tools/serve/access.hpp"
#include "tools/serve/content.hpp"

namespace palpate::serve {

struct Asset {
  std::string type;  // MIME
  std::string body;
};

/// Files that the server delivers: a fixed list of names, read at the start, so that no request can
/// name any other file.
class Assets {
 public:
  using Files = std::map<std::string, std::string>;

  /// A page, `index.html` and others, with the scripts and styles that all pages share, which are
  /// embedded in the program, and three.js from the folder `three` of Debian's libjs-three. Throws
  /// std::runtime_error with the remedy if that is missing.
  Assets(const Files& page, const std::string& three);

  /// nullptr if there is none; "/" is the page.
  const Asset* find(std::string_view path) const;
  const std::map<std::string, Asset, std::less<>>& all() const { return assets_; }

 private:
  std::map<std::string, Asset, std::less<>> assets_;
};

/// Files of tools/serve/page, by name: embedded at build time.
const Assets::Files& shared_page_files();

/// Statistics of the server.
struct ServerCounters {
  std::int64_t requests = 0;        // of HTTP
  std::int64_t refused = 0;         // for their Host or Origin
  std::int64_t frames = 0;          // sent to pages
  std::int64_t frames_skipped = 0;  // because a page had not drawn the ones before
  std::int64_t bytes = 0;           // of parcels
  double work = 0;                  // s of processor time of the serving thread
};

/// HTTP for the page and WebSockets for its data and for guests, in one thread. A slow page gets
/// fewer frames, never old ones: the next is made when it has drawn all but one of those before.
class Server {
 public:
  struct Options {
    std::string address = "127.0.0.1";
    int port = 8765;                 // 0: any free port
    std::vector<std::string> names;  // names of the host in addition to its address
    double rate = 30;                // frames per second, at most
    /// Origins of pages of others that may read what `guests` delivers, as
    /// https://app.foxglove.dev; programs that are not pages name no origin and always may.
    std::vector<std::string> guest_origins;
  };
  /// Listens from here on. `guests`: content for clients that ask for its subprotocol; nullptr:
  /// these are refused. Throws std::runtime_error with the remedy on failure.
  Server(const Options& options, const Assets& assets, Content& content, Content* guests = nullptr);
  ~Server();

  int port() const;
  /// Serves until stop(). `assets` and both contents must outlive it.
  void run();
  /// May be called from a signal handler's thread or any other.
  void stop();
  const ServerCounters& counters() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::serve
