#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sim/draw/annotate.hpp"
#include "sim/draw/image.hpp"
#include "tools/common/table.hpp"
#include "tools/mesh/quality.hpp"

namespace palpate::mesh_tool {
namespace {

using draw::Colour;

constexpr int kColumns = 2, kPanelWidth = 780, kPanelHeight = 330, kHistogramTitle = 34,
              kBins = 36;                                        // px
constexpr int kLeft = 70, kRight = 20, kTop = 44, kBottom = 44;  // px
const Colour kInk{0.15F, 0.18F, 0.22F, 1}, kBar{0.22F, 0.45F, 0.72F, 1},
    kGrid{0.86F, 0.88F, 0.91F, 1};

std::string tick(double value) { return common::formatted("%.3g", value); }

/// Bars of equal width between two ends, with the counts on the left.
void draw_one(draw::Image& image, int x, int y, const Distribution& d, double low, double high) {
  std::vector<int> counts(kBins, 0);
  for (const double value : d.values) {
    if (!std::isfinite(value)) continue;
    const double place = (value - low) / (high - low);
    ++counts[std::clamp(static_cast<int>(place * kBins), 0, kBins - 1)];
  }
  const int most = std::max(1, *std::max_element(counts.begin(), counts.end()));
  const int width = kPanelWidth - kLeft - kRight, height = kPanelHeight - kTop - kBottom;
  const int left = x + kLeft, base = y + kPanelHeight - kBottom;
  for (int line = 0; line <= 4; ++line) {
    const int at = base - height * line / 4;
    draw::draw_rectangle(image, left, at, width, 1, kGrid);
    const std::string label = tick(most * line / 4.0);
    draw::draw_text(image, left - 8 - draw::text_width(label, 2), at - 7, label, kInk);
  }
  for (int b = 0; b < kBins; ++b) {
    const int from = left + width * b / kBins, to = left + width * (b + 1) / kBins;
    int tall = static_cast<int>(std::lround(double(height) * counts[b] / most));
    if (counts[b] > 0) tall = std::max(tall, 2);  // a single bad element must be visible
    draw::draw_rectangle(image, from, base - tall, to - from - 1, tall, kBar);
  }
  draw::draw_rectangle(image, left, base, width, 2, kInk);
  for (int mark = 0; mark <= 4; ++mark) {
    const int at = left + width * mark / 4;
    draw::draw_rectangle(image, at, base, 2, 6, kInk);
    const std::string label = tick(low + (high - low) * mark / 4);
    const int half = draw::text_width(label, 2) / 2;
    draw::draw_text(image, std::min(at - half, x + kPanelWidth - 2 * half - 2), base + 12, label,
                    kInk);
  }
  draw::draw_text(
      image, left, y + 14,
      d.name + ": " + tick(d.least()) + " to " + tick(d.most()) + ", mean " + tick(d.mean()), kInk);
}

}  // namespace

void draw_histograms(const Quality& quality, const std::string& title,
                     const std::filesystem::path& png) {
  struct Wanted {
    const char* key;
    double low, high;  // equal: those of the values
  };
  constexpr Wanted kWanted[] = {
      {"radius_ratio", 0, 1},         {"scaled_jacobian", 0, 1}, {"smallest_angle_deg", 0, 72},
      {"largest_angle_deg", 60, 180}, {"edge_m", 0, 0},          {"relative_stiffness", 1, 1}};
  const int rows = (static_cast<int>(std::size(kWanted)) + kColumns - 1) / kColumns;
  draw::Image image(kColumns * kPanelWidth, kHistogramTitle + rows * kPanelHeight);
  std::fill(image.rgb.begin(), image.rgb.end(), std::uint8_t{255});
  for (int i = 0; i < static_cast<int>(std::size(kWanted)); ++i) {
    const Distribution& d = quality.of(kWanted[i].key);
    double low = kWanted[i].low, high = kWanted[i].high;
    if (!(high > low)) {
      high = low;
      for (const double value : d.values) {
        if (std::isfinite(value)) high = std::max(high, value);
      }
      if (!(high > low)) high = low + 1;
    }
    draw_one(image, (i % kColumns) * kPanelWidth, kHistogramTitle + (i / kColumns) * kPanelHeight,
             d, low, high);
  }
  draw::draw_title(image, title);
  draw::write_png(png.string(), image);
}

}  // namespace palpate::mesh_tool
