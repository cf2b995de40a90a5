// The TOML of a simulated hand; hands.cpp describes it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "libcore/loop/mapping.hpp"
#include "tests/bench/simulated.hpp"
#include "tests/bench/wandering.hpp"

namespace hapgrid {

struct Simulation {
  SimulatedOptions device;
  double tremor = 0;      ///< of the hand: amplitude on each axis, m
  WanderingOptions hand;  ///< of a hand that moves at random
  std::vector<Vec3>
      path;            ///< of a hand that follows a path, in the box's axes and unit; else empty
  bool truth = false;  ///< the model runs beside what is played, and forces are compared
};

/// @param rate_hz ticks a second.
/// @throw Error "NAME: line N: ..." for anything but such a TOML, or when its path is none;
/// std::system_error
Simulation read_simulation(const std::string& file, double rate_hz);

/// A device whose hand moves in `box`, as `mapping` maps the one to the other.
std::unique_ptr<SimulatedDevice> simulated_device(const Simulation& simulation,
                                                  const Mapping& mapping, const Box& box);

}  // namespace hapgrid
