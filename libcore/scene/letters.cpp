#include "libcore/scene/letters.hpp"

#include <ft2build.h>
#include FT_FREETYPE_H
#include <utf8proc.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <system_error>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"

namespace hapgrid {

namespace {

constexpr const char* kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSansMono.ttf";
constexpr int kBaseline = 4;  // pixels below the middle of a letter's height
constexpr double kEm = 11.6;  // in pixels; an advance of 0.602 em is then kLetterWidth

/// The ink of the letter in the face's slot, whose left end is at x on the baseline y.
void draw_ink(Image& image, const FT_GlyphSlot slot, int x, int y) {
  const FT_Bitmap& ink = slot->bitmap;
  for (int row = 0; row < static_cast<int>(ink.rows); ++row)
    for (int column = 0; column < static_cast<int>(ink.width); ++column) {
      const int px = x + slot->bitmap_left + column, py = y - slot->bitmap_top + row;
      if (px < 0 || px >= image.width || py < 0 || py >= image.height) continue;
      const float part = static_cast<float>(ink.buffer[row * ink.pitch + column]) / 255;
      Rgb& pixel =
          image.pixels[static_cast<std::size_t>(py) * static_cast<std::size_t>(image.width) +
                       static_cast<std::size_t>(px)];
      for (std::size_t c = 0; c < 3; ++c)
        pixel[c] = static_cast<std::uint8_t>(
            std::lround((1 - part) * static_cast<float>(pixel[c]) + 255 * part * kInk[c]));
    }
}

/// The font that lies in ../fonts beside the running program, as in a wheel, or else Debian's.
std::string font() {
  std::error_code none;
  const std::filesystem::path own = own_folder() / "../fonts/DejaVuSansMono.ttf";
  return std::filesystem::exists(own, none) ? own.string() : kFont;
}

}  // namespace

double letters_width(std::string_view text) {
  return kLetterWidth * static_cast<double>(std::count_if(
                            text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

void draw_labels(Image& image, const std::vector<Label>& labels, int scale) {
  if (labels.empty()) return;
  FT_Library opened = nullptr;
  if (FT_Init_FreeType(&opened) != 0) throw Error("FreeType: cannot begin");
  const std::unique_ptr<FT_LibraryRec_, FT_Error (*)(FT_Library)> library(opened, FT_Done_FreeType);
  FT_Face found = nullptr;
  if (FT_New_Face(library.get(), font().c_str(), 0, &found) != 0)
    throw Error(format("{}: not there: install the Debian package fonts-dejavu-core", kFont));
  const std::unique_ptr<FT_FaceRec_, FT_Error (*)(FT_Face)> face(found, FT_Done_Face);
  // In 64ths of a pixel, at 72 dots an inch.
  FT_Set_Char_Size(face.get(), 0, static_cast<FT_F26Dot6>(64 * kEm * scale), 72, 72);
  for (const auto& [text, left] : labels) {
    const auto* at = reinterpret_cast<const utf8proc_uint8_t*>(text.data());
    auto rest = static_cast<utf8proc_ssize_t>(text.size());
    double x = left[0];
    utf8proc_int32_t code = 0;
    for (utf8proc_ssize_t bytes; (bytes = utf8proc_iterate(at, rest, &code)) > 0;) {
      // An absurd place is far outside of the picture.
      if (std::abs(x) < 1e6 && std::abs(left[1]) < 1e6 &&
          FT_Load_Char(face.get(), static_cast<FT_ULong>(code),
                       FT_LOAD_RENDER | FT_LOAD_TARGET_LIGHT) == 0)
        draw_ink(image, face->glyph, static_cast<int>(std::lround(x)),
                 static_cast<int>(std::lround(left[1])) + kBaseline * scale);
      at += bytes;
      rest -= bytes;
      x += kLetterWidth * scale;
    }
  }
}

}  // namespace hapgrid
