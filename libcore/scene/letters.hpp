// The letters in pictures.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace hapgrid {

/// The size of a letter in pixels, at scale 1.
inline constexpr int kLetterWidth = 6;
inline constexpr int kLetterHeight = 13;

/// A letter's rows from the top; bit kLetterWidth - 1 is the left column.
using LetterRows = std::span<const std::uint8_t, kLetterHeight>;

/// The rows of '?' stand for any letter but printable ASCII, Å and ° (as one byte of Latin-1).
LetterRows letter_rows(char letter);

/// The letters of a text in UTF-8, one byte each, for letter_rows().
std::string letters_of(std::string_view text);

}  // namespace hapgrid
