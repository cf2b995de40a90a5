// session FILE [TICKS [RATE]]: writes a session as play would, of a hand that explores a stiff
// object with a device whose positions are multiples of 2.5 um, and prints the size of a tick on
// the disk. The same arguments give the same ticks, so tests/cli/stats/session.sh uses it, too.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "libcore/session/recorder.hpp"

using namespace hapgrid;

namespace {

enum Flag : std::uint32_t {
  kOutside = 1,
  kLevel = 2,
  kClutch = 4,
  kStalled = 8,
  kClamped = 16,
  kRamp = 32
};

SessionHeader make_header(double rate_hz) {
  return {"hung-ball",
          "8f4b6a0c15b52a9e",
          "m",
          {{-0.1, -0.1, -0.1}, 0.005, {41, 41, 41}},
          rate_hz,
          {"outside", kLevelFlag, kClutchFlag, kStalledFlag, "safety_clamped", "safety_ramp"},
          R"({"scale": 1, "max_force": 3})"};
}

/// The hand makes slow strokes with a tremor of 9 Hz and touches a stiff, curved wall.
std::vector<TickRecord> make_ticks(std::size_t count, double rate_hz) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::lognormal_distribution<double> late(std::log(2500.0), 0.5);
  std::vector<TickRecord> ticks;
  std::uint64_t number = 0;
  std::array<std::uint8_t, 8> levels{};
  for (std::size_t i = 0; i < count; ++i, ++number) {
    TickRecord tick;
    const double rare = static_cast<double>(random() % 20000);
    if (i > 0 && rare == 0) number += 1 + random() % 4;  // ticks that were missed
    const double t = static_cast<double>(number) / rate_hz;
    tick.number = number;
    const double tremor = 5e-5 * std::sin(56.5 * t + std::sin(3 * t));
    const Vec3 hand{0.06 * std::sin(1.3 * t) + tremor, 0.05 * std::sin(0.7 * t + 1) + 2 * tremor,
                    0.03 * std::sin(2.1 * t) - tremor};
    constexpr double kStep = 2.5e-6;
    for (int a = 0; a < 3; ++a) tick.hip[a] = kStep * std::round(hand[a] / kStep);
    const double depth = tick.hip[2] + 0.01 + 0.1 * tick.hip[0] * tick.hip[1];
    const bool clutch = std::fmod(t, 20) > 18;
    const bool computed = !clutch;
    if (computed) {
      const double wall = depth < 0 ? -400 * depth : 0;
      tick.raw_force = {wall * 0.1 * tick.hip[1] - 2 * tick.hip[0],
                        wall * 0.1 * tick.hip[0] - 2 * tick.hip[1], wall - 2 * tick.hip[2]};
      const double size = std::hypot(tick.raw_force[0], tick.raw_force[1], tick.raw_force[2]);
      const double ramp = std::min(1.0, t / 0.5);
      const double scale = ramp * (size * ramp > 3 ? 3 / (size * ramp) : 1);
      for (int a = 0; a < 3; ++a) tick.force[a] = scale * tick.raw_force[a];
      if (size * ramp > 3) tick.flags |= kClamped;
      if (ramp < 1) tick.flags |= kRamp;
    } else {
      tick.raw_force = {std::nan(""), std::nan(""), std::nan("")};
      tick.flags |= kClutch;
    }
    const auto level = static_cast<std::uint8_t>(depth < -0.005 ? 1 : 0);
    if (level != levels[0]) tick.flags |= kLevel;
    levels.fill(level);
    tick.levels = levels;
    if (std::abs(tick.hip[0]) > 0.0599) tick.flags |= kOutside;
    if (rare == 1) tick.flags |= kStalled;
    tick.lateness_ns = saturated_ns(std::llround(late(random) + (rare < 20 ? 200'000 : 0)));
    tick.compute_ns = saturated_ns(std::llround(18'000 + 1500 * normal(random)));
    ticks.push_back(tick);
  }
  return ticks;
}

int run(const std::string& file, std::size_t count, double rate_hz) {
  const std::vector<TickRecord> ticks = make_ticks(count, rate_hz);
  SessionRecorder writer(file, make_header(rate_hz), /*paced=*/false);
  for (const TickRecord& tick : ticks) writer.add(tick);
  writer.finish();
  const auto bytes = static_cast<double>(std::filesystem::file_size(file));
  std::printf("%zu ticks, %.0f bytes, %.2f a tick\n", count, bytes,
              bytes / static_cast<double>(count));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 4) {
    std::fprintf(stderr, "usage: session FILE [TICKS [RATE]]\n");
    return 2;
  }
  try {
    return run(argv[1], argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 60'000,
               argc > 3 ? std::strtod(argv[3], nullptr) : 1000);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "session: %s\n", e.what());
    return 1;
  }
}
