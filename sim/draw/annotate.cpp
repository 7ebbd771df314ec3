#include "sim/draw/annotate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "sim/draw/font.hpp"

namespace palpate::draw {
namespace {

constexpr Colour kInk{0.1F, 0.12F, 0.15F, 1};
constexpr Colour kPanel{1, 1, 1, 0.8F};

void blend(std::uint8_t* pixel, const Colour& colour) {
  const float over[3] = {colour.red, colour.green, colour.blue};
  for (int channel = 0; channel < 3; ++channel) {
    const float value = 255 * over[channel] * colour.alpha + pixel[channel] * (1 - colour.alpha);
    pixel[channel] = static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0F, 255.0F)));
  }
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

}  // namespace

int text_width(const std::string& text, int scale) {
  return text.empty() ? 0 : (static_cast<int>(text.size()) * (kGlyphWidth + 1) - 1) * scale;
}

int text_height(int scale) { return kGlyphHeight * scale; }

void draw_rectangle(Image& image, int x, int y, int width, int height, const Colour& colour) {
  for (int row = std::max(y, 0); row < std::min(y + height, image.height); ++row) {
    for (int column = std::max(x, 0); column < std::min(x + width, image.width); ++column) {
      blend(image.pixel(column, row), colour);
    }
  }
}

void draw_text(Image& image, int x, int y, const std::string& text, const Colour& colour,
               int scale) {
  for (const char character : text) {
    const auto& columns = glyph(character);
    for (int i = 0; i < kGlyphWidth; ++i) {
      for (int j = 0; j < kGlyphHeight; ++j) {
        if (columns[i] >> j & 1) {
          draw_rectangle(image, x + i * scale, y + j * scale, scale, scale, colour);
        }
      }
    }
    x += (kGlyphWidth + 1) * scale;
  }
}

void draw_title(Image& image, const std::string& text, int scale) {
  const int margin = 4 * scale;
  draw_rectangle(image, 0, 0, image.width, text_height(scale) + 2 * margin, kPanel);
  draw_text(image, margin, margin, text, kInk, scale);
}

void draw_legend(Image& image, const std::vector<LegendEntry>& entries, int scale) {
  if (entries.empty()) return;
  const int margin = 4 * scale;
  const int patch = text_height(scale);
  const int line = patch + 3 * scale;
  int widest = 0;
  for (const LegendEntry& entry : entries) {
    widest = std::max(widest, text_width(entry.label, scale));
  }
  const int width = 2 * patch + widest + 3 * margin;
  const int height = static_cast<int>(entries.size()) * line - 3 * scale + 2 * margin;
  const int left = margin;
  int y = image.height - margin - height;
  draw_rectangle(image, left, y, width, height, kPanel);
  y += margin;
  for (const LegendEntry& entry : entries) {
    draw_rectangle(image, left + margin, y, 2 * patch, patch, entry.colour);
    draw_text(image, left + 2 * margin + 2 * patch, y, entry.label, kInk, scale);
    y += line;
  }
}

void draw_colour_bar(Image& image, double low, double high, const std::string& caption, int scale) {
  const int margin = 4 * scale;
  const int text = text_height(scale);
  const int bar_width = 8 * scale;
  const int bar_height = image.height / 2;
  const std::array<std::string, 3> labels{number(high), number(0.5 * (low + high)), number(low)};
  int widest = text_width(caption, scale) - bar_width - scale;
  for (const std::string& label : labels) widest = std::max(widest, text_width(label, scale));
  const int width = bar_width + scale + widest + 3 * margin;
  const int height = bar_height + text + 3 * margin;
  const int left = image.width - margin - width;
  const int top = (image.height - height) / 2;
  draw_rectangle(image, left, top, width, height, kPanel);
  draw_text(image, left + margin, top + margin, caption, kInk, scale);
  const int bar_top = top + text + 2 * margin;
  for (int i = 0; i < bar_height; ++i) {
    const double t = 1 - static_cast<double>(i) / std::max(1, bar_height - 1);
    draw_rectangle(image, left + margin, bar_top + i, bar_width, 1, colour_map(t));
  }
  for (int i = 0; i < 3; ++i) {
    const int y = bar_top + i * (bar_height - text) / 2;
    draw_text(image, left + 2 * margin + bar_width + scale, y, labels[i], kInk, scale);
  }
}

Colour colour_map(double t) {
  static constexpr std::array<std::array<double, 3>, 9> kAnchors{{{0.267, 0.005, 0.329},
                                                                  {0.279, 0.175, 0.483},
                                                                  {0.230, 0.322, 0.546},
                                                                  {0.173, 0.449, 0.558},
                                                                  {0.128, 0.567, 0.551},
                                                                  {0.158, 0.684, 0.502},
                                                                  {0.369, 0.789, 0.383},
                                                                  {0.678, 0.864, 0.190},
                                                                  {0.993, 0.906, 0.144}}};
  const double along = (t > 0 ? std::min(t, 1.0) : 0.0) * (kAnchors.size() - 1);
  const int below = std::min(static_cast<int>(along), static_cast<int>(kAnchors.size()) - 2);
  const double share = along - below;
  float mixed[3];
  for (int channel = 0; channel < 3; ++channel) {
    mixed[channel] = static_cast<float>((1 - share) * kAnchors[below][channel] +
                                        share * kAnchors[below + 1][channel]);
  }
  return {mixed[0], mixed[1], mixed[2], 1};
}

}  // namespace palpate::draw
