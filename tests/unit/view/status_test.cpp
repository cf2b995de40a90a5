// The line of numbers.
#include "tools/view/status.hpp"

#include "tests/unit/catch.hpp"

using namespace hapgrid;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Frame frame_at(double time_s, Vec3 force = {0, 0, 0}, double energy = kNan) {
  Frame frame;
  frame.time_s = time_s;
  frame.force = force;
  frame.energy = energy;
  return frame;
}

}  // namespace

TEST_CASE("the numbers as a line") {
  Scene scene;
  scene.energy_unit = "kJ/mol";
  Frame frame = frame_at(3.2, {0.3, 0, 0.4}, 12.345);
  CHECK(status_text(scene, frame) == "t 3.20 s   force 0.5 N   energy 12.3 kJ/mol");
  frame.energy = kNan;
  CHECK(status_text(scene, frame) == "t 3.20 s   force 0.5 N");
  // The model's own energy, and the torsion that has turned farthest.
  scene.torsions = {{{}, "phi"}, {{}, "psi"}, {{}, "chi"}};
  frame.energy = 12.345;
  frame.own_energy = 9.06;
  frame.angles = {-70, 66.7, kNan};
  frame.turned = {-20, 166.7, kNan};
  CHECK(status_text(scene, frame) ==
        "t 3.20 s   force 0.5 N   energy 9.06 kJ/mol of the model alone, 12.3 with the hand   "
        "psi +67°");
  frame.own_energy = kNan;
  frame.turned = {9, -9, kNan};
  CHECK(status_text(scene, frame) == "t 3.20 s   force 0.5 N   energy 12.3 kJ/mol");
  // Strings and numbers of a stream are hostile.
  scene.energy_unit = "\033[2J\n";
  frame.energy = -1e-7;
  frame.force = {1e150, 1e150, 1e150};
  frame.time_s = 1e300;
  CHECK(status_text(scene, frame) == "t 1e+300 s   force 1.73e+150 N   energy -1e-07  [2J ");
}
