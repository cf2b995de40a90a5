// Profiles of devices; one that is taken then reads reports of zeros and ones, and is sent forces.
#include "libcore/device/profile.hpp"

#include <limits>

#include "tests/fuzz/fuzz.hpp"

using namespace hapgrid;

namespace {

void use(Profile profile) {
  const std::size_t length = profile.input_length + 1;
  const std::uint8_t id = profile.input_id;
  ProfileProtocol protocol(std::move(profile));
  protocol.info();
  for (const std::uint8_t byte : {0x00, 0xff, 0x5a}) {
    std::vector<std::uint8_t> report(length, byte);
    report[0] = id;
    DeviceInput input;
    protocol.decode(report, input);
    protocol.decode(std::span(report).first(length / 2), input);
  }
  std::vector<HidReport> reports;
  for (const double newtons : {0.0, 1.0, -1e300, std::numeric_limits<double>::quiet_NaN()})
    protocol.encode({newtons, -newtons, newtons / 3}, reports);
  protocol.keep_alive();
  protocol.stop();
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::refusable([&] { use(read_profile(std::string(fuzz::text_of({data, size})), "fuzz")); });
  return 0;
}
