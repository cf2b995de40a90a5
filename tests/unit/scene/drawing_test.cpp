// What a picture is made of, before it has pixels.
#include "libcore/scene/drawing.hpp"

#include "libcore/scene/scene.hpp"
#include "tests/unit/catch.hpp"

using namespace hapgrid;

namespace {

Scene scene_of(const std::vector<float>& radii) {
  Scene scene;
  scene.box = {{-10, -10, -10}, 10, {3, 3, 3}};
  for (const float radius : radii) scene.spheres.push_back({radius, {0, 1, 0}, ""});
  return scene;
}

}  // namespace

TEST_CASE("between sticks, the spheres that touch the HIP from outside are whole") {
  Scene scene = scene_of({0.4F, 0.4F});
  scene.hip_radius = 0.1;
  Frame frame;
  frame.centres = {0.5F, 0, 0, -0.8F, 0, 0};
  RenderOptions options{.sticks = true};
  const Camera camera{0, 0, {0, 0, 0}, 1.5};
  const auto touched = [&] { return draw(scene, frame, camera, options).touched; };
  CHECK(touched().empty());  // no force acts
  frame.force = {-1, 0, 0};
  REQUIRE(touched().size() == 1);
  // 600 x 3 rays are 3 units high, and the picture's middle is at 400 x 3 of them.
  CHECK(touched()[0].radius == Approx(600 * 0.4F));
  CHECK(touched()[0].centre[0] == Approx(1200 + 600 * 0.5).margin(1));
  frame.position = {0.3, 0, 0};  // it holds the first one
  CHECK(touched().empty());
  options.sticks = false;
  frame.position = {0, 0, 0};
  CHECK(touched().empty());
}

TEST_CASE("the pictures of a play show the spheres and where the HIP is, not the whole box") {
  Scene scene = scene_of({0.5F});
  scene.hip_radius = 0.2;
  Frame frame;
  frame.centres = {0, 0, 0};
  RenderOptions options{
      .width = 300, .height = 300, .azimuth_degrees = 0, .elevation_degrees = 0, .legend = false};
  CHECK(fit_camera(scene, frame, options).half_width == Approx(1.06 * 10.2));
  for (const double x : {2.0, -1.0}) {
    frame.position = {x, 0, 0};
    add_to_way(scene, frame, options);
  }
  // From -1.2 to 2.2.
  const Camera camera = fit_camera(scene, frame, options);
  CHECK(camera.half_width == Approx(1.06 * 1.7));
  CHECK(camera.centre[0] == Approx(0.5));
}
