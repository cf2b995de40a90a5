// A play as one web page that can be sent: the scene in 3-D, which one can turn, a slider for the
// time, the curves of force and energy, and marks where the state snapped. Nothing is loaded from
// elsewhere: three.js and the numbers are in the page.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "libcore/scene/drawing.hpp"
#include "libcore/scene/scene.hpp"

namespace hapgrid {

class Page {
 public:
  /// Takes a frame of the scene. Some 12 bytes a sphere and 50 more are kept, and four thirds of
  /// them written.
  void add(const Frame& frame);
  /// The page. @param options give the lengths of the arrow and of the HIP's radius.
  std::string finish(const Scene& scene, const RenderOptions& options, double azimuth_degrees,
                     double elevation_degrees) const;

 private:
  std::vector<double> times_;  // seconds of play
  std::vector<float> hips_;    // held in the box, x y z by frame
  std::vector<float> forces_;
  std::vector<float> energies_;
  std::vector<float> own_energies_;  // of the model itself
  std::vector<float> turned_;        // degrees, by torsion and frame
  std::vector<float> centres_;
  std::vector<std::size_t> snaps_;  // the first frames after a snap
  std::uint64_t jumps_ = 0;
};

}  // namespace hapgrid
