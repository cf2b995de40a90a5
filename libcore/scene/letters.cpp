#include "libcore/scene/letters.hpp"

#include <ft2build.h>
#include FT_FREETYPE_H

#include <array>
#include <memory>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"

namespace hapgrid {

namespace {

constexpr const char* kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSansMono.ttf";
constexpr int kBaseline = 11;  // pixels below the upper edge
constexpr double kEm = 11.6;   // in pixels; an advance of 0.602 em is then kLetterWidth
constexpr int kInkFrom = 112;  // of 255: coverage from which a fine pixel is ink

/// By code of Latin-1.
using Letters = std::array<std::array<std::uint32_t, kFine * kLetterHeight>, 256>;

/// The ink of the letter in the face's slot.
void copy_ink(const FT_GlyphSlot slot, std::array<std::uint32_t, kFine * kLetterHeight>& rows) {
  const FT_Bitmap& ink = slot->bitmap;
  for (unsigned y = 0; y < ink.rows; ++y)
    for (unsigned x = 0; x < ink.width; ++x) {
      const int row = kFine * kBaseline - slot->bitmap_top + static_cast<int>(y);
      const int column = slot->bitmap_left + static_cast<int>(x);
      const bool inside =
          row >= 0 && row < kFine * kLetterHeight && column >= 0 && column < kFine * kLetterWidth;
      if (inside && ink.buffer[static_cast<int>(y) * ink.pitch + static_cast<int>(x)] >= kInkFrom)
        rows[static_cast<std::size_t>(row)] |= 1u << (kFine * kLetterWidth - 1 - column);
    }
}

/// @throw Error
Letters draw_letters() {
  FT_Library opened = nullptr;
  if (FT_Init_FreeType(&opened) != 0) throw Error("FreeType: cannot begin");
  const std::unique_ptr<FT_LibraryRec_, FT_Error (*)(FT_Library)> library(opened, FT_Done_FreeType);
  FT_Face found = nullptr;
  if (FT_New_Face(library.get(), kFont, 0, &found) != 0)
    throw Error(format("{}: not there: install the Debian package fonts-dejavu-core", kFont));
  const std::unique_ptr<FT_FaceRec_, FT_Error (*)(FT_Face)> face(found, FT_Done_Face);
  // In 64ths of a pixel, at 72 dots an inch.
  FT_Set_Char_Size(face.get(), 0, static_cast<FT_F26Dot6>(64 * kFine * kEm), 72, 72);
  Letters letters{};
  for (std::size_t code = ' '; code < letters.size(); ++code)
    if (FT_Load_Char(face.get(), code, FT_LOAD_RENDER | FT_LOAD_NO_HINTING) == 0)
      copy_ink(face->glyph, letters[code]);
  return letters;
}

}  // namespace

std::string letters_of(std::string_view text) {
  std::string letters;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::string_view rest = text.substr(i);
    if (rest.starts_with("Å"))
      letters += '\xc5';
    else if (rest.starts_with("°"))
      letters += '\xb0';
    else if ((text[i] & 0xc0) != 0x80)  // the first byte of a character
      letters += static_cast<unsigned char>(text[i]) < 0x80 ? text[i] : '?';
  }
  return letters;
}

LetterRows letter_rows(char letter) {
  static const Letters letters = draw_letters();
  const bool known = (letter >= ' ' && letter <= '~') || letter == '\xc5' || letter == '\xb0';
  return letters[static_cast<unsigned char>(known ? letter : '?')];
}

}  // namespace hapgrid
