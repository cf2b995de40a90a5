// The shapes in a picture of one frame: the spheres, the HIP, the force and the box, seen along
// parallel rays. render() draws them without a display; view's page draws the same in a browser.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libcore/grid/vec3.hpp"
#include "libcore/scene/scene.hpp"

namespace hapgrid {

// Finds the spheres of a picture that sticks join.
//
// A model's shape is a list of spheres without bonds. As in molecular viewers, two atoms are joined
// if they are near each other, and two other spheres if they overlap deeply.

/// Pairs i < j of spheres, ascending: of atoms, which are spheres with an element's symbol in a
/// model in angstrom, those whose distance is below 1.25 of the sum of their covalent radii
/// (B. Cordero et al., Dalton Trans. 2832, 2008); of others those whose distance is below 0.6 of
/// the sum of their radii. There are none among more than 4,096 spheres, because each frame
/// compares all pairs.
std::vector<std::array<std::uint32_t, 2>> find_bonds(const Scene& scene, const Frame& frame);

/// A parallel projection. At azimuth and elevation 0 it looks along +y: x points right, and z up. A
/// positive azimuth takes the viewer counterclockwise around z, at 90 degrees to +x; a positive
/// elevation lifts the viewer.
struct Camera {
  double azimuth_degrees = 30;
  double elevation_degrees = 20;
  Vec3 centre{0, 0, 0};   ///< in the middle of the picture; in the model's space and unit
  double half_width = 1;  ///< from the middle to the nearer edges, in the model's unit of length

  // The picture's axes in the model's space: to the right, up, towards the viewer.
  Vec3 right() const;
  Vec3 up() const;
  Vec3 near() const;
};

/// Red, green, blue in [0, 1].
using Colour = std::array<float, 3>;

/// A band around a line: all points nearer to it than half_width in x and y. The depth of such a
/// point is that of the nearest point on the line.
struct Line {
  Vec3 from;
  Vec3 to;
  double half_width;
  Colour colour;
};

struct RenderOptions {
  int width = 800;
  int height = 600;
  double azimuth_degrees = Camera{}.azimuth_degrees;  ///< of the camera that fit_camera() makes
  double elevation_degrees = Camera{}.elevation_degrees;
  int supersampling = 3;  ///< rays a pixel and axis
  bool box = true;
  bool hip = true;      ///< with the force
  bool legend = true;   ///< the axes, a scale bar and the names of torsions that have turned
  bool letters = true;  ///< whether render() writes its texts
  int letter_scale = 1;
  bool sticks = false;  ///< smaller balls, and sticks between those that are joined (bonds.hpp)
  bool flash = false;   ///< rings at the HIP, because the model snapped
  /// The lowest and the highest coordinates of what the pictures of a play show of the HIP and its
  /// force, to which the camera is fitted; without it to the whole box.
  std::optional<std::array<Vec3, 2>> way = std::nullopt;
};
/// Puts a frame's HIP and arrow on the way.
void add_to_way(const Scene& scene, const Frame& frame, RenderOptions& options);

/// Parts of the radius of a sphere, and of the smaller of two, in the style of balls and sticks.
/// Whole spheres that are joined and leave a gap have sticks between them that are as thick beside
/// them.
inline constexpr double kBallPart = 0.25;
inline constexpr double kStickPart = 0.12;

/// The radius of the ball at the HIP: the scene's, or a 40th of the box's longest side.
double hip_radius(const Scene& scene);
/// Of the arrow that shows the frame's force, from the HIP's surface on: its length, the radius of
/// its shaft, and radius and length of its head, which grows with the force. All zero without one.
/// The grid's largest force is a quarter of the box's longest side long; where it is not known, a
/// newton is a sixth.
std::array<double, 4> arrow_sizes(const Scene& scene, const Frame& frame);

// No element has these colours in the usual schemes.
inline constexpr Colour kHipColour{0.85F, 0.1F, 0.55F};
inline constexpr Colour kForceColour{0, 0.5F, 0.45F};
inline constexpr Colour kSnapColour{0.69F, 0.33F, 0.02F};
inline constexpr Colour kEnergyColour{0.1176F, 0.3529F, 0.7451F};

inline constexpr Colour kBoxColour{0.52F, 0.55F, 0.6F};

/// Half the width of the box's edges, in pixels.
inline constexpr double kLinePixels = 0.6;
/// The same of the ring at the hand, of the thread and of the rings of a snap.
inline constexpr double kHandPixels = 1;
/// Pixels of the ring around the hand, and how far outside the HIP the rings of a snap are.
inline constexpr double kRingPixels = 9;
inline constexpr std::array<double, 2> kFlashPixels{4, 10};
/// How many radii of a ball its shadow on the floor has.
inline constexpr double kShadowRadii = 2;

inline constexpr Colour kBackground{1, 1, 1};
inline constexpr Colour kInk{0.16F, 0.17F, 0.2F};
inline constexpr float kHipOpacity = 0.6F;
/// Opacity of the HIP where something stands before it, so that the HIP is never hidden.
inline constexpr float kHiddenOpacity = 0.5F;
/// Of the whole spheres that touch the HIP, which are drawn over sticks while there is a force.
inline constexpr float kTouchedOpacity = 0.3F;
/// How near a sphere is that touches the HIP, in sums of both radii: a model may let them be a
/// little apart.
inline constexpr double kTouch = 1.05;

// Coordinates and lengths in a drawing are in distances of neighbouring rays: x to the right and y
// down from the picture's upper left corner, z towards the viewer from the camera's centre. Each
// ray goes through the middle of its square: the ray of column i is at x = i + 1/2.

struct Ball {
  Vec3 centre;
  double radius;
  Colour colour;
  Vec3 cut{0, 0, 0};  ///< a direction: only the half ball on that side of the centre is drawn
};

/// What a ball darkens of the box's floor: an ellipse, which fades to its rim.
struct Shadow {
  std::array<double, 2> centre;
  std::array<double, 2> half_axes;
};

/// A text in a picture, in pixels from the picture's upper left corner.
struct Label {
  std::string text;
  std::array<double, 2> left;  ///< the text's left end, at the middle of its height
};

struct Drawing {
  std::vector<Line> lines;        ///< the box
  std::vector<Ball> balls;        ///< the spheres; sticks and the arrow are rows of balls
  std::size_t spheres = 0;        ///< the first of the balls: they darken each other
  std::vector<Ball> touched;      ///< spheres, with kTouchedOpacity
  std::vector<Ball> translucent;  ///< the HIP, with kHipOpacity, or kHiddenOpacity behind the rest
  std::vector<Line> overlay;      ///< drawn over everything else, in this order
  std::vector<Label> labels;      ///< over all of that
  std::vector<Shadow> shadows;    ///< on the floor
  /// A corner of the floor in x and y, and its two sides; all zero where it is seen from below.
  std::array<std::array<double, 2>, 3> floor{};
  double nearest = 0;  ///< z of the nearest and the farthest corner of the box or centre of a ball
  double farthest = 0;
};

/// The lengths, to the right and up from the middle of the picture, that the whole box and all
/// spheres of the frame need at the options' angles, with a margin and room for the HIP; and how
/// far the spheres reach to the right. Sets the camera's angles, and its centre to that middle. The
/// HIP is held in the box, so that no picture has to grow while a hand pushes.
std::array<double, 3> fit_extent(const Scene& scene, const Frame& frame,
                                 const RenderOptions& options, Camera& camera);

/// The camera that shows all of that, with room for the names of torsions.
Camera fit_camera(const Scene& scene, const Frame& frame, const RenderOptions& options);

/// The picture of `frame`. Spheres without a finite centre are left out; the HIP is drawn where it
/// is held in the box.
Drawing draw(const Scene& scene, const Frame& frame, const Camera& camera,
             const RenderOptions& options);

}  // namespace hapgrid
