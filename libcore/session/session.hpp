// The record of a play, a session (schemas/session.capnp): a header, and one record for each tick.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "libcore/grid/box.hpp"

namespace hapgrid {

/// Names of flags that programs look for. The names of the safety core's flags start with
/// kSafetyFlag.
inline constexpr const char* kClutchFlag = "clutch";        ///< DeviceInput::clutch
inline constexpr const char* kStalledFlag = "stalled";      ///< DeviceInput::stalled
inline constexpr const char* kResetFlag = "reset";          ///< DeviceInput::reset
inline constexpr const char* kNextFlag = "next";            ///< DeviceInput::next
inline constexpr const char* kBeginsFlag = "begins";        ///< DeviceInput::begins
inline constexpr const char* kLevelFlag = "level_changed";  ///< a switch of levels
inline constexpr const char* kSafetyFlag = "safety_";       ///< "safety_clamped"

inline constexpr std::size_t kMaxFlags = 32;
inline constexpr std::size_t kMaxSettings = 512 << 10;  ///< bytes

/// The facts that are the same in all ticks.
struct SessionHeader {
  std::string model;
  std::string grid_digest;  ///< which grid was played; may be empty
  std::string length_unit;  ///< for people; may be empty
  Box box;
  double rate_hz = 1000;           ///< the time of a tick is its number divided by this
  std::vector<std::string> flags;  ///< names of the bits of TickRecord::flags, bit 0 first
  std::string settings;            ///< JSON, not looked at here; may be empty

  /// The bit of the flag with this name; kMaxFlags if there is no such flag.
  std::size_t flag(const std::string& name) const {
    const auto found = std::find(flags.begin(), flags.end(), name);
    return found == flags.end() ? kMaxFlags : static_cast<std::size_t>(found - flags.begin());
  }
  /// Seconds of play.
  double time_of(std::uint64_t number) const { return static_cast<double>(number) / rate_hz; }

  /// @throw Error when a value is impossible: what is wrong, and the limit.
  void validate() const;

  friend bool operator==(const SessionHeader&, const SessionHeader&) = default;
};

/// One tick of the haptic loop.
struct TickRecord {
  std::uint64_t number = 0;  ///< ascending; ticks whose numbers are skipped were missed
  Vec3 hip{};                ///< as the device gave it: the box's axes, the model's unit of length
  Vec3 raw_force{};          ///< newtons, before the safety core; NaN if it was not computed
  Vec3 force{};              ///< newtons, as it was sent
  std::array<std::uint8_t, 8> levels{};  ///< in the corners i + 2j + 4k of the cell
  std::uint32_t flags = 0;               ///< bits, named by the header
  std::uint32_t lateness_ns = 0;         ///< from the time when the tick was due to its start
  std::uint32_t compute_ns = 0;          ///< from its start until its force was sent
  /// Time for which the slew limit let the force change; 0: the limit did not act.
  std::uint32_t slew_ns = 0;
};

/// Nanoseconds for a record, held in its range.
inline std::uint32_t saturated_ns(std::int64_t ns) noexcept {
  return static_cast<std::uint32_t>(
      std::clamp<std::int64_t>(ns, 0, std::numeric_limits<std::uint32_t>::max()));
}

}  // namespace hapgrid
