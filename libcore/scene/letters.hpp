// The letters in pictures.
#pragma once

#include <cstdint>
#include <span>

namespace hapgrid {

/// The size of a letter in pixels, at scale 1.
inline constexpr int kLetterWidth = 6;
inline constexpr int kLetterHeight = 13;

/// A letter's rows from the top; bit kLetterWidth - 1 is the left column.
using LetterRows = std::span<const std::uint8_t, kLetterHeight>;

/// Everything but printable ASCII is '?'.
LetterRows letter_rows(char letter);

}  // namespace hapgrid
