// A picture of one frame, computed without a display: lit spheres, the HIP, the force, the box.
//
// All spheres are seen along parallel rays, so each covers a disc of pixels, and its depth there
// has a closed form: every shape is drawn into a buffer of depths, and the nearest one stays. No
// ray has to search for the sphere that it hits, and the cost grows with the pixels covered.
// render() depends on its arguments alone.
#pragma once

#include "libcore/scene/drawing.hpp"
#include "libcore/scene/image.hpp"
#include "libcore/scene/scene.hpp"

namespace hapgrid {

/// Draws `frame` on white. Spheres without a finite centre are left out; the HIP is drawn where it
/// is held in the box. It is translucent: spheres behind it shine through, and it shines through
/// the spheres before it.
Image render(const Scene& scene, const Frame& frame, const Camera& camera,
             const RenderOptions& options);

}  // namespace hapgrid
