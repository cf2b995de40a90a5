// A small scene and its frames.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <limits>
#include <span>
#include <stdexcept>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/scene/scene.hpp"
#include "libcore/scene/stream.hpp"

namespace hapgrid::testing {

inline Scene small_scene() {
  Scene scene;
  scene.model = "spring";
  scene.length_unit = "angstrom";
  scene.energy_unit = "kJ/mol";
  scene.box = {{-1, -2, -3}, 0.5, {5, 9, 13}};
  scene.state_size = 2;
  scene.hip_radius = 0.25;
  scene.spheres = {{1.5F, {1, 0, 0}, "O"}, {1, {0.5F, 0.5F, 1}, ""}, {0, {0, 0, 0}, "Na"}};
  scene.keys = "q: end";
  return scene;
}

inline const Scene kScene = small_scene();

inline Frame small_frame(std::uint64_t tick) {
  const auto t = static_cast<double>(tick);
  Frame frame;
  frame.tick = tick;
  frame.time_s = t / 1000;
  frame.hip = {t, -1e300, std::numeric_limits<double>::infinity()};
  frame.position = {0.5, -2, 3};
  frame.force = {0, 0, -t / 3};
  frame.jumps = tick / 2;
  frame.row = {t, 0.1};
  frame.energy = t == 0 ? std::numeric_limits<double>::quiet_NaN() : -t;
  frame.own_energy = t == 0 ? frame.own_energy : t / 7;
  frame.centres = {0, 1, 2, 3, 4, 5, 6, 7, static_cast<float>(t)};
  return frame;
}

inline void append(std::vector<std::byte>& bytes, std::span<const std::byte> more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

/// A file without a name that holds `bytes`, to be read from its start.
inline FileDescriptor file_of(std::span<const std::byte> bytes) {
  FileDescriptor file(::memfd_create("frames", 0));
  if (!file ||
      ::write(file.get(), bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size()) ||
      ::lseek(file.get(), 0, SEEK_SET) != 0)
    throw std::runtime_error("memfd");
  return file;
}

}  // namespace hapgrid::testing
