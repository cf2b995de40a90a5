// Paths of the HIP: as a file, and as they come through the pipe of a hand, in two pieces. The
// hand's newest place is the path's last one.
#include "libcore/device/path.hpp"

#include <cstdlib>
#include <optional>

#include "libcore/device/hand.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace hapgrid;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzz::text_of({data, size});
  std::optional<Vec3> last;
  fuzz::refusable([&] { last = parse_path(text, "fuzz").back(); });
  fuzz::refusable([&] {
    HandLines lines;
    const std::size_t cut = size / 3;
    std::optional<Vec3> newest = lines.take(text.substr(0, cut));
    if (const auto x = lines.take(text.substr(cut))) newest = x;
    if (const auto x = lines.finish()) newest = x;
    if (newest != last) std::abort();
  });
  return 0;
}
