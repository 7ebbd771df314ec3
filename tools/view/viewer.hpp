#pragma once

#include <array>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "rt/client/client.hpp"
#include "tools/serve/access.hpp"
#include "tools/serve/server.hpp"
#include "tools/view/cell.hpp"
#include "tools/view/encode.hpp"
#include "tools/view/history.hpp"
#include "tools/view/live_source.hpp"
#include "tools/view/log_source.hpp"
#include "tools/view/request.hpp"
#include "tools/view/shape_error.hpp"

namespace palpate::view {

/// Files of tools/view/page, by name: embedded at build time.
const serve::Assets::Files& page_files();

/// A connected page, as the viewer knows it.
struct ViewerClient : serve::Client {
  Field field = Field::kDisplacement;
  std::int64_t mesh = 0, truth_mesh = 0;  // hashes of the meshes that it has, 0: none
  bool has_obstacles = false;             // their shapes
  std::int64_t events = 0;                // number of its last event
  std::int64_t health = -1;               // number of HEALTH messages that it has
  std::int64_t messages = 0;              // number of its table of messages
};

/// Holds the data to be shown, and turns it into messages for pages and their requests into
/// commands.
class Viewer : public serve::Content {
 public:
  struct Options {
    bool control = false;  // whether a page with the token may give commands
    double max_force = 5;  // N, of a manual force
    double rate = 1;       // of a log, at the start
    Cell cell;
  };
  Viewer(Options options, serve::Token token);

  /// Messages of these types are shown as a table.
  void describe(types::TypeSet types) { scene_.describe(std::move(types)); }

  // One of the two.
  void show_live(std::unique_ptr<LiveSource> source);
  void show_log(std::unique_ptr<LogSource> source);
  /// Live and with `control`: the destination of commands.
  void command_by(std::unique_ptr<client::Client> daemon) { daemon_ = std::move(daemon); }

  std::shared_ptr<serve::Client> make_client() const override {
    return std::make_shared<ViewerClient>();
  }
  void advance(std::int64_t now_us) override;
  void prepare(std::int64_t now_us) override;
  std::string greeting(std::int64_t now_us) const override;
  serve::Delivery deliver(serve::Client& client, std::int64_t now_us) override;
  bool receive(const std::shared_ptr<serve::Client>& client, const std::string& text,
               std::int64_t now_us) override;

  const Scene& scene() const { return scene_; }
  const serve::Token& token() const { return token_; }

 private:
  struct Painted {
    std::int64_t hash = 0;
    std::unique_ptr<FieldEvaluator> evaluator;
    std::set<Field> done;  // of the present shape
    std::array<std::vector<float>, 4> values;
  };

  void repaint(Painted& painted, const shape_t* shape);
  const std::vector<float>* paint(Painted& painted, const shape_t& shape, Field field);
  void add_meshes(ViewerClient& client, serve::Delivery& delivery) const;
  void add_obstacles(ViewerClient& client, serve::Delivery& delivery) const;
  std::int64_t log_time_us() const;
  void list_messages(std::int64_t now_us);
  std::string frame(Field field, bool with_health, std::int64_t now_us);
  nlohmann::json state(bool with_health, std::int64_t now_us) const;
  void grant(serve::Client& client, const TakeControl& request);
  bool carry_out(const std::shared_ptr<serve::Client>& client, const Request& request,
                 std::int64_t now_us);
  client::Client::OnAnswer answer_to(const std::shared_ptr<serve::Client>& client,
                                     std::int64_t id) const;
  void play(const Play& request);

  Options options_;
  serve::Token token_;
  Scene scene_;
  History history_;
  std::unique_ptr<LiveSource> live_;
  std::unique_ptr<LogSource> log_;
  std::unique_ptr<client::Client> daemon_;
  Painted estimate_, truth_;
  ShapeError shape_error_;
  std::int64_t painted_count_ = -1, painted_truth_count_ = -1;
  std::int64_t frames_ = 0;  // prepared
  /// The table of messages of described types: as JSON, its number, and when it was made.
  std::string messages_;
  std::int64_t messages_number_ = 0, messages_us_ = 0;
  /// The present frame as the pages need it: with a field, with or without HEALTH.
  std::map<std::pair<Field, bool>, std::shared_ptr<const std::string>> parcels_;
  std::int64_t played_us_ = 0;  // wall clock of the last advance of a log
  bool playing_ = true;
  double rate_ = 1;
};

}  // namespace palpate::view
