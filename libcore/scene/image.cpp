#include "libcore/scene/image.hpp"

#include <png.h>

#include <string>

#include "libcore/base/error.hpp"

namespace hapgrid {

std::vector<std::byte> encode_png(const Image& image) {
  // The simplified interface of libpng: the other one leaves functions by longjmp().
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::vector<std::byte> bytes(size);
  if (!png_image_write_to_memory(&png, bytes.data(), &size, /*convert_to_8_bit=*/0,
                                 image.pixels.data(), /*row_stride=*/0, nullptr))
    throw Error(std::string("png: ") + png.message);
  bytes.resize(size);
  return bytes;
}

}  // namespace hapgrid
