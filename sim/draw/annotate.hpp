#pragma once

#include <string>
#include <vector>

#include "sim/draw/image.hpp"

namespace palpate::draw {

/// Width and height in px of a line of text in the built-in 5 x 7 font, `scale` px per dot.
int text_width(const std::string& text, int scale);
int text_height(int scale);

/// Writes text with its upper left corner at (x, y); what falls outside the picture is cut off.
void draw_text(Image& image, int x, int y, const std::string& text, const Colour& colour,
               int scale = 2);

/// Fills a rectangle, blended by the colour's alpha.
void draw_rectangle(Image& image, int x, int y, int width, int height, const Colour& colour);

/// A line of text on a light strip along the top.
void draw_title(Image& image, const std::string& text, int scale = 2);

struct LegendEntry {
  std::string label;
  Colour colour;
};

/// Colour patches with labels, lower left.
void draw_legend(Image& image, const std::vector<LegendEntry>& entries, int scale = 2);

/// Bar of colour_map with the values of its ends (printed with %.3g) and a caption, right side.
void draw_colour_bar(Image& image, double low, double high, const std::string& caption,
                     int scale = 2);

/// Perceptually even colours from dark blue (t = 0) over green to yellow (t = 1), after viridis.
Colour colour_map(double t);

}  // namespace palpate::draw
