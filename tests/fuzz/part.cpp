// Reports of verify --part.
#include "libcore/check/part_report.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace hapgrid;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::refusable([&] {
    PartReport part = part_from_json(std::string(fuzz::text_of({data, size})), "fuzz");
    // As the only part there is: join() makes the row of its walks, and sorts their errors.
    part.part = {1, 1};
    join({std::move(part)}, {"fuzz"});
  });
  return 0;
}
