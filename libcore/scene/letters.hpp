// The letters in pictures: DejaVu Sans Mono, by FreeType.
#pragma once

#include <string_view>
#include <vector>

#include "libcore/scene/render.hpp"

namespace hapgrid {

/// The width of a letter in pixels, at scale 1. All letters are as wide.
inline constexpr int kLetterWidth = 7;

/// The width of a text in UTF-8, at scale 1.
double letters_width(std::string_view text);

/// Draws the texts into the picture.
/// @throw Error when the font is not there
void draw_labels(Image& image, const std::vector<Label>& labels, int scale);

}  // namespace hapgrid
