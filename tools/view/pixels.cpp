#include "tools/view/pixels.hpp"

#include <langinfo.h>
#include <locale.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <string_view>

namespace hapgrid {

namespace {

ChafaPointer<ChafaTermInfo> detect() {
  gchar** const environment = g_get_environ();
  ChafaPointer<ChafaTermInfo> info(chafa_term_db_detect(chafa_term_db_get_default(), environment));
  g_strfreev(environment);
  return info;
}

bool says_true_colour() {
  const char* const text = std::getenv("COLORTERM");
  return text && (std::string_view(text) == "truecolor" || std::string_view(text) == "24bit");
}

/// Whether the locale's letters are those of Unicode, which has blocks.
bool locale_has_blocks() {
  static const bool has = [] {
    const locale_t locale = ::newlocale(LC_CTYPE_MASK, "", nullptr);
    if (!locale) return false;  // a name of which this machine knows nothing
    const bool unicode = std::string_view(::nl_langinfo_l(CODESET, locale)) == "UTF-8";
    ::freelocale(locale);
    return unicode;
  }();
  return has;
}

}  // namespace

TerminalPixels::TerminalPixels(const std::string& mode) : info_(detect()) {
  const auto can = [&](ChafaTermSeq sequence) {
    return chafa_term_info_have_seq(info_.get(), sequence);
  };
  if (mode == "sixel" || (mode == "auto" && can(CHAFA_TERM_SEQ_BEGIN_SIXELS)))
    pixel_mode_ = CHAFA_PIXEL_MODE_SIXELS;

  // Sixels have a palette. A fixed one is quicker than one for each frame, which chafa 1.12 also
  // makes of a few colours when most of the picture is white.
  if (!symbols())
    canvas_mode_ = CHAFA_CANVAS_MODE_INDEXED_240;
  else if (says_true_colour() || can(CHAFA_TERM_SEQ_SET_COLOR_FGBG_DIRECT))
    canvas_mode_ = CHAFA_CANVAS_MODE_TRUECOLOR;
  else if (can(CHAFA_TERM_SEQ_SET_COLOR_FGBG_256))
    canvas_mode_ = CHAFA_CANVAS_MODE_INDEXED_256;
  else if (can(CHAFA_TERM_SEQ_SET_COLOR_FGBG_16))
    canvas_mode_ = CHAFA_CANVAS_MODE_INDEXED_16;
  // What was asked for is done, whatever the terminal is known to understand.
  const ChafaPointer<ChafaTermInfo> fallback(
      chafa_term_db_get_fallback_info(chafa_term_db_get_default()));
  chafa_term_info_supplement(info_.get(), fallback.get());
  // Not one for each processor: play, whose frames these mostly are, is to have one to itself.
  chafa_set_n_threads(1);
}

std::vector<std::string> TerminalPixels::encode(const Image& image, int columns, int rows,
                                                int cell_width, int cell_height) const {
  const ChafaPointer<ChafaCanvasConfig> config(chafa_canvas_config_new());
  chafa_canvas_config_set_geometry(config.get(), columns, rows);
  chafa_canvas_config_set_cell_geometry(config.get(), cell_width, cell_height);
  chafa_canvas_config_set_pixel_mode(config.get(), pixel_mode_);
  chafa_canvas_config_set_canvas_mode(config.get(), canvas_mode_);
  chafa_canvas_config_set_preprocessing_enabled(config.get(), FALSE);  // keeps the colours
  // Blocks are in every font, but not in every locale. More kinds of symbols, and more work, make
  // it finer but slower.
  const ChafaPointer<ChafaSymbolMap> map(chafa_symbol_map_new());
  chafa_symbol_map_add_by_tags(
      map.get(), static_cast<ChafaSymbolTags>(
                     CHAFA_SYMBOL_TAG_SPACE |
                     (locale_has_blocks() ? CHAFA_SYMBOL_TAG_BLOCK : CHAFA_SYMBOL_TAG_ASCII)));
  chafa_canvas_config_set_symbol_map(config.get(), map.get());
  chafa_canvas_config_set_work_factor(config.get(), 0.2F);

  const ChafaPointer<ChafaCanvas> canvas(chafa_canvas_new(config.get()));
  // Rows of chafa begin at multiples of four bytes, whatever stride it is told: three bytes a pixel
  // would shear most pictures.
  std::vector<std::array<std::uint8_t, 4>> pixels;
  pixels.reserve(image.pixels.size());
  for (const Rgb& p : image.pixels) pixels.push_back({p[0], p[1], p[2], 255});
  chafa_canvas_draw_all_pixels(canvas.get(), CHAFA_PIXEL_RGBA8_UNASSOCIATED, pixels.front().data(),
                               image.width, image.height, 4 * image.width);
  const ChafaPointer<GString> text(chafa_canvas_print(canvas.get(), info_.get()));
  std::vector<std::string> lines;
  for (std::string_view rest(text->str, text->len); !rest.empty();) {
    const auto end = rest.find('\n');
    lines.emplace_back(rest.substr(0, end));
    rest.remove_prefix(end == rest.npos ? rest.size() : end + 1);
  }
  return lines;
}

}  // namespace hapgrid
