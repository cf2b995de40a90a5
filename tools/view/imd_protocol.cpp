#include "tools/view/imd_protocol.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>
#include <utility>

namespace hapgrid {

namespace {

// Types of messages.
constexpr std::int32_t kEnergies = 1, kCoordinates = 2, kGo = 3, kHandshake = 4, kForcesOnAtoms = 6,
                       kPause = 7, kRate = 8;
constexpr std::int32_t kVersion = 2;

// CODATA 2018; those of the SI are exact. In kcal/mol.
constexpr double kBohrInAngstrom = 0.529177210903;
constexpr double kKilojoule = 1 / 4.184;
constexpr double kJoule = 6.02214076e20 * kKilojoule;

using Unit = std::pair<std::string_view, double>;  // its name, and its factor
constexpr Unit kLengthUnits[] = {{"angstrom", 1}, {"m", 1e10},  {"mm", 1e7},
                                 {"nm", 10},      {"pm", 0.01}, {"bohr", kBohrInAngstrom}};
constexpr Unit kEnergyUnits[] = {{"kJ/mol", kKilojoule},
                                 {"kcal/mol", 1},
                                 {"J", kJoule},
                                 {"eV", 1.602176634e-19 * kJoule},
                                 {"hartree", 4.3597447222071e-18 * kJoule}};

/// Sets `value`, and says whether the unit is known.
bool find_unit(std::span<const Unit> units, const std::string& name, double& value) {
  const auto unit = std::find_if(units.begin(), units.end(),
                                 [&](const Unit& candidate) { return candidate.first == name; });
  if (unit == units.end()) return false;
  value = unit->second;
  return true;
}

/// As it is in memory: the byte order of bodies.
template <class T>
void append(std::vector<std::byte>& to, const T& value) {
  to.resize(to.size() + sizeof value);
  std::memcpy(to.data() + to.size() - sizeof value, &value, sizeof value);
}

void append_big_endian(std::vector<std::byte>& to, std::size_t value) {
  append(to, htonl(static_cast<std::uint32_t>(value)));
}

std::int32_t read_big_endian(const std::byte* from) {
  std::uint32_t value;
  std::memcpy(&value, from, sizeof value);
  return static_cast<std::int32_t>(ntohl(value));
}

}  // namespace

ImdUnits::ImdUnits(const Scene& scene)
    : length_known(find_unit(kLengthUnits, scene.length_unit, length)),
      energy_known(find_unit(kEnergyUnits, scene.energy_unit, energy)) {}

std::vector<std::byte> imd_greeting() {
  std::vector<std::byte> bytes;
  append_big_endian(bytes, kHandshake);
  append(bytes, kVersion);  // not swapped: it tells the byte order of bodies
  return bytes;
}

std::vector<std::byte> imd_frame(const Frame& frame, const ImdUnits& units) {
  std::vector<std::byte> bytes;
  if (!std::isnan(frame.energy)) {
    constexpr std::uint64_t kMax = std::numeric_limits<std::int32_t>::max();
    append_big_endian(bytes, kEnergies);
    append_big_endian(bytes, 1);
    append(bytes, static_cast<std::int32_t>(std::min(frame.tick, kMax)));
    const auto energy = static_cast<float>(frame.energy * units.energy);
    // Temperature, total, potential; van der Waals, Coulomb, bonds, angles, dihedrals, impropers.
    append(bytes, std::array<float, 9>{0, energy, energy});
  }
  append_big_endian(bytes, kCoordinates);
  append_big_endian(bytes, frame.centres.size() / 3 + 1);
  for (const float x : frame.centres) append(bytes, static_cast<float>(x * units.length));
  for (const double x : frame.position) append(bytes, static_cast<float>(x * units.length));
  return bytes;
}

ImdListener::State ImdListener::read(std::span<const std::byte> bytes) {
  while (!bytes.empty() && state_ != State::kClosed) {
    if (skip_ > 0) {
      const auto part = static_cast<std::size_t>(std::min<std::uint64_t>(skip_, bytes.size()));
      skip_ -= part;
      bytes = bytes.subspan(part);
      continue;
    }
    const std::size_t part = std::min(header_.size() - filled_, bytes.size());
    std::memcpy(header_.data() + filled_, bytes.data(), part);
    filled_ += part;
    bytes = bytes.subspan(part);
    if (filled_ < header_.size()) break;
    filled_ = 0;
    obey(read_big_endian(header_.data()), read_big_endian(header_.data() + 4));
  }
  return state_;
}

/// The length of a message without a body is ignored: clients set it to anything.
void ImdListener::obey(std::int32_t type, std::int32_t length) {
  if (state_ == State::kGreeted) {
    state_ = type == kGo ? State::kRunning : State::kClosed;
  } else if (type == kRate) {
    sent_rate_ = true;
  } else if (type == kForcesOnAtoms && length >= 0 && static_cast<std::size_t>(length) <= atoms_) {
    sent_forces_ = true;
    skip_ = static_cast<std::uint64_t>(length) * (sizeof(std::int32_t) + 3 * sizeof(float));
  } else if (type == kPause) {  // and to go on
    state_ = state_ == State::kPaused ? State::kRunning : State::kPaused;
  } else if (type != kGo) {
    state_ = State::kClosed;
  }
}

}  // namespace hapgrid
