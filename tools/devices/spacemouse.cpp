// hapgrid-spacemouse: an adapter to a SpaceMouse, which steers the HIP and has no force.
//
// While the cap is pushed it sends a report every 8 ms, and after its release three reports of
// zeros. A cap that is pushed and silent for 0.2 s counts as released: otherwise a lost report
// would leave the HIP under way for ever.
#include <chrono>

#include "libcore/base/error.hpp"
#include "tools/devices/adapter.hpp"
#include "tools/devices/hid_bus.hpp"
#include "tools/devices/hid_handle.hpp"
#include "tools/devices/spacemouse_reports.hpp"

using namespace hapgrid;
using namespace std::chrono_literals;

namespace {

constexpr auto kAtRest = 200ms;

class Mouse : public Hardware {
 public:
  Mouse(const HidInfo& info, double rate)
      : name_(shown_name(info)), handle_(info.path), rate_(rate) {}

  hapgrid_device_greeting greeting() const override {
    return made_greeting(name_, {-1, -1, -1}, {1, 1, 1}, 0, rate_,
                         HAPGRID_DEVICE_STEERS | HAPGRID_DEVICE_RELEASES);
  }

  void measure(hapgrid_device_state& state) override {
    handle_.drain([&](std::span<const std::uint8_t> report) {
      if (decode_spacemouse(report, state)) heard_ = Clock::now();
    });
    if (Clock::now() - heard_ > kAtRest)
      for (double& deflection : state.position) deflection = 0;
  }

  void apply(const Vec3&) override {}
  void let_go() override {}

 private:
  std::string name_;
  HidHandle handle_;
  double rate_;
  Clock::time_point heard_;
};

std::vector<HidInfo> mice() {
  std::vector<HidInfo> found;
  for (const HidInfo& info : list_hid())
    if (is_spacemouse(info.vid, info.pid)) found.push_back(info);
  return found;
}

std::unique_ptr<Hardware> open(const AdapterWords& words) {
  const HidMatch match = parse_hid_match(words.words.empty() ? "" : words.words[0]);
  const std::vector<HidInfo> found = mice();
  if (found.empty())
    throw DeviceError("there is no SpaceMouse (play --list-devices shows what there is)");
  return std::make_unique<Mouse>(find_one_hid(found, match, "--device spacemouse:WHICH"),
                                 words.rate);
}

std::vector<ListedDevice> list() {
  std::vector<ListedDevice> listed;
  for (const HidInfo& info : find_hid(mice(), {}))
    listed.push_back({"spacemouse:" + info.path, "-", shown_name(info),
                      may_open(info.path) ? "" : permission_help(info.vid, info.pid)});
  return listed;
}

}  // namespace

int main(int argc, char** argv) {
  return adapter_main(argc, argv, {"[WHICH]", open, [](const AdapterWords&) {}, list});
}
