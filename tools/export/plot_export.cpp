#include "tools/export/plot_export.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include "tools/common/plot.hpp"
#include "tools/export/columns.hpp"

namespace palpate::exporting {
namespace {

[[noreturn]] void fail(const std::string& text, const std::string& why) {
  throw std::runtime_error("'" + text + "': " + why +
                           "; allowed: CHANNEL.field, CHANNEL.field[2], CHANNEL.field[0][0:3], "
                           "norm(CHANNEL.field)");
}

int number(const std::string& digits, const std::string& text) {
  if (digits.empty() || digits.size() > 6 ||
      digits.find_first_not_of("0123456789") != std::string::npos)
    fail(text, "'" + digits + "' is no index");
  return std::stoi(digits);
}

constexpr int kPieces = 900;  // of time, each drawn by its minimum and maximum

/// A curve that keeps at most two points for each time interval, and is broken where more than
/// `silence` seconds pass without a message.
class Envelope {
 public:
  Envelope(double begin, double end, double silence)
      : begin_(begin), width_((end - begin) / kPieces), silence_(std::max(silence, 3 * width_)) {}

  void add(double time, double value) {
    if (!std::isfinite(value)) return;
    const int piece =
        width_ > 0 ? std::clamp(static_cast<int>((time - begin_) / width_), 0, kPieces - 1) : 0;
    auto& [least, greatest] =
        pieces_.try_emplace(piece, Point{time, value}, Point{time, value}).first->second;
    if (value < least.value) least = {time, value};
    if (value > greatest.value) greatest = {time, value};
    ++count_;
  }

  bool empty() const { return count_ == 0; }

  common::Curve curve(const std::string& title) const {
    common::Curve curve;
    curve.title = title;
    for (const auto& [number, pair] : pieces_) {
      const bool is_rising = pair.first.time <= pair.second.time;
      const Point& first = is_rising ? pair.first : pair.second;
      const Point& second = is_rising ? pair.second : pair.first;
      if (!curve.x.empty() && first.time - curve.x.back() > silence_) {
        curve.x.push_back(0.5 * (first.time + curve.x.back()));
        curve.y.push_back(std::numeric_limits<double>::quiet_NaN());
      }
      curve.x.push_back(first.time);
      curve.y.push_back(first.value);
      if (first.time == second.time) continue;
      curve.x.push_back(second.time);
      curve.y.push_back(second.value);
    }
    return curve;
  }

 private:
  struct Point {
    double time = 0, value = 0;
  };
  double begin_, width_, silence_;
  std::map<int, std::pair<Point, Point>> pieces_;
  std::int64_t count_ = 0;
};

/// The numbers that one path selects in one channel.
struct Selected {
  std::string channel;
  const log::TypeInfo* type = nullptr;
  int field = 0;
  std::vector<int> indices;
  const types::Struct* foreign = nullptr;                   // in place of type, field and indices
  std::map<std::vector<std::int64_t>, std::size_t> places;  // of its numbers: their curves
  bool is_norm = false;
  std::string title, unit;
  std::vector<std::string> titles;
  std::vector<Envelope> curves;
};

const ChannelSurvey& channel_of(const Survey& survey, const FieldPath& path) {
  std::string names;
  for (const ChannelSurvey& channel : survey.channels) {
    if (!channel.type) continue;
    if (channel.channel == path.channel) return channel;
    names += (names.empty() ? "" : ", ") + channel.channel;
  }
  throw std::runtime_error("no channel '" + path.channel + "' in the log; it has: " + names);
}

int field_of(const log::TypeInfo& type, const FieldPath& path) {
  const int field = type.field(path.field);
  std::string names;
  for (const log::FieldInfo& info : type.fields)
    if (!info.is_bytes()) names += (names.empty() ? "" : ", ") + info.name;
  if (field < 0 || type.fields[static_cast<std::size_t>(field)].is_bytes())
    throw std::runtime_error(path.channel + " (" + type.name + ") has no numbers '" + path.field +
                             "'; it has: " + names);
  return field;
}

/// Indices into all numbers of the field, of which `width` are in use at most.
std::vector<int> indices_of(const log::FieldInfo& field, const FieldPath& path, int width) {
  const std::string name = path.channel + "." + path.field;
  if (path.ranges.size() > field.sizes.size())
    throw std::runtime_error(name + " has " + std::to_string(field.sizes.size()) + " dimensions");
  std::vector<int> indices{0};
  for (std::size_t d = 0; d < field.sizes.size(); ++d) {
    const int size = d == 0 ? width / field.row_size() : field.sizes[d];
    auto [first, last] = d < path.ranges.size() ? path.ranges[d] : std::pair<int, int>{0, size};
    if (last > size)
      throw std::runtime_error(name + ": index " + std::to_string(last - 1) +
                               " is not in use in this log; allowed: 0 to " +
                               std::to_string(size - 1));
    std::vector<int> deeper;
    for (const int index : indices)
      for (int i = first; i < last; ++i) deeper.push_back(index * size + i);
    indices = deeper;
  }
  return indices;
}

constexpr std::size_t kMostCurves = 64;

[[noreturn]] void fail_of_curves(const std::string& text, std::size_t count,
                                 const std::string& field) {
  throw std::runtime_error(text + " are " + std::to_string(count) +
                           " curves; at most 64 can be distinguished: name a range, as " + field +
                           "[0:6]");
}

/// s without messages, after which a curve is broken.
double silence_of(const ChannelSurvey& channel, double begin, double end) {
  constexpr double kSilence = 10;  // times the mean interval between two messages
  return kSilence * (end - begin) / static_cast<double>(channel.messages);
}

/// The channel of another type that a path begins with; nullptr if there is none.
const ChannelSurvey* foreign_channel_of(const Survey& survey, const std::string& path) {
  for (const ChannelSurvey& channel : survey.channels)
    if (channel.foreign != nullptr && path.rfind(channel.channel + ".", 0) == 0) return &channel;
  return nullptr;
}

Selected select_foreign(const ChannelSurvey& channel, const std::string& text,
                        const std::string& path, bool is_norm, double begin, double end) {
  Selected selected;
  selected.channel = channel.channel;
  selected.foreign = channel.foreign;
  selected.is_norm = is_norm;
  const std::string field = path.substr(channel.channel.size() + 1);
  for (const auto& key : channel.foreign_columns.select(field)) {
    selected.places.emplace(key, is_norm ? 0 : selected.titles.size());
    if (!is_norm)
      selected.titles.push_back(channel.channel + "." +
                                channel.foreign_columns.columns().at(key).path);
  }
  if (selected.places.empty())
    throw std::runtime_error("'" + text + "': no number of " + channel.type_name() + " on " +
                             channel.channel + " has this name; palpate-export info --fields " +
                             "lists them");
  if (is_norm) selected.titles = {text};
  if (selected.titles.size() > kMostCurves) fail_of_curves(text, selected.titles.size(), path);
  selected.curves.assign(selected.titles.size(),
                         Envelope(begin, end, silence_of(channel, begin, end)));
  return selected;
}

Selected select(const Survey& survey, const std::string& text, double begin, double end) {
  const bool is_norm = text.rfind("norm(", 0) == 0 && text.back() == ')';
  const std::string inner = is_norm ? text.substr(5, text.size() - 6) : text;
  if (const ChannelSurvey* channel = foreign_channel_of(survey, inner))
    return select_foreign(*channel, text, inner, is_norm, begin, end);
  const FieldPath path = parse_field_path(text);
  const ChannelSurvey& channel = channel_of(survey, path);
  Selected selected;
  selected.channel = channel.channel;
  selected.type = channel.type;
  selected.field = field_of(*channel.type, path);
  const log::FieldInfo& field = channel.type->fields[static_cast<std::size_t>(selected.field)];
  selected.indices =
      indices_of(field, path, channel.widths[static_cast<std::size_t>(selected.field)]);
  if (selected.indices.empty()) throw std::runtime_error(text + ": holds no number in this log");
  selected.is_norm = path.is_norm;
  selected.unit = unit_text(field, selected.indices.front());
  if (path.is_norm) {
    selected.titles = {text};
  } else {
    if (selected.indices.size() > kMostCurves)
      fail_of_curves(text, selected.indices.size(), path.channel + "." + path.field);
    for (const int index : selected.indices)
      selected.titles.push_back(path.channel + "." + element_name(field, index));
    for (const int index : selected.indices)
      if (unit_text(field, index) != selected.unit) selected.unit += ", " + unit_text(field, index);
  }
  selected.curves.assign(selected.titles.size(),
                         Envelope(begin, end, silence_of(channel, begin, end)));
  return selected;
}

void take(Selected& selected, const Message& message) {
  if (selected.channel != message.event.channel || selected.type != &message.record.type()) return;
  const int used = message.record.used(selected.field);
  double square = 0;
  for (std::size_t i = 0; i < selected.indices.size(); ++i) {
    const int index = selected.indices[i];
    if (index >= used) {
      if (selected.is_norm) return;
      continue;
    }
    const double value = message.record.number(selected.field, index);
    square += value * value;
    if (!selected.is_norm) selected.curves[i].add(message.time, value);
  }
  if (selected.is_norm) selected.curves.front().add(message.time, std::sqrt(square));
}

void take(Selected& selected, const ForeignMessage& message) {
  if (selected.channel != message.event.channel || selected.foreign != &message.type) return;
  double square = 0;
  std::size_t count = 0;
  types::each_leaf(message.type, message.event.data, message.event.size,
                   [&](const types::Leaf& leaf) {
                     const auto place = selected.places.find(leaf.key());
                     if (place == selected.places.end()) return;
                     ++count;
                     square += leaf.number() * leaf.number();
                     if (!selected.is_norm)
                       selected.curves[place->second].add(message.time, leaf.number());
                   });
  if (selected.is_norm && count == selected.places.size())
    selected.curves.front().add(message.time, std::sqrt(square));
}

/// Paths of one panel; commas inside brackets do not separate them.
std::vector<std::string> paths_of(const std::string& panel) {
  std::vector<std::string> paths{""};
  int depth = 0;
  for (const char c : panel) {
    if (c == '(' || c == '[') ++depth;
    if (c == ')' || c == ']') --depth;
    if (c == ',' && depth == 0)
      paths.emplace_back();
    else if (c != ' ')
      paths.back() += c;
  }
  return paths;
}

/// Without the channel if that is unambiguous.
void shorten(std::vector<common::Curve>& curves) {
  std::map<std::string, int> short_names;
  const auto without_channel = [](const std::string& title) {
    return title.rfind("norm(", 0) == 0 ? title : title.substr(title.rfind('.') + 1);
  };
  for (const common::Curve& curve : curves) ++short_names[without_channel(curve.title)];
  if (short_names.size() < curves.size()) return;
  for (common::Curve& curve : curves) curve.title = without_channel(curve.title);
}

common::Plot plot_of(const std::vector<Selected>& panel, const std::string& title) {
  common::Plot plot;
  plot.title = title;
  plot.x_label = "time, s";
  std::vector<std::string> units;
  for (const Selected& selected : panel) {
    if (std::find(units.begin(), units.end(), selected.unit) == units.end())
      units.push_back(selected.unit);
    for (std::size_t i = 0; i < selected.curves.size(); ++i)
      if (!selected.curves[i].empty())
        plot.curves.push_back(selected.curves[i].curve(selected.titles[i]));
  }
  for (const std::string& unit : units)
    if (!unit.empty()) plot.y_label += (plot.y_label.empty() ? "" : "; ") + unit;
  if (plot.curves.empty()) throw std::runtime_error(title + ": nothing lies in these times");
  shorten(plot.curves);
  return plot;
}

}  // namespace

FieldPath parse_field_path(const std::string& text) {
  FieldPath path;
  std::string rest = text;
  if (rest.rfind("norm(", 0) == 0) {
    if (rest.back() != ')') fail(text, "the bracket of norm( is not closed");
    path.is_norm = true;
    rest = rest.substr(5, rest.size() - 6);
  }
  const std::size_t bracket = rest.find('[');
  const std::string name = rest.substr(0, bracket);
  const std::size_t dot = name.rfind('.');
  if (dot == std::string::npos || dot == 0 || dot + 1 == name.size())
    fail(text, "is no CHANNEL.field");
  path.channel = name.substr(0, dot);
  path.field = name.substr(dot + 1);
  for (std::size_t at = bracket; at != std::string::npos && at < rest.size();) {
    const std::size_t end = rest.find(']', at);
    if (rest[at] != '[' || end == std::string::npos) fail(text, "brackets do not match");
    const std::string inside = rest.substr(at + 1, end - at - 1);
    const std::size_t colon = inside.find(':');
    const int first = number(inside.substr(0, colon), text);
    const int last =
        colon == std::string::npos ? first + 1 : number(inside.substr(colon + 1), text);
    if (last <= first) fail(text, "the range [" + inside + "] is empty");
    path.ranges.emplace_back(first, last);
    at = end + 1;
  }
  return path;
}

int export_plot(Source& source, const std::vector<std::string>& panels,
                const std::filesystem::path& picture) {
  if (picture.extension() != ".png" && picture.extension() != ".svg")
    throw std::runtime_error(picture.string() + ": the name of a plot must end in .png or .svg");
  const Survey& survey = source.found();
  const TimeSpan& span = source.options().clock == Clock::kReceived ? survey.received : survey.sent;
  const double begin = std::max(0.0, source.options().from);
  const double end = std::min(source.time(span.last), source.options().to);

  std::vector<std::vector<Selected>> selected;
  for (const std::string& panel : panels) {
    selected.emplace_back();
    for (const std::string& path : paths_of(panel))
      selected.back().push_back(select(survey, path, begin, end));
  }
  const auto take_all = [&selected](const auto& message) {
    for (std::vector<Selected>& panel : selected)
      for (Selected& one : panel) take(one, message);
  };
  source.each("reading", take_all, take_all);
  std::vector<common::Plot> plots;
  int count = 0;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    plots.push_back(plot_of(selected[i], panels[i]));
    count += static_cast<int>(plots.back().curves.size());
  }
  if (picture.has_parent_path()) std::filesystem::create_directories(picture.parent_path());
  common::draw(plots, picture);
  return count;
}

}  // namespace palpate::exporting
