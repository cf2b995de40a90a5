// Checks the messages of an adapter before anything uses them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "libcore/device/device.hpp"
#include "libcore/device/process_protocol.h"

namespace hapgrid {

/// With fewer forces a second the adapter would take each of them away before the next comes.
inline constexpr double kSlowestProcessHz = 20;

/// The flaw of a greeting, to be read behind the adapter's name; empty when there is none.
/// @param size bytes that came, of which `greeting` has the first ones.
std::string greeting_flaw(const hapgrid_device_greeting& greeting, std::size_t size);
/// @param greeting without flaw. @param name stands for the name of a greeting that has none.
DeviceInfo device_info(const hapgrid_device_greeting& greeting, const std::string& name);

/// What an adapter says in place of a greeting or a state; empty when it says none.
std::string_view told_error(const char* message, std::size_t size) noexcept;

enum class StateFlaw { kNone, kSize, kNumber, kNotFinite, kOutside, kBackwards };

/// Real-time safe. @param greeting without flaw. @param size bytes that came, of which `state` has
/// the first ones. @param number of the last force. @param time of the state before.
StateFlaw state_flaw(const hapgrid_device_greeting& greeting, const hapgrid_device_state& state,
                     std::size_t size, std::uint32_t number, double time) noexcept;

}  // namespace hapgrid
