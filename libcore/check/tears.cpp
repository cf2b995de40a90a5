#include "libcore/check/tears.hpp"

#include <cstdlib>
#include <string>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/check/invariants.hpp"
#include "libcore/grid/describe.hpp"
#include "libcore/search/tears.hpp"

namespace hapgrid {

Check check_tears(const Grid& grid, std::span<const RecordIndex> records, Converter& converter) {
  Check check{"tears",
              "one-way links",
              "tear fractions that are more than one interval from those searched again",
              {}};
  std::vector<OneWayLink> links;
  for (const RecordIndex r : records)
    for (int q = 0; q < kDirections; ++q)
      if (grid.tears(r)[static_cast<std::size_t>(q)] != kNoTear && grid.is_one_way(r, q) &&
          is_finite(grid.state(r)) && is_finite(grid.state(grid.destination(r, q))))
        links.push_back({r, static_cast<std::uint8_t>(q)});
  check.found.counted = links.size();
  try {
    Progress progress;
    const std::vector<TearByte> tears = find_tears(grid, links, converter, progress);
    for (std::size_t i = 0; i < links.size(); ++i) {
      const auto [r, q] = links[i];
      const TearByte stored = grid.tears(r)[q];
      if (std::abs(stored - tears[i]) <= 1) continue;
      check.found.offend(location_of(grid, r, q), [&, r = r, q = q] {
        return format("{}: stored is {}, the model gives {}", describe_link(grid, r, q), stored,
                      tears[i]);
      });
    }
  } catch (const ModelError& e) {
    check.found.offend([&] { return std::string(e.what()); });
  }
  return check;
}

}  // namespace hapgrid
