// Trajectories.
#include "tools/view/trajectory.hpp"

#include "tests/unit/catch.hpp"
#include "tests/unit/scene/scenes.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

TEST_CASE("labels that XYZ cannot have become X") {
  for (const char* label : {"C", "Cl", "CA1"}) CHECK(is_symbol(label));
  for (const char* label : {"", "1", "C a", "C\n1", "-", "\xc3\xa4", "C\t"})
    CHECK_FALSE(is_symbol(label));
  Scene scene = small_scene();
  scene.spheres[0].label = "O\n1";
  std::string text;
  append_xyz(text, scene, small_frame(0), "");
  CHECK(text.find("\nX 0.000000 1") != text.npos);
}
