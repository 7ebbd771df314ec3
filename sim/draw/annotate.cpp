#include "sim/draw/annotate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>

namespace palpate::draw {
namespace {

constexpr int kGlyphWidth = 5;
constexpr int kGlyphHeight = 7;

constexpr char kFirst = ' ';
constexpr int kCount = 95;

// clang-format off
constexpr std::array<std::array<std::uint8_t, kGlyphWidth>, kCount> kGlyphs{{
    {0x00, 0x00, 0x00, 0x00, 0x00},  /*   */ {0x00, 0x00, 0x5F, 0x00, 0x00},  /* ! */
    {0x00, 0x07, 0x00, 0x07, 0x00},  /* " */ {0x14, 0x7F, 0x14, 0x7F, 0x14},  /* # */
    {0x24, 0x2A, 0x7F, 0x2A, 0x12},  /* $ */ {0x23, 0x13, 0x08, 0x64, 0x62},  /* % */
    {0x36, 0x49, 0x56, 0x20, 0x50},  /* & */ {0x00, 0x00, 0x07, 0x00, 0x00},  /* ' */
    {0x00, 0x1C, 0x22, 0x41, 0x00},  /* ( */ {0x00, 0x41, 0x22, 0x1C, 0x00},  /* ) */
    {0x2A, 0x1C, 0x7F, 0x1C, 0x2A},  /* * */ {0x08, 0x08, 0x3E, 0x08, 0x08},  /* + */
    {0x00, 0x50, 0x30, 0x00, 0x00},  /* , */ {0x08, 0x08, 0x08, 0x08, 0x08},  /* - */
    {0x00, 0x60, 0x60, 0x00, 0x00},  /* . */ {0x20, 0x10, 0x08, 0x04, 0x02},  /* / */
    {0x3E, 0x51, 0x49, 0x45, 0x3E},  /* 0 */ {0x00, 0x42, 0x7F, 0x40, 0x00},  /* 1 */
    {0x42, 0x61, 0x51, 0x49, 0x46},  /* 2 */ {0x21, 0x41, 0x45, 0x4B, 0x31},  /* 3 */
    {0x18, 0x14, 0x12, 0x7F, 0x10},  /* 4 */ {0x27, 0x45, 0x45, 0x45, 0x39},  /* 5 */
    {0x3C, 0x4A, 0x49, 0x49, 0x30},  /* 6 */ {0x01, 0x71, 0x09, 0x05, 0x03},  /* 7 */
    {0x36, 0x49, 0x49, 0x49, 0x36},  /* 8 */ {0x06, 0x49, 0x49, 0x29, 0x1E},  /* 9 */
    {0x00, 0x36, 0x36, 0x00, 0x00},  /* : */ {0x00, 0x56, 0x36, 0x00, 0x00},  /* ; */
    {0x08, 0x14, 0x22, 0x41, 0x00},  /* < */ {0x14, 0x14, 0x14, 0x14, 0x14},  /* = */
    {0x00, 0x41, 0x22, 0x14, 0x08},  /* > */ {0x02, 0x01, 0x51, 0x09, 0x06},  /* ? */
    {0x3E, 0x41, 0x5D, 0x55, 0x1E},  /* @ */ {0x7E, 0x11, 0x11, 0x11, 0x7E},  /* A */
    {0x7F, 0x49, 0x49, 0x49, 0x36},  /* B */ {0x3E, 0x41, 0x41, 0x41, 0x22},  /* C */
    {0x7F, 0x41, 0x41, 0x41, 0x3E},  /* D */ {0x7F, 0x49, 0x49, 0x49, 0x41},  /* E */
    {0x7F, 0x09, 0x09, 0x09, 0x01},  /* F */ {0x3E, 0x41, 0x49, 0x49, 0x7A},  /* G */
    {0x7F, 0x08, 0x08, 0x08, 0x7F},  /* H */ {0x00, 0x41, 0x7F, 0x41, 0x00},  /* I */
    {0x20, 0x40, 0x41, 0x3F, 0x01},  /* J */ {0x7F, 0x08, 0x14, 0x22, 0x41},  /* K */
    {0x7F, 0x40, 0x40, 0x40, 0x40},  /* L */ {0x7F, 0x02, 0x0C, 0x02, 0x7F},  /* M */
    {0x7F, 0x04, 0x08, 0x10, 0x7F},  /* N */ {0x3E, 0x41, 0x41, 0x41, 0x3E},  /* O */
    {0x7F, 0x09, 0x09, 0x09, 0x06},  /* P */ {0x3E, 0x41, 0x51, 0x21, 0x5E},  /* Q */
    {0x7F, 0x09, 0x19, 0x29, 0x46},  /* R */ {0x46, 0x49, 0x49, 0x49, 0x31},  /* S */
    {0x01, 0x01, 0x7F, 0x01, 0x01},  /* T */ {0x3F, 0x40, 0x40, 0x40, 0x3F},  /* U */
    {0x1F, 0x20, 0x40, 0x20, 0x1F},  /* V */ {0x3F, 0x40, 0x38, 0x40, 0x3F},  /* W */
    {0x63, 0x14, 0x08, 0x14, 0x63},  /* X */ {0x07, 0x08, 0x70, 0x08, 0x07},  /* Y */
    {0x61, 0x51, 0x49, 0x45, 0x43},  /* Z */ {0x00, 0x7F, 0x41, 0x41, 0x00},  /* [ */
    {0x02, 0x04, 0x08, 0x10, 0x20},  /* \ */ {0x00, 0x41, 0x41, 0x7F, 0x00},  /* ] */
    {0x04, 0x02, 0x01, 0x02, 0x04},  /* ^ */ {0x40, 0x40, 0x40, 0x40, 0x40},  /* _ */
    {0x00, 0x01, 0x02, 0x04, 0x00},  /* ` */ {0x20, 0x54, 0x54, 0x54, 0x78},  /* a */
    {0x7F, 0x48, 0x44, 0x44, 0x38},  /* b */ {0x38, 0x44, 0x44, 0x44, 0x28},  /* c */
    {0x38, 0x44, 0x44, 0x48, 0x7F},  /* d */ {0x38, 0x54, 0x54, 0x54, 0x18},  /* e */
    {0x08, 0x7E, 0x09, 0x01, 0x02},  /* f */ {0x0C, 0x52, 0x52, 0x52, 0x3E},  /* g */
    {0x7F, 0x08, 0x04, 0x04, 0x78},  /* h */ {0x00, 0x44, 0x7D, 0x40, 0x00},  /* i */
    {0x20, 0x40, 0x44, 0x3D, 0x00},  /* j */ {0x7F, 0x10, 0x28, 0x44, 0x00},  /* k */
    {0x00, 0x41, 0x7F, 0x40, 0x00},  /* l */ {0x7C, 0x04, 0x18, 0x04, 0x78},  /* m */
    {0x7C, 0x08, 0x04, 0x04, 0x78},  /* n */ {0x38, 0x44, 0x44, 0x44, 0x38},  /* o */
    {0x7C, 0x14, 0x14, 0x14, 0x08},  /* p */ {0x08, 0x14, 0x14, 0x18, 0x7C},  /* q */
    {0x7C, 0x08, 0x04, 0x04, 0x08},  /* r */ {0x48, 0x54, 0x54, 0x54, 0x24},  /* s */
    {0x04, 0x3F, 0x44, 0x40, 0x20},  /* t */ {0x3C, 0x40, 0x40, 0x20, 0x7C},  /* u */
    {0x1C, 0x20, 0x40, 0x20, 0x1C},  /* v */ {0x3C, 0x40, 0x30, 0x40, 0x3C},  /* w */
    {0x44, 0x28, 0x10, 0x28, 0x44},  /* x */ {0x0C, 0x50, 0x50, 0x50, 0x3C},  /* y */
    {0x44, 0x64, 0x54, 0x4C, 0x44},  /* z */ {0x00, 0x08, 0x36, 0x41, 0x00},  /* { */
    {0x00, 0x00, 0x7F, 0x00, 0x00},  /* | */ {0x00, 0x41, 0x36, 0x08, 0x00},  /* } */
    {0x08, 0x04, 0x08, 0x10, 0x08},  /* ~ */
}};
// clang-format on

/// Columns from the left of a printable ASCII character, bit 0 on top; '?' for any other.
const std::array<std::uint8_t, kGlyphWidth>& glyph(char character) {
  const int index = character - kFirst;
  return kGlyphs[index >= 0 && index < kCount ? index : '?' - kFirst];
}

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
