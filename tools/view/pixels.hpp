// A picture for a terminal: as coloured symbols, or as sixels.
#pragma once

#include <chafa.h>

#include <memory>
#include <string>
#include <vector>

#include "libcore/scene/render.hpp"

namespace hapgrid {

struct ChafaDeleter {
  void operator()(ChafaTermInfo* info) const { chafa_term_info_unref(info); }
  void operator()(ChafaCanvasConfig* config) const { chafa_canvas_config_unref(config); }
  void operator()(ChafaCanvas* canvas) const { chafa_canvas_unref(canvas); }
  void operator()(ChafaSymbolMap* map) const { chafa_symbol_map_unref(map); }
  void operator()(GString* text) const { g_string_free(text, TRUE); }
};
template <class T>
using ChafaPointer = std::unique_ptr<T, ChafaDeleter>;

/// The terminal's abilities, as the environment (TERM and others) describes them.
class TerminalPixels {
 public:
  /// @param mode "symbols", "sixel", or "auto" for the best that the terminal can do.
  explicit TerminalPixels(const std::string& mode);

  bool symbols() const { return pixel_mode_ == CHAFA_PIXEL_MODE_SYMBOLS; }

  /// The picture on columns x rows cells of cell_width x cell_height pixels, as its rows of text.
  /// Sixels are one row. There are no line breaks.
  std::vector<std::string> encode(const Image& image, int columns, int rows, int cell_width,
                                  int cell_height) const;

 private:
  ChafaPointer<ChafaTermInfo> info_;
  ChafaPixelMode pixel_mode_ = CHAFA_PIXEL_MODE_SYMBOLS;
  ChafaCanvasMode canvas_mode_ = CHAFA_CANVAS_MODE_FGBG;
};

}  // namespace hapgrid
