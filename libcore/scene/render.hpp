// A picture of one frame, computed without a display: lit spheres, the HIP, the force, the box.
//
// All spheres are seen along parallel rays, so each covers a disc of pixels, and its depth there
// has a closed form: every primitive is drawn into a buffer of depths and the nearest one stays.
// That needs no ray to search for what it hits, and the cost is what is covered. A window or a
// terminal draws the same picture with other sizes: render() depends on its arguments alone.
#pragma once

#include "libcore/scene/image.hpp"
#include "libcore/scene/scene.hpp"

namespace hapgrid {

/// A parallel projection. At azimuth and elevation 0 it looks along +y: x goes to the right, z up.
/// A positive azimuth takes the viewer counterclockwise around z (at 90 degrees he stands at +x), a
/// positive elevation lifts him.
struct Camera {
  double azimuth_degrees = 30;
  double elevation_degrees = 20;
  Vec3 centre{0, 0, 0};   ///< what is in the middle of the picture
  double half_width = 1;  ///< model's units from the middle to the nearer edges
};

struct RenderOptions {
  int width = 800;
  int height = 600;
  int supersampling = 3;  ///< rays a pixel and axis
  double hip_radius = 0;  ///< 0: the scene's own, or a 40th of the box's longest side
  double arrow = 0;       ///< length of a newton; 0: a sixth of the box's longest side
  bool box = true;
  bool hip = true;  ///< with the force
};

/// The camera in these angles that sees the box, the spheres, the HIP, and the arrow as a whole.
Camera fit_camera(const Scene& scene, const Frame& frame, const RenderOptions& options,
                  double azimuth_degrees, double elevation_degrees);

/// Draws `frame` on white. Spheres that are not in a finite place are left out; the HIP stands
/// where it is held in the box. It is translucent: what is behind it shines through.
Image render(const Scene& scene, const Frame& frame, const Camera& camera,
             const RenderOptions& options);

}  // namespace hapgrid
