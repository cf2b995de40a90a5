// The letters in pictures: DejaVu Sans Mono, by FreeType.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace hapgrid {

/// The size of a letter in pixels, at scale 1. All letters are as wide.
inline constexpr int kLetterWidth = 7;
inline constexpr int kLetterHeight = 14;
/// Rows of a letter in a pixel, and columns: what is drawn with several rays a pixel has smooth
/// edges.
inline constexpr int kFine = 4;

/// A letter's rows from the top; bit kFine * kLetterWidth - 1 is the left column.
using LetterRows = std::span<const std::uint32_t, kFine * kLetterHeight>;

/// The rows of '?' stand for any letter but printable ASCII, Å and ° (as one byte of Latin-1).
/// @throw Error when the font is not there
LetterRows letter_rows(char letter);

/// The letters of a text in UTF-8, one byte each, for letter_rows().
std::string letters_of(std::string_view text);

}  // namespace hapgrid
