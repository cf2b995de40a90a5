// What people and programs write as text. A text is given to every reader of text, so that what one
// of them takes apart is tried on the others as well.
#include <cstdlib>
#include <limits>
#include <optional>

#include "libcore/device/path.hpp"
#include "libcore/model/definition.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tools/devices/profile.hpp"
#include "tools/stats/statistics.hpp"

using namespace hapgrid;
using namespace hapgrid::fuzz;

namespace {

/// MODEL.toml; behind a zero byte, an override. No file is read: what one would say is up to the
/// model.
void take_definition(std::string_view all) {
  const std::size_t zero = all.find('\0');
  const std::string text(all.substr(0, zero));
  std::vector<std::string> overrides;
  if (zero != all.npos) overrides.emplace_back(all.substr(zero + 1));
  const auto no_file = [](const std::string& name) -> std::string {
    throw Error(name + ": no file here");
  };
  refusable([&] { read_definition(text, "fuzz", overrides, no_file); });
  refusable([&] { read_process(text, "fuzz"); });
}

/// A profile of a device that is taken then reads reports of zeros and ones, and is sent forces.
void use(const Profile& profile) {
  for (const std::uint8_t byte : {0x00, 0xff, 0x5a}) {
    std::vector<std::uint8_t> report(profile.input_length + 1, byte);
    report[0] = profile.input_id;
    hapgrid_device_state state{};
    profile.decode(report, state);
    profile.decode(std::span(report).first(report.size() / 2), state);
  }
  for (const double newtons : {0.0, 1.0, -1e300, std::numeric_limits<double>::quiet_NaN()})
    profile.encode({newtons, -newtons, newtons / 3});
  profile.stop_reports();
}

/// Paths of the HIP.
void take_path(std::string_view text) {
  refusable([&] { static_cast<void>(parse_path(text, "fuzz")); });
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = text_of({data, size});
  take_definition(text);
  take_path(text);
  refusable([&] { use(read_profile(std::string(text), "fuzz")); });
  // What `--cost` appends to, as stats reads it.
  refusable([&] {
    CostSums sums;
    add_costs(sums, "fuzz", std::string(text));
  });
  return 0;
}
