#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/loop/pacer.hpp"
#include "tools/common/signals.hpp"
#include "tools/common/tool.hpp"
#include "tools/play/instead.hpp"

namespace hapgrid {

namespace {

constexpr double kLineSeconds = 0.5, kScreenSeconds = 0.05;  // between two lines

/// "x -80 to 80 mm, ...", or which axes steer.
std::string ranges_text(const DeviceInfo& info) {
  std::string text;
  for (int a = 0; a < 3; ++a) {
    if (info.low[a] == info.high[a]) continue;
    text += format("{}{}", text.empty() ? "" : ", ", "xyz"[a]);
    if (info.unit == DeviceInfo::Unit::kMetres)
      text += format(" {:g} to {:g} mm", 1000 * info.low[a], 1000 * info.high[a]);
  }
  return text + (info.unit == DeviceInfo::Unit::kRate ? " steer" : "");
}

std::string input_text(const DeviceInfo& info, const DeviceInput& input, double answers_hz) {
  const bool steers = info.unit == DeviceInfo::Unit::kRate;
  std::string text = place_text(info, steers ? input.rate : input.position);
  text += format("{:5.0f} answers/s", answers_hz);
  if (input.clutch) text += "  clutch";
  if (input.reset) text += "  button";
  if (input.next) text += "  next level";
  if (input.stalled) text += "  silent";
  return text;
}

}  // namespace

std::string place_text(const DeviceInfo& info, const Vec3& place) {
  const bool steers = info.unit == DeviceInfo::Unit::kRate;
  std::string text;
  for (int a = 0; a < 3; ++a)
    if (info.low[a] != info.high[a])
      text += steers ? format("{} {:6.1f} %  ", "xyz"[a], 100 * place[a])
                     : format("{} {:7.2f} mm  ", "xyz"[a], 1000 * place[a]);
  return text;
}

std::string device_text(const ProcessDevice& device) {
  const DeviceInfo info = device.info();
  const std::string force = info.max_force > 0 ? format("it can hold {} N", rounded(info.max_force))
                                               : std::string("it has no force");
  return format("{}: {}; {} forces/s at most; {}", info.name, ranges_text(info),
                rounded(device.rate_hz()), force);
}

int try_device(ProcessDevice& device, double rate_hz, double duration_s) {
  const DeviceInfo info = device.info();
  const double rate = rate_hz > 0 ? rate_hz : std::min(device.rate_hz(), kMostTriedHz);
  say("play", device_text(device) + (info.max_force > 0 ? ", and gets none" : ""));
  const bool on_screen = ::isatty(STDOUT_FILENO);
  const double every = std::max(1.0, rate * (on_screen ? kScreenSeconds : kLineSeconds));
  Clock clock;
  Pacer pacer(clock, rate);
  std::uint64_t answers = 0;
  double next = every, began = 0;
  for (;;) {
    const std::uint64_t tick = pacer.wait(caught_signal);
    const double passed = static_cast<double>(tick) / rate;
    if (caught_signal != 0 || (duration_s > 0 && passed >= duration_s)) break;
    DeviceInput input;
    if (device.read(input) != DeviceStatus::kOk || device.send({0, 0, 0}) != DeviceStatus::kOk) {
      device.stop();
      throw DeviceError(format("device: {}", device.error()));
    }
    ++answers;
    if (static_cast<double>(tick) < next) continue;
    const std::string text =
        input_text(info, input, static_cast<double>(answers) / (passed - began));
    std::printf(on_screen ? "\r%s\033[K" : "%s\n", text.c_str());
    std::fflush(stdout);
    answers = 0;
    began = passed;
    next = static_cast<double>(tick) + every;
  }
  if (on_screen) std::printf("\n");
  if (device.stop() != DeviceStatus::kOk)
    throw DeviceError(format("device: did not take the last zero force: {}", device.error()));
  return caught_signal != 0 ? 128 + caught_signal : kExitDone;
}

}  // namespace hapgrid
