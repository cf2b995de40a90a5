#include "libcore/device/process_messages.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <span>
#include <string_view>

#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

static_assert(std::endian::native == std::endian::little, "messages are sent as they are");
static_assert(sizeof(hapgrid_device_greeting) == 128 && sizeof(hapgrid_device_state) == 40 &&
              sizeof(hapgrid_device_force) == 32);

namespace {

// No device for a hand reaches less or farther, is stronger or faster (m, N, Hz).
constexpr double kNearest = 1e-3, kFarthest = 10, kStrongest = 1000, kFastest = 1e5;

bool finite(std::span<const double> numbers) noexcept {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
}

/// The longest side of the adapter's ranges, m.
double reach(const hapgrid_device_greeting& g) noexcept {
  double longest = 0;
  for (int a = 0; a < 3; ++a) longest = std::max(longest, g.high[a] - g.low[a]);
  return longest;
}

}  // namespace

std::string greeting_flaw(const hapgrid_device_greeting& g, std::size_t size) {
  if (size != sizeof g || std::memcmp(g.magic, HAPGRID_DEVICE_MAGIC, sizeof g.magic) != 0)
    return "sent something that is not a greeting";
  if (g.version != HAPGRID_DEVICE_VERSION)
    return format("speaks version {} of the protocol, this play speaks {}", g.version,
                  HAPGRID_DEVICE_VERSION);
  const bool steers = (g.flags & HAPGRID_DEVICE_STEERS) != 0;
  int axes = 0;
  for (int a = 0; a < 3; ++a) {
    const double low = g.low[a], high = g.high[a];
    const bool possible =
        steers ? low == high || (low == -1 && high == 1)
               : low >= -kFarthest && high <= kFarthest && (low == high || high - low >= kNearest);
    if (!possible)
      return format("says that its {} goes from {} to {}{}", "xyz"[a], rounded(low), rounded(high),
                    steers ? ", and steers" : " m");
    axes += low < high;
  }
  if (axes == 0) return "says that it has no axis";
  if (!(g.max_force >= 0 && g.max_force <= kStrongest))
    return format("says that its largest force is {} N", rounded(g.max_force));
  if (!(g.rate >= kSlowestProcessHz && g.rate <= kFastest))
    return format("says that its rate is {} Hz", rounded(g.rate));
  return "";
}

DeviceInfo device_info(const hapgrid_device_greeting& g, const std::string& name) {
  const auto* const end = std::find(std::begin(g.name), std::end(g.name), '\0');
  const std::string_view given(g.name, static_cast<std::size_t>(end - g.name));
  DeviceInfo info{.name = given.empty() ? name : printable_line(given),
                  .unit = (g.flags & HAPGRID_DEVICE_STEERS) != 0 ? DeviceInfo::Unit::kRate
                                                                 : DeviceInfo::Unit::kMetres,
                  .max_force = g.max_force};
  std::copy_n(g.low, 3, info.low.begin());
  std::copy_n(g.high, 3, info.high.begin());
  return info;
}

std::string_view told_error(const char* message, std::size_t size) noexcept {
  const std::string_view text(message, size), mark = HAPGRID_DEVICE_ERROR;
  return text.starts_with(mark) ? text.substr(mark.size()) : std::string_view();
}

StateFlaw state_flaw(const hapgrid_device_greeting& greeting, const hapgrid_device_state& state,
                     std::size_t size, std::uint32_t number, double time) noexcept {
  if (size != sizeof state) return StateFlaw::kSize;
  if (state.number != number) return StateFlaw::kNumber;
  if (!std::isfinite(state.time) || !finite(state.position)) return StateFlaw::kNotFinite;
  const double slack = reach(greeting) / 2;  // ranges are nominal
  for (int a = 0; a < 3; ++a)
    if (state.position[a] < greeting.low[a] - slack || state.position[a] > greeting.high[a] + slack)
      return StateFlaw::kOutside;
  return state.time < time ? StateFlaw::kBackwards : StateFlaw::kNone;
}

}  // namespace hapgrid
