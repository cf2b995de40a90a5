// What `--cost` appends to, as stats reads it.
#include "tests/fuzz/fuzz.hpp"
#include "tools/stats/statistics.hpp"

using namespace hapgrid;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::refusable([&] {
    CostSums sums;
    add_costs(sums, "fuzz", std::string(fuzz::text_of({data, size})));
  });
  return 0;
}
