// The hand and the device of `--device sim:FILE`; one that is taken moves for a while.
#include "tools/play/simulation.hpp"

#include <algorithm>

#include "tests/fuzz/fuzz.hpp"

using namespace hapgrid;

namespace {

void use(Simulation simulation) {
  // A session may have ten million ticks, whose targets are kept in memory.
  simulation.hand.seconds = std::min(simulation.hand.seconds, 1.0);
  const Box box{{-0.7, -0.2, -0.1}, 0.25, {6, 3, 2}};
  const Mapping mapping({}, SimulatedDevice::info(simulation.device), box);
  const auto device = simulated_device(simulation, mapping, box);
  DeviceInput input;
  for (int tick = 0; tick < 20 && device->read(input) == DeviceStatus::kOk; ++tick)
    device->send({0.1, -3, 1e300});
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::refusable([&] {
    const fuzz::MemoryFile memory(std::as_bytes(std::span(data, size)));
    use(read_simulation(memory.name(), 1000));
  });
  return 0;
}
