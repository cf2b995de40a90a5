// A picture in memory, and as a PNG.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hapgrid {

using Rgb = std::array<std::uint8_t, 3>;

/// Pixels row after row from the top.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<Rgb> pixels;

  const Rgb& at(int x, int y) const {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
};

/// The file's bytes. @throw Error when libpng cannot.
std::vector<std::byte> encode_png(const Image& image);

}  // namespace hapgrid
