// A frontier as FrontierReader reads it, dealt out to parts.
#include "libcore/search/expand.hpp"
#include "tests/unit/catch.hpp"

using namespace hapgrid;

TEST_CASE("blocks of a frontier are dealt out in turns, and parts differ by one of them at most") {
  std::mt19937_64 random(2007);
  for (int i = 0; i < 100; ++i) {
    // Few parts of many conversions, which have large blocks, or up to 300 parts of fewer.
    const std::uint64_t total = random() % (i % 2 == 0 ? 100 : i % 3 ? 100000 : 5000);
    const std::uint64_t parts = 1 + random() % (i % 3 ? 9 : 300);
    CAPTURE(total, parts);
    std::uint64_t sum = 0, least = ~std::uint64_t{0}, most = 0;
    for (std::uint64_t k = 1; k <= parts; ++k) {
      const Part part{k, parts};
      std::uint64_t mine = 0;
      for (std::uint64_t c = 0; c < total; ++c) mine += part.mine(total, 1, c);
      REQUIRE(mine == part.size(total));
      REQUIRE(part.has_any(total, 0, total) == (mine > 0));
      sum += mine;
      least = std::min(least, mine);
      most = std::max(most, mine);
    }
    REQUIRE(sum == total);
    // Turns of a block each, and what is left of a turn.
    const std::uint64_t block = std::max<std::uint64_t>(total / parts / 512, 1);
    REQUIRE(most - least <=
            (total / parts / 32 >= 1024 ? std::max<std::uint64_t>(block, 1024) : block));
  }
  // Numbers near the limits of a grid and of N.
  const Part last{0xffffffff, 0xffffffff};
  REQUIRE(last.size(std::uint64_t{1} << 45) <= (std::uint64_t{1} << 14));
}
