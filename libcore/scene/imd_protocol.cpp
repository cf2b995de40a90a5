#include "libcore/scene/imd_protocol.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <string_view>
#include <utility>

namespace hapgrid {

namespace {

// CODATA 2018; those of the SI are exact.
constexpr double kAvogadro = 6.02214076e23;
constexpr double kBohrInAngstrom = 0.529177210903;
constexpr double kElementaryCharge = 1.602176634e-19;
constexpr double kHartreeInJoule = 4.3597447222071e-18;
constexpr double kCalorieInJoule = 4.184;
constexpr double kJouleInKJmol = kAvogadro / 1000;
constexpr double kNewtonInKJmolAngstrom = 6.02214076e10;
constexpr double kSecondInPs = 1e12;

constexpr int kSessionInfoSize = 7;

using Unit = std::pair<std::string_view, double>;  // its name, and its factor
constexpr Unit kLengths[] = {{"angstrom", 1}, {"m", 1e10},  {"mm", 1e7},
                             {"nm", 10},      {"pm", 0.01}, {"bohr", kBohrInAngstrom}};
constexpr Unit kEnergies[] = {{"kJ/mol", 1},
                              {"kcal/mol", kCalorieInJoule},
                              {"J", kJouleInKJmol},
                              {"eV", kElementaryCharge* kJouleInKJmol},
                              {"hartree", kHartreeInJoule* kJouleInKJmol}};

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

void append_big_endian(std::vector<std::byte>& to, std::int32_t value) {
  append(to, htonl(static_cast<std::uint32_t>(value)));
}

std::int32_t read_big_endian(const std::byte* from) {
  std::uint32_t value;
  std::memcpy(&value, from, sizeof value);
  return static_cast<std::int32_t>(ntohl(value));
}

void append_header(std::vector<std::byte>& to, ImdType type, std::size_t length) {
  append_big_endian(to, static_cast<std::int32_t>(type));
  append_big_endian(to, static_cast<std::int32_t>(length));
}

void append_vector(std::vector<std::byte>& to, const Vec3& v, double factor) {
  for (const double x : v) append(to, static_cast<float>(x * factor));
}

}  // namespace

ImdUnits::ImdUnits(int version, const std::string& length_unit, const std::string& energy_unit) {
  length_known = find_unit(kLengths, length_unit, length);
  energy_known = find_unit(kEnergies, energy_unit, energy);
  if (energy_known && version == 2) energy /= kCalorieInJoule;
}

ImdEncoder::ImdEncoder(int version, const Scene& scene, bool has_energy, double tick_s)
    : version_(version),
      has_energy_(has_energy),
      units_(version, scene.length_unit, scene.energy_unit),
      tick_ps_(tick_s * kSecondInPs),
      spheres_(scene.spheres.size()) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    box_[4 * axis] = static_cast<float>(units_.length * scene.box.spacing *
                                        (static_cast<double>(scene.box.counts[axis]) - 1));
}

std::vector<std::byte> ImdEncoder::greeting() const {
  std::vector<std::byte> bytes;
  append_big_endian(bytes, static_cast<std::int32_t>(ImdType::kHandshake));
  append(bytes, std::int32_t{version_});  // not swapped: it tells the byte order of bodies
  if (version_ == 2) return bytes;
  append_header(bytes, ImdType::kSessionInfo, kSessionInfoSize);
  // Time, energies, box, coordinates, wrapped, velocities, forces.
  for (const bool has : {true, has_energy_, true, true, false, false, true})
    bytes.push_back(static_cast<std::byte>(has));
  return bytes;
}

std::span<const std::byte> ImdEncoder::encode(const Frame& frame) {
  const std::size_t atoms = spheres_ + 1;
  bytes_.clear();
  if (version_ == 3) {
    append_header(bytes_, ImdType::kTime, 1);
    append(bytes_, tick_ps_);
    append(bytes_, frame.time_s * kSecondInPs);
    append(bytes_, static_cast<std::int64_t>(frame.tick));
  }
  if (has_energy_) {
    constexpr std::uint64_t kMax = std::numeric_limits<std::int32_t>::max();
    append_header(bytes_, ImdType::kEnergies, 1);
    append(bytes_, static_cast<std::int32_t>(std::min(frame.tick, kMax)));
    const auto energy = static_cast<float>(frame.energy * units_.energy);
    // Temperature, total, potential; van der Waals, Coulomb, bonds, angles, dihedrals, impropers.
    append(bytes_, std::array<float, 9>{0, energy, energy});
  }
  if (version_ == 3) {
    append_header(bytes_, ImdType::kBox, 1);
    append(bytes_, box_);
  }
  append_header(bytes_, ImdType::kCoordinates, atoms);
  for (const float x : frame.centres) append(bytes_, static_cast<float>(x * units_.length));
  append_vector(bytes_, frame.position, units_.length);
  if (version_ == 3) {
    append_header(bytes_, ImdType::kForces, atoms);
    bytes_.resize(bytes_.size() + spheres_ * 3 * sizeof(float));  // zeros
    append_vector(bytes_, frame.force, kNewtonInKJmolAngstrom);
  }
  return bytes_;
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
    state_ = type == static_cast<std::int32_t>(ImdType::kGo) ? State::kRunning : State::kClosed;
    return;
  }
  const bool three = version_ == 3;
  switch (static_cast<ImdType>(type)) {
    case ImdType::kGo:
      return;
    case ImdType::kRate:
      ++ignored_.rates;
      return;
    case ImdType::kForcesOnAtoms:
      if (length < 0 || static_cast<std::size_t>(length) > atoms_) break;
      ++ignored_.forces;
      skip_ = static_cast<std::uint64_t>(length) * (sizeof(std::int32_t) + 3 * sizeof(float));
      return;
    case ImdType::kPause:  // version 2 has one message for both
      state_ = !three && state_ == State::kPaused ? State::kRunning : State::kPaused;
      return;
    case ImdType::kResume:
      if (!three) break;
      state_ = State::kRunning;
      return;
    case ImdType::kWait:  // for a client to come back: play does not
      if (!three) break;
      return;
    default:
      break;
  }
  state_ = State::kClosed;
}

}  // namespace hapgrid
