// Text and lines in a picture.
#pragma once

#include <string_view>

#include "libcore/scene/image.hpp"
#include "libcore/scene/letters.hpp"

namespace hapgrid {

Image blank(int width, int height, Rgb colour);

// Pixels outside the picture are left out.

void fill(Image& image, int x, int y, int width, int height, Rgb colour);
/// A line `thickness` pixels high and wide.
void line(Image& image, int x0, int y0, int x1, int y1, int thickness, Rgb colour);
/// The upper left corner of the first letter is at x, y. '?' stands for a letter that letters.hpp
/// lacks.
void write(Image& image, int x, int y, int scale, std::string_view text, Rgb colour);

}  // namespace hapgrid
