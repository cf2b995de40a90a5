// Writes the pixels of two pictures with all that a picture can have; bytes.sh compares what
// differently compiled programs write.
#include <cstdio>

#include "libcore/scene/render.hpp"

using namespace hapgrid;

namespace {

/// Scattered balls, of which the first four are a torsion, and a hand that pulls the HIP.
Scene scattered(Frame& frame) {
  Scene scene;
  scene.length_unit = "angstrom";
  scene.box = {{-3, -3, -3}, 0.5, {13, 13, 13}};
  scene.hip_radius = 0.7;
  for (int i = 0; i < 24; ++i) {
    const auto at = [&](int step, int places) {
      return 3 * static_cast<float>(step * i % places) / static_cast<float>(places) - 1.5F;
    };
    scene.spheres.push_back({0.5F + 0.1F * at(5, 7), {0.5F + 0.3F * at(3, 5), 0.5F, 0.3F}, "C"});
    frame.centres.insert(frame.centres.end(), {at(7, 23), at(11, 19), at(3, 17)});
  }
  scene.torsions.push_back({.spheres = {0, 1, 2, 3}, .name = "C1-C2-C3-C4"});
  frame.turned = frame.angles = {67};
  frame.position = {1.1, -2.1, 0.3};
  frame.hand = {1.9, -2.3, 1.7};
  frame.force = {0.3, -0.7, 0.2};
  return scene;
}

}  // namespace

int main() {
  Frame frame;
  const Scene scene = scattered(frame);
  for (const bool sticks : {false, true}) {
    RenderOptions how{.width = 320,
                      .height = 240,
                      .azimuth_degrees = 37,
                      .elevation_degrees = 23,
                      .sticks = sticks,
                      .flash = sticks};
    const Image image = render(scene, frame, fit_camera(scene, frame, how), how);
    std::fwrite(image.pixels.data(), 3, image.pixels.size(), stdout);
  }
}
