// Writes the pixels of two pictures with all that a picture can have; bytes.sh compares what
// differently compiled programs write.
#include <cmath>
#include <cstdio>

#include "libcore/scene/render.hpp"

using namespace hapgrid;

namespace {

/// Balls on a screw, of which the first four are a torsion, and a hand that pulls the HIP.
Scene screw(Frame& frame) {
  Scene scene{
      .length_unit = "angstrom", .box = {{-3, -3, -3}, 0.5, {13, 13, 13}}, .hip_radius = 0.7};
  for (int i = 0; i < 24; ++i) {
    const float t = 0.7F * static_cast<float>(i);
    scene.spheres.push_back(
        {0.4F + 0.02F * static_cast<float>(i), {0.04F * static_cast<float>(i), 0.5F, 0.3F}, "C"});
    frame.centres.insert(frame.centres.end(), {1.5F * std::cos(t), 1.5F * std::sin(t),
                                               0.2F * static_cast<float>(i) - 2.4F});
  }
  scene.torsions.push_back({.spheres = {0, 1, 2, 3}, .name = "C1-C2-C3-C4"});
  frame.turned = {1.1};
  frame.position = {1.1, -2.1, 0.3};
  frame.hand = {1.9, -2.3, 1.7};
  frame.force = {0.3, -0.7, 0.2};
  return scene;
}

}  // namespace

int main() {
  Frame frame;
  const Scene scene = screw(frame);
  for (const bool sticks : {false, true}) {
    RenderOptions how{.width = 320, .height = 240, .sticks = sticks, .flash = sticks};
    const Image image = render(scene, frame, fit_camera(scene, frame, how, 37, 23), how);
    std::fwrite(image.pixels.data(), 3, image.pixels.size(), stdout);
  }
}
