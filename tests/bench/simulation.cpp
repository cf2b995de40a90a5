#include "tests/bench/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>

#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/base/toml.hpp"
#include "libcore/device/path.hpp"
#include "tools/common/definition.hpp"

namespace hapgrid {

namespace {

constexpr std::uint64_t kMaxBytes = 1 << 20;
constexpr std::uint64_t kMaxPathBytes = std::uint64_t{1} << 30;
constexpr double kMostTicks = 1e7;  // of a session: its targets are kept in memory
constexpr std::int64_t kMostSessions = 1'000'000;

/// One table and what its keys may be. A key that is not there leaves the default.
class Table {
 public:
  Table(const TomlFile& file, const toml::table& table, std::string prefix)
      : file_(file), table_(table), prefix_(std::move(prefix)) {}

  void number(const char* key, double low, double high, const char* unit, double& value) const {
    const toml::node* node = table_.get(key);
    if (!node) return;
    value = file_.number(*node, prefix_ + key);
    if (value < low || value > high)
      file_.fail(*node, format("{}{} must be a number from {} to {} {}, not {}", prefix_, key,
                               to_text(low), to_text(high), unit, to_text(value)));
  }
  template <class T>
  void whole(const char* key, std::int64_t low, std::int64_t high, T& value) const {
    if (const toml::node* node = table_.get(key))
      value = static_cast<T>(file_.whole(*node, prefix_ + key, low, high));
  }

 private:
  const TomlFile& file_;
  const toml::table& table_;
  std::string prefix_;
};

void read_device(const TomlFile& file, Simulation& s) {
  file.only_keys(file.root(), "",
                 {"mass", "damping", "encoder", "delay", "reach", "truth", "hand", "random"});
  const Table device(file, file.root(), "");
  device.number("mass", 1e-3, 1e3, "kg", s.device.mass);
  device.number("damping", 0, 1e4, "N s/m", s.device.damping);
  device.number("encoder", 0, 0.1, "m", s.device.encoder);
  device.number("reach", 1e-3, 1e3, "m", s.device.reach);
  device.whole("delay", 0, 10000, s.device.delay);
  if (const toml::node* node = file.root().get("truth")) s.truth = file.boolean(*node, "truth");
}

/// The path's file is looked for from the folder of the TOML.
void read_hand(const TomlFile& file, const std::string& name, Simulation& s) {
  if (!file.root().get("hand")) return;
  const toml::table& table = file.table(file.root(), "hand");
  file.only_keys(table, "hand.", {"stiffness", "damping", "tremor", "next", "path"});
  const Table hand(file, table, "hand.");
  hand.number("stiffness", 0, 1e6, "N/m", s.device.stiffness);
  hand.number("damping", 0, 1e4, "N s/m", s.device.hand_damping);
  hand.number("tremor", 0, 0.1, "m", s.tremor);
  double next = 0;
  hand.number("next", 1 / s.device.rate_hz, 1e6, "s", next);
  s.device.next_ticks = static_cast<std::uint64_t>(std::llround(next * s.device.rate_hz));
  if (const toml::node* node = table.get("path")) {
    const auto path = std::filesystem::path(name).parent_path() / file.text(*node, "hand.path");
    if (file.root().get("random"))
      file.fail(*node, "a hand with a path moves along it once: there must be no table [random]");
    for (const DeviceInput& tick : parse_path(read_regular_text(path, kMaxPathBytes), path)) {
      if (tick.next) file.fail(*node, "the hand's path has the word next: hand.next is for that");
      s.path.push_back(tick.position);
    }
  }
}

void read_random(const TomlFile& file, Simulation& s) {
  if (!file.root().get("random")) return;
  const toml::table& table = file.table(file.root(), "random");
  file.only_keys(table, "random.", {"seed", "sessions", "seconds", "speed", "hold"});
  const Table random(file, table, "random.");
  random.whole("seed", 0, std::int64_t{1} << 53, s.hand.seed);
  random.whole("sessions", 1, kMostSessions, s.device.sessions);
  random.number("seconds", 0.001, kMostTicks / s.device.rate_hz, "s", s.hand.seconds);
  random.number("speed", 1e-6, 1e3, "m/s", s.hand.speed);
  random.number("hold", 0, 1e6, "s", s.hand.hold);
}

/// Adds sines of 8, 10 and 12 Hz on x, y and z: what the hand of a healthy person does at rest. The
/// sine is that of a rotation whose half angle's tangent is pi f / rate, so that the bits depend on
/// no mathematical library; it turns slower than f by the part (pi f / rate)^2 / 3.
void tremble(double amplitude, double rate_hz, std::vector<Vec3>& targets) {
  if (amplitude == 0) return;
  for (int a = 0; a < 3; ++a) {
    const double t = std::numbers::pi * (8 + 2 * a) / rate_hz;
    const double c = (1 - t * t) / (1 + t * t), s = 2 * t / (1 + t * t);
    double cosine = 1, sine = 0;
    for (Vec3& x : targets) {
      x[a] += amplitude * sine;
      const double turned = c * cosine - s * sine;
      sine = s * cosine + c * sine;
      cosine = turned;
    }
  }
}

}  // namespace

Simulation read_simulation(const std::string& name, double rate_hz) {
  const TomlFile file(read_toml(name, kMaxBytes), name == "-" ? "standard input" : name);
  Simulation s;
  s.device.rate_hz = s.hand.rate_hz = rate_hz;
  s.device.sessions = 1000;
  read_device(file, s);
  read_hand(file, name, s);
  read_random(file, s);
  if (!s.path.empty()) s.device.sessions = 1;
  return s;
}

std::unique_ptr<SimulatedDevice> simulated_device(const Simulation& s, const Mapping& mapping,
                                                  const Box& box) {
  if (!s.path.empty()) {
    std::vector<Vec3> path = s.path;
    for (Vec3& x : path) x = mapping.handle(x);
    tremble(s.tremor, s.device.rate_hz, path);
    return std::make_unique<SimulatedDevice>(
        s.device, [path](std::uint64_t, std::vector<Vec3>& targets) { targets = path; });
  }
  const Vec3 one = mapping.handle(box.origin);
  const Vec3 other = mapping.handle(box.high());
  Vec3 low, high;  // axes can be mirrored
  for (int a = 0; a < 3; ++a) {
    low[a] = std::min(one[a], other[a]);
    high[a] = std::max(one[a], other[a]);
  }
  return std::make_unique<SimulatedDevice>(
      s.device, [low, high, hand = s.hand, tremor = s.tremor](std::uint64_t session,
                                                              std::vector<Vec3>& targets) {
        wander(hand, low, high, session, targets);
        tremble(tremor, hand.rate_hz, targets);
      });
}

}  // namespace hapgrid
