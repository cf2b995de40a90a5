// Trajectories and the summary of a stream.
#include "libcore/scene/trajectory.hpp"

#include <catch2/catch.hpp>
#include <limits>

#include "tests/unit/scene/scenes.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

TEST_CASE("a frame as PDB, by its columns") {
  const Scene scene = small_scene();
  Frame frame = small_frame(0);
  frame.hip = {1.5, -2, 1e-9};
  frame.centres[3] = -999.999F;
  std::string text;
  append_pdb(text, scene, frame, "", 12);
  // wwPDB 3.3: serial 7-11, name 13-16, residue 18-20, chain 22, its number 23-26, x 31-38, y
  // 39-46, z 47-54, occupancy 55-60, B 61-66, element 77-78.
  CHECK(text ==
        "MODEL       12\n"
        "REMARK   3 time=0 tick=0 hip=1.5,-2,1e-09 force=0,0,-0\n"
        "HETATM    1  O1  MOL A   1       0.000   1.000   2.000  1.00  0.00           O\n"
        "HETATM    2  X2  MOL A   1    -999.999   4.000   5.000  1.00  0.00           X\n"
        "HETATM    3 NA3  MOL A   1       6.000   7.000   0.000  1.00  0.00          NA\n"
        "ENDMDL\n");
  for (const float x : {std::numeric_limits<float>::infinity(), -1000.0F, 10000.0F,
                        std::numeric_limits<float>::quiet_NaN()}) {
    frame.centres[4] = x;
    CHECK_THROWS_WITH(append_pdb(text, scene, frame, "", 1),
                      "a coordinate is not a number from -999.999 to 9999.999, as PDB needs it");
  }
}

TEST_CASE("the bonds of a PDB file, four in a line") {
  Scene scene = small_scene();
  scene.spheres.assign(7, scene.spheres[0]);
  for (Sphere& sphere : scene.spheres) sphere.radius = 1;
  scene.spheres[6].radius = 0.1;  // and far away
  Frame frame = small_frame(0);
  // The first sphere is 1 from five others, which are sqrt(2) or more from each other: bonds are
  // below 1.2.
  frame.centres = {0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 9, 9, 9};
  std::string text;
  append_pdb_bonds(text, scene, frame);
  // wwPDB 3.3: the atom's serial 7-11, its partners 12-16, 17-21, 22-26, 27-31.
  CHECK(text ==
        "CONECT    1    2    3    4    5\n"
        "CONECT    1    6\n"
        "CONECT    2    1\n"
        "CONECT    3    1\n"
        "CONECT    4    1\n"
        "CONECT    5    1\n"
        "CONECT    6    1\n");
}

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
