#include "tools/view/canvas.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>

namespace hapgrid {

Image blank(int width, int height, Rgb colour) {
  Image image{width, height, {}};
  image.pixels.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), colour);
  return image;
}

void fill(Image& image, int x, int y, int width, int height, Rgb colour) {
  const int right = std::min(image.width, x + width);
  const int bottom = std::min(image.height, y + height);
  for (int row = std::max(0, y); row < bottom; ++row)
    for (int column = std::max(0, x); column < right; ++column)
      image.pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                   static_cast<std::size_t>(column)] = colour;
}

void line(Image& image, int x0, int y0, int x1, int y1, int thickness, Rgb colour) {
  const int steps = std::max({std::abs(x1 - x0), std::abs(y1 - y0), 1});
  for (int i = 0; i <= steps; ++i)
    fill(image, x0 + (x1 - x0) * i / steps, y0 + (y1 - y0) * i / steps, thickness, thickness,
         colour);
}

void write(Image& image, int x, int y, int scale, std::string_view text, Rgb colour) {
  for (const char letter : letters_of(text)) {
    if (x >= image.width) return;
    const LetterRows rows = letter_rows(letter);
    for (int row = 0; row < kLetterHeight; ++row)
      for (int column = 0; column < kLetterWidth; ++column)
        if (rows[static_cast<std::size_t>(kFine * row + kFine / 2)] >>
                (kFine * (kLetterWidth - 1 - column) + kFine / 2) &
            1)
          fill(image, x + scale * column, y + scale * row, scale, scale, colour);
    x += scale * kLetterWidth;
  }
}

}  // namespace hapgrid
