#pragma once

#include <string>
#include <vector>

#include "sim/draw/image.hpp"

namespace palpate::draw {

/// Width and height in px of a line of text in the built-in 5 x 7 font, `scale` px per dot.
int text_width(const std::string& text, int scale);
int text_height(int scale);

/// Writes text with its upper left corner at (x, y) px; text outside the image is clipped.
void draw_text(Image& image, int x, int y, const std::string& text, const Colour& colour,
               int scale = 2);

/// Fills a rectangle, blended by the colour's alpha.
void draw_rectangle(Image& image, int x, int y, int width, int height, const Colour& colour);

/// Writes a line of text on a light strip along the upper edge.
void draw_title(Image& image, const std::string& text, int scale = 2);

struct LegendEntry {
  std::string label;
  Colour colour;
};

/// Draws a legend of colour patches with labels in the lower left corner.
void draw_legend(Image& image, const std::vector<LegendEntry>& entries, int scale = 2);

/// Draws a colour bar of colour_map at the right side, with the end values (printed with %.3g) and
/// a caption.
void draw_colour_bar(Image& image, double low, double high, const std::string& caption,
                     int scale = 2);

/// Perceptually uniform colour map from dark blue (t = 0) through green to yellow (t = 1), after
/// viridis.
Colour colour_map(double t);

}  // namespace palpate::draw
