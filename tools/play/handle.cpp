#include "tools/play/handle.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <limits>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/grid/vec3.hpp"
#include "tools/common/signals.hpp"
#include "tools/play/instead.hpp"

namespace hapgrid {

namespace {

constexpr double kShownSeconds = 0.1;  // between two looks at the place

/// For 0.1 N: a handle that nobody holds must not get fast. The tank is off: it books what forces
/// of a model give back, and these are of none.
SafetyLimits gentle() {
  SafetyLimits limits;
  limits.max_force = 0.1;
  limits.ramp_ms = 100;
  limits.max_speed = 0.5;
  limits.reserve = std::numeric_limits<double>::infinity();
  return limits;
}

}  // namespace

Handle::Handle(ProcessDevice& device, double rate_hz)
    : device_(device),
      rate_hz_(rate_hz),
      info_(device.info()),
      pacer_(clock_, rate_hz),
      safety_(gentle()) {}

bool Handle::tick(const Vec3& wanted) {
  const std::uint64_t number = pacer_.wait(caught_signal);
  if (caught_signal != 0) throw Interrupted();
  DeviceInput input;
  const auto must = [&](DeviceStatus status) {
    if (status == DeviceStatus::kOk) return;
    device_.stop();
    throw DeviceError(format("device: {}", device_.error()));
  };
  must(device_.read(input));
  const std::uint64_t passed = last_ ? number - *last_ : 1;
  if (!last_) first_ = number;
  last_ = number;
  const double dt = static_cast<double>(passed) / rate_hz_;
  const bool steers = info_.unit == DeviceInfo::Unit::kRate;
  const Vec3 now = steers ? input.rate : input.position;
  const double speed = lost_ || steers ? 0 : length_of(now - place_) / dt;
  place_ = now;
  lost_ = input.stalled;
  const SafeForce safe = safety_.apply(
      {.force = wanted,
       .dt = dt,
       .slew_dt = answers_ > 0 ? static_cast<double>(pacer_.began_ns() - sent_ns_) * 1e-9 : dt,
       .missed = passed - 1,
       .speed = speed,
       .stalled = input.stalled,
       .clutch = input.clutch});
  sent_ = safe.force;
  must(device_.send(sent_));
  sent_ns_ = clock_.now();
  ++answers_;
  return read_line();
}

bool Handle::read_line() {
  pollfd typed{STDIN_FILENO, POLLIN, 0};
  if (::poll(&typed, 1, 0) <= 0) return false;
  std::array<char, 256> line{};
  const ssize_t size = ::read(STDIN_FILENO, line.data(), line.size());
  if (size < 0) return false;
  if (size == 0) throw Error("bring-up: the terminal said its end: nothing was found out");
  answer_.assign(line.data(), static_cast<std::size_t>(size));
  std::erase_if(answer_, [](unsigned char c) { return std::isspace(c) != 0; });
  for (char& c : answer_) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return true;
}

void Handle::fade() {
  do tick({0, 0, 0});
  while (length_of(sent_) > 0);
}

void Handle::tell(const std::string& text) {
  while (read_line()) {
  }
  answer_.clear();
  std::fprintf(stderr, "%s\n", text.c_str());
}

std::vector<Vec3> Handle::ask(const std::string& text) {
  tell(text);
  std::vector<Vec3> places;
  const auto every = static_cast<std::size_t>(std::max(1.0, rate_hz_ * kShownSeconds));
  bool typed = false;
  while (!typed) {
    typed = tick({0, 0, 0});
    // A person may take an hour; the newest places count.
    constexpr std::size_t kMost = 1 << 16;
    if (places.size() == kMost) places.clear();
    places.push_back(place_);
    if (places.size() % every == 0) show();
  }
  std::fprintf(stderr, "\r\033[K");
  return places;
}

void Handle::show() const { std::fprintf(stderr, "\r%s\033[K", place_text(info_, place_).c_str()); }

std::vector<Vec3> Handle::record(double seconds) {
  std::vector<Vec3> places;
  for (double left = seconds * rate_hz_; left > 0; --left) {
    static_cast<void>(tick({0, 0, 0}));
    places.push_back(place_);
  }
  return places;
}

double Handle::answers_hz() const {
  const double passed = static_cast<double>(*last_ - first_ + 1) / rate_hz_;
  return static_cast<double>(answers_) / passed;
}

}  // namespace hapgrid
