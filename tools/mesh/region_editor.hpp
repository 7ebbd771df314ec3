#pragma once

#include <atomic>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/mesh/regions.hpp"
#include "tools/serve/access.hpp"
#include "tools/serve/server.hpp"

namespace palpate::mesh_tool {

struct RegionEditorOptions {
  std::string file;  // that is written
  int port = 8765;   // on 127.0.0.1; 0: any that is free
  std::string three = PALPATE_THREE_FOLDER;
};

/// Files of tools/mesh/region_page, by name: embedded at build time.
const serve::Assets::Files& region_page_files();

/// What the page paints: its requests change the regions, of which it gets the faces. Independent
/// of sockets, for one thread.
class RegionEditor : public serve::Content {
 public:
  /// `regions` must outlive the editor.
  RegionEditor(Regions& regions, std::string file, serve::Token token)
      : regions_(regions), file_(std::move(file)), token_(std::move(token)) {}

  std::string greeting(std::int64_t now_us) const override;
  serve::Delivery deliver(serve::Client& client, std::int64_t now_us) override;
  bool receive(const std::shared_ptr<serve::Client>& client, const std::string& text,
               std::int64_t now_us) override;

  /// Whether there are changes that are not in the file.
  bool is_changed() const { return is_changed_; }
  /// Whether a page has asked to end.
  bool is_finished() const { return is_finished_; }

 private:
  struct Step {
    Regions::Groups groups;  // before
    std::int64_t stroke;     // of the page; its steps are undone together
  };
  void grant(serve::Client& client, const std::string& token);
  void carry_out(const nlohmann::json& request);
  std::vector<int> selected(const nlohmann::json& request, RegionKind kind) const;
  void change(const nlohmann::json& request);
  void keep_step(Regions::Groups groups, std::int64_t stroke);
  void undo();
  void save();
  std::string mesh_parcel() const;
  std::string groups_parcel() const;

  Regions& regions_;
  std::string file_;
  serve::Token token_;
  std::vector<Step> steps_;
  std::int64_t revision_ = 1;
  bool is_changed_ = false;
  std::atomic<bool> is_finished_{false};
};

/// Serves the page on 127.0.0.1 until it ends by the page or by an interruption. Throws
/// std::runtime_error.
void edit_regions_in_browser(Regions& regions, const RegionEditorOptions& options);

}  // namespace palpate::mesh_tool
