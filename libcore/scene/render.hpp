// A picture of one frame, computed without a display: lit spheres, the HIP, the force, the box.
//
// All spheres are seen along parallel rays, so each covers a disc of pixels, and its depth there
// has a closed form: every shape is drawn into a buffer of depths, and the nearest one stays. No
// ray has to search for the sphere that it hits, and the cost grows with the pixels covered.
// render() depends on its arguments alone.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libcore/scene/drawing.hpp"
#include "libcore/scene/scene.hpp"

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

/// Draws `frame` on white. Spheres without a finite centre are left out; the HIP is drawn where it
/// is held in the box. It is translucent: spheres behind it shine through, and it shines through
/// the spheres before it.
Image render(const Scene& scene, const Frame& frame, const Camera& camera,
             const RenderOptions& options);

/// The picture as a PNG file's bytes. @throw Error when libpng cannot.
std::vector<std::byte> encode_png(const Image& image);

}  // namespace hapgrid
