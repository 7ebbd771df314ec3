#include "tools/mesh/region_editor.hpp"

#include <cmath>
#include <cstdio>
#include <iostream>
#include <stdexcept>
#include <thread>

#include "core/mesh/report.hpp"
#include "tools/common/interruption.hpp"
#include "tools/serve/parcel.hpp"

namespace palpate::mesh_tool {
namespace {

constexpr std::size_t kMostSteps = 200;  // that can be undone
constexpr double kFarthest = 1e3;        // m

double number_of(const nlohmann::json& request, const char* key, double lower, double upper) {
  const auto found = request.find(key);
  const double x =
      found != request.end() && found->is_number() ? found->get<double>() : std::nan("");
  if (!(x >= lower && x <= upper))
    throw std::invalid_argument(std::string(key) + ": must be a number from " +
                                std::to_string(lower) + " to " + std::to_string(upper));
  return x;
}

std::string text_of(const nlohmann::json& request, const char* key) {
  const auto found = request.find(key);
  if (found == request.end() || !found->is_string())
    throw std::invalid_argument(std::string(key) + ": must be a text");
  return found->get<std::string>();
}

template <int Size>
Eigen::Matrix<double, Size, 1> numbers_of(const nlohmann::json& request, const char* key,
                                          double most) {
  const auto found = request.find(key);
  Eigen::Matrix<double, Size, 1> values;
  bool is_good = found != request.end() && found->is_array() && found->size() == Size;
  for (int i = 0; is_good && i < Size; ++i) {
    values[i] = (*found)[i].is_number() ? (*found)[i].get<double>() : std::nan("");
    is_good = std::abs(values[i]) <= most;
  }
  if (!is_good)
    throw std::invalid_argument(std::string(key) + ": must be " + std::to_string(Size) +
                                " numbers");
  return values;
}

RegionEdit edit_of(const std::string& name) {
  if (name == "replace") return RegionEdit::kReplace;
  if (name == "add") return RegionEdit::kAdd;
  if (name == "remove") return RegionEdit::kRemove;
  throw std::invalid_argument("edit: must be replace, add or remove");
}

RegionKind kind_named(const std::string& name) {
  if (name == "faces") return RegionKind::kFaces;
  if (name == "elements") return RegionKind::kElements;
  throw std::invalid_argument("of: must be faces or elements");
}

double angle_of(const nlohmann::json& request) {
  return number_of(request, "angle", 0, 180) * EIGEN_PI / 180;
}

template <class Number, class Matrix>
std::vector<Number> flat(const Matrix& matrix) {
  std::vector<Number> values;
  for (const auto value : matrix.reshaped()) values.push_back(static_cast<Number>(value));
  return values;
}

}  // namespace

std::string RegionEditor::greeting(std::int64_t /*now_us*/) const {
  return serve::dump({{"type", "hello"}, {"file", file_}});
}

serve::Delivery RegionEditor::deliver(serve::Client& client, std::int64_t /*now_us*/) {
  serve::Delivery delivery;
  if (client.generation == revision_) return delivery;
  const auto add = [&delivery](std::string parcel) {
    delivery.parcels.push_back(std::make_shared<const std::string>(std::move(parcel)));
  };
  if (client.generation == 0) add(mesh_parcel());
  add(groups_parcel());
  client.generation = revision_;
  return delivery;
}

std::string RegionEditor::mesh_parcel() const {
  const mesh::TetrahedralMesh& mesh = regions_.mesh().mesh;
  const auto rest = flat<float>(mesh.nodes);
  const auto triangles = flat<std::int32_t>(regions_.faces());
  const std::vector<std::int32_t> none;
  serve::Parcel parcel({{"type", "mesh"}, {"hash", serve::hash_text(mesh::hash(mesh))}});
  parcel.add("rest", rest);
  parcel.add("triangles", triangles);
  parcel.add("constrained", none);
  parcel.add("middles", none);
  return parcel.finish();
}

std::string RegionEditor::groups_parcel() const {
  const auto colours = region_colours(regions_.groups());
  nlohmann::json groups = nlohmann::json::array();
  std::vector<std::vector<std::int32_t>> faces;
  for (const auto& [name, group] : regions_.groups()) {
    const RegionSize size = regions_.size(name);
    const Eigen::Vector3f& colour = colours.at(name);
    groups.push_back({{"name", name},
                      {"of", regions_.kind_of(name) == RegionKind::kFaces ? "faces" : "elements"},
                      {"colour", {colour[0], colour[1], colour[2]}},
                      {"nodes", size.nodes},
                      {"faces", size.faces},
                      {"elements", size.elements},
                      {"area", size.area},
                      {"volume", size.volume}});
    faces.push_back(regions_.outer_faces(name));
  }
  serve::Parcel parcel({{"type", "groups"},
                        {"revision", revision_},
                        {"groups", groups},
                        {"conflict", regions_.conflict()},
                        {"changed", is_changed_},
                        {"steps", steps_.size()}});
  for (std::size_t i = 0; i < faces.size(); ++i) parcel.add("faces_" + std::to_string(i), faces[i]);
  return parcel.finish();
}

bool RegionEditor::receive(const std::shared_ptr<serve::Client>& client, const std::string& text,
                           std::int64_t /*now_us*/) {
  const nlohmann::json request = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  try {
    if (!request.is_object()) throw std::invalid_argument("not a JSON object");
    if (text_of(request, "type") == "control") {
      grant(*client, text_of(request, "token"));
      return client->wrong_tokens < serve::kMostWrongTokens;
    }
    if (!client->may_control)
      throw std::invalid_argument("changes need the token that palpate-mesh printed");
    carry_out(request);
  } catch (const std::exception& error) {
    client->send_text(serve::dump({{"type", "error"}, {"reason", error.what()}}));
  }
  return true;
}

void RegionEditor::grant(serve::Client& client, const std::string& token) {
  client.may_control = token_.is(token);
  if (!client.may_control) ++client.wrong_tokens;
  client.send_text(serve::dump({{"type", "control"},
                                {"granted", client.may_control},
                                {"reason", client.may_control ? "" : "wrong token"}}));
}

void RegionEditor::carry_out(const nlohmann::json& request) {
  const std::string type = text_of(request, "type");
  if (type == "select") return change(request);
  if (type == "undo") return undo();
  if (type == "save") return save();
  if (type == "finish") {
    save();
    is_finished_ = true;
    return;
  }
  if (type != "delete")
    throw std::invalid_argument("type: must be control, select, delete, undo, save or finish");
  Regions::Groups before = regions_.groups();
  regions_.erase(text_of(request, "group"));
  keep_step(std::move(before), 0);
}

/// Of a request of type "select": what its entry "by" describes.
std::vector<int> RegionEditor::selected(const nlohmann::json& request, RegionKind kind) const {
  const RegionSelection& selection = regions_.selection();
  const std::string by = text_of(request, "by");
  const auto face = [&request] { return static_cast<int>(number_of(request, "face", 0, 1e9)); };
  const auto of = [&](const std::vector<int>& faces) {
    return kind == RegionKind::kFaces ? faces : selection.elements_at(faces);
  };
  if (by == "brush") {
    const Space ball = ball_space(numbers_of<3>(request, "at", kFarthest),
                                  number_of(request, "radius", 1e-6, kFarthest));
    if (kind == RegionKind::kFaces) return selection.connected(face(), angle_of(request), ball);
    std::vector<int> elements = selection.inside(kind, ball);
    return elements.empty() ? selection.elements_at({face()}) : elements;
  }
  if (by == "connected") return of(selection.connected(face(), angle_of(request)));
  if (by == "box")
    return selection.inside(kind, box_space(numbers_of<3>(request, "lower", kFarthest),
                                            numbers_of<3>(request, "upper", kFarthest)));
  if (by == "rectangle") {
    const auto columns = numbers_of<16>(request, "clip_from_object", 1e12);
    return selection.seen(kind, Eigen::Map<const Eigen::Matrix4d>(columns.data()),
                          numbers_of<2>(request, "lower", 1e3),
                          numbers_of<2>(request, "upper", 1e3));
  }
  if (by == "all") return selection.all(kind);
  throw std::invalid_argument("by: must be brush, connected, box, rectangle or all");
}

void RegionEditor::change(const nlohmann::json& request) {
  const RegionKind kind = kind_named(text_of(request, "of"));
  const auto stroke = static_cast<std::int64_t>(number_of(request, "stroke", 0, 1e15));
  const std::vector<int> members = selected(request, kind);
  Regions::Groups before = regions_.groups();
  regions_.edit(text_of(request, "group"), kind, edit_of(text_of(request, "edit")), members);
  keep_step(std::move(before), stroke);
}

/// `stroke`: 0 for a step of its own.
void RegionEditor::keep_step(Regions::Groups groups, std::int64_t stroke) {
  if (stroke == 0 || steps_.empty() || steps_.back().stroke != stroke)
    steps_.push_back({std::move(groups), stroke});
  if (steps_.size() > kMostSteps) steps_.erase(steps_.begin());
  is_changed_ = true;
  ++revision_;
}

void RegionEditor::undo() {
  if (steps_.empty()) throw std::invalid_argument("there is nothing to undo");
  regions_.set_groups(std::move(steps_.back().groups));
  steps_.pop_back();
  is_changed_ = true;
  ++revision_;
}

void RegionEditor::save() {
  if (const std::string conflict = regions_.conflict(); !conflict.empty())
    throw std::invalid_argument(conflict + "; nothing is written");
  write_regions(regions_, file_);
  is_changed_ = false;
  ++revision_;
  std::cout << file_ << ": written; in a configuration of palpated:\n"
            << regions_.configuration(file_) << std::endl;
}

void edit_regions_in_browser(Regions& regions, const RegionEditorOptions& options) {
  check_region_file(options.file);
  const serve::Assets assets(region_page_files(), options.three);
  const serve::Token token;
  RegionEditor editor(regions, options.file, token);
  serve::Server::Options server_options;
  server_options.port = options.port;
  serve::Server server(server_options, assets, editor);
  std::cout << "http://127.0.0.1:" << server.port() << "/#token=" << token.text()
            << "\nAnyone with this address can change " << options.file
            << ". Ctrl-C, or Finish on the page, ends." << std::endl;
  std::thread serving([&server] { server.run(); });
  while (!common::is_interrupted() && !editor.is_finished())
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  // The page receives its last messages.
  if (editor.is_finished()) std::this_thread::sleep_for(std::chrono::milliseconds(200));
  server.stop();
  serving.join();
  if (editor.is_changed()) std::cerr << "changes since the last save are not written\n";
}

}  // namespace palpate::mesh_tool
