// The picture: silhouettes, occlusion, colours, what is fitted into it.
#include "libcore/scene/render.hpp"

#include "libcore/scene/drawing.hpp"
#include "libcore/scene/legend.hpp"
#include "libcore/scene/letters.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/scene/scenes.hpp"

using namespace hapgrid;

namespace {

constexpr Rgb kWhite{255, 255, 255};

/// Spheres alone, seen along +y, 100 pixels a unit.
struct Stage {
  Scene scene;
  Frame frame;
  RenderOptions options{.width = 200, .height = 100, .box = false, .hip = false};
  Camera camera{.azimuth_degrees = 0, .elevation_degrees = 0, .half_width = 0.5};

  void add(float x, float y, float z, float radius, std::array<float, 3> colour) {
    scene.spheres.push_back({radius, colour, ""});
    frame.centres.insert(frame.centres.end(), {x, y, z});
  }
  Image render() const { return hapgrid::render(scene, frame, camera, options); }
};

bool reddish(const Rgb& p) { return p[0] > p[1] + 40 && p[0] > p[2] + 40; }
bool greenish(const Rgb& p) { return p[1] > p[0] + 40 && p[1] > p[2] + 40; }
// The colours of the HIP and of the force.
// The HIP is translucent, and its darkest side has 0.44 of the light: 50 more red than green, and
// 30 more blue.
bool pinkish(const Rgb& p) { return p[0] > p[1] + 45 && p[2] > p[1] + 25; }
bool tealish(const Rgb& p) { return p[1] > p[0] + 40 && p[2] > p[0] + 40; }

}  // namespace

TEST_CASE("the nearer sphere hides the other, in whichever order they come") {
  for (const bool swapped : {false, true}) {
    Stage stage;
    const auto red = [&] { stage.add(0, -1, 0, 0.2F, {1, 0, 0}); };  // nearer: smaller y
    const auto green = [&] { stage.add(0, 1, 0, 0.4F, {0, 1, 0}); };
    swapped ? (green(), red()) : (red(), green());
    const Image front = stage.render();
    CHECK(reddish(front.at(100, 50)));
    CHECK(greenish(front.at(100 + 30, 50)));
    CHECK(front.at(100 + 45, 50) == kWhite);
    stage.camera.azimuth_degrees = 180;  // from behind: the large one is all that is seen
    const Image back = stage.render();
    for (const Rgb& pixel : back.pixels) CHECK_FALSE(reddish(pixel));
    CHECK(greenish(back.at(100, 50)));
    stage.camera = {.azimuth_degrees = 90, .elevation_degrees = 0, .half_width = 2};
    const Image side = stage.render();  // from +x: y to the right, 25 pixels a unit
    CHECK(reddish(side.at(100 - 25, 50)));
    CHECK(greenish(side.at(100 + 25, 50)));
  }
}

TEST_CASE("the picture does not depend on where its bands are cut") {
  // The same scene in the upper part of a higher picture.
  Stage stage;
  stage.options.width = 100;
  stage.add(0, 0, 0, 0.4F, {1, 0.5F, 0});
  stage.add(0.2F, -1, 0.1F, 0.2F, {0, 0.5F, 1});
  const Image low = stage.render();
  stage.options.height = 220;  // the middle goes down by 60 pixels
  const Image high = stage.render();
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x) REQUIRE(low.at(x, y) == high.at(x, y + 60));
}

TEST_CASE("HIP, force and box are there, and can be left out") {
  Stage stage;
  stage.scene.box = {{-1, -1, -1}, 1, {3, 3, 3}};
  stage.frame.position = {0, 0, 0};
  stage.frame.force = {0, 0, 1};
  stage.scene.hip_radius = 0.2;
  stage.options = {.width = 300, .height = 300, .azimuth_degrees = 0, .elevation_degrees = 0};
  stage.camera = fit_camera(stage.scene, stage.frame, stage.options);
  CHECK(stage.camera.half_width == Approx(1.06 * 1.2));
  const auto pixel = [&](double u) { return static_cast<int>(150 + u * 150 / (1.06 * 1.2)); };
  Image image = stage.render();
  CHECK(pinkish(image.at(pixel(0.15), 150)));
  CHECK(pinkish(image.at(150, pixel(-0.15))));   // the force is outside of it
  CHECK(tealish(image.at(150, pixel(-0.35))));   // the shaft, up
  CHECK(image.at(150, pixel(-0.75)) == kWhite);  // beyond the tip
  CHECK(image.at(150, pixel(1)) != kWhite);      // the box's edge
  CHECK(image.at(pixel(-1), 150) != kWhite);
  CHECK(image.at(pixel(0.6), pixel(0.6)) == kWhite);
  // What is behind the HIP shines through, and what is in front fades before it.
  stage.add(0, 0.5F, 0, 0.3F, {0, 1, 0});
  image = stage.render();
  CHECK(image.at(pixel(0.12), 150)[0] > 90);
  CHECK(image.at(pixel(0.12), 150)[1] > 70);
  CHECK(tealish(image.at(150, pixel(-0.35))));
  stage.frame.centres[1] = -0.5F;
  image = stage.render();
  const Rgb faded = image.at(pixel(0.12), 150), whole = image.at(pixel(0.25), 150);
  CHECK(faded[0] > whole[0] + 45);  // the HIP's red is seen
  CHECK(faded[1] > 90);             // and the sphere's green
  CHECK(greenish(whole));           // beside the HIP nothing fades
  stage.scene.spheres.clear();
  stage.options.box = stage.options.hip = false;
  stage.options.legend = false;
  for (const Rgb& p : stage.render().pixels) REQUIRE(p == kWhite);
}

TEST_CASE("the legend says where the axes point and how long things are, in front of all") {
  Stage stage;
  stage.scene.box = {{-1, -1, -1}, 1, {3, 3, 3}};
  stage.scene.length_unit = "nm";
  stage.options = {.width = 300, .height = 300, .hip = false, .letters = false};
  stage.camera = {0, 0, {0, 0, 0}, 1.5};  // 100 pixels a unit
  stage.add(-1.3F, 0, -1.3F, 0.5F, {0, 1, 0});
  const Image image = stage.render();
  const auto dark = [&](int x, int y) {
    return image.at(x, y)[1] < 120 && std::abs(image.at(x, y)[0] - image.at(x, y)[1]) < 20;
  };
  // A quarter of the width is 0.75 units: the bar has 0.5, from 10 pixels off the corner.
  for (int x = 12; x < 58; ++x) REQUIRE((dark(x, 289) || dark(x, 290)));
  CHECK_FALSE((dark(65, 289) || dark(65, 290)));
  const auto legend = [&] { return draw(stage.scene, stage.frame, stage.camera, stage.options); };
  const Drawing drawn = legend();
  const std::vector<Label>& labels = drawn.labels;
  REQUIRE(labels.size() == 3);
  CHECK(labels[0].text == "0.5 nm");
  // From the front x points right and z up; y points away from the viewer, and is left out.
  CHECK(labels[1].text == "x");
  CHECK(labels[2].text == "z");
  CHECK(labels[1].left[0] > labels[2].left[0] + 20);
  CHECK(labels[2].left[1] < labels[1].left[1] - 20);
  // The bar with its ends, then each axis: a part of 0.12 of the picture.
  REQUIRE(drawn.overlay.size() == 5);
  for (const std::size_t line : {3, 4})  // three rays a pixel
    CHECK(length_of(drawn.overlay[line].to - drawn.overlay[line].from) == Approx(3 * 36));
  stage.scene.length_unit = "angstrom";
  CHECK(legend().labels[0].text == "0.5 Å");
  CHECK(letters_width("5 Å, 7°, \u03b1") == 10 * kLetterWidth);
  // Letters have their own ink, inside of the picture and as wide as they say.
  const auto ink = [](const char* text, double x) {
    Image paper{30, 20, std::vector<Rgb>(600, kWhite)};
    draw_labels(paper, {{text, {x, 10}}}, 1);
    return paper;
  };
  CHECK(ink("Å", 5).pixels != ink("A", 5).pixels);
  CHECK(ink("A", 5).pixels != ink("", 0).pixels);
  CHECK(ink("iiiA", -21).pixels != ink("iii", -21).pixels);  // the last letter alone is seen
  CHECK(ink("iii", -21).pixels == ink("", 0).pixels);
  CHECK(ink("A", 1e300).pixels == ink("", 0).pixels);
  // Letters add to it, and a small picture has no legend.
  stage.options.letters = true;
  CHECK(stage.render().pixels != image.pixels);
  stage.options.height = 100;
  CHECK(legend().labels.empty());
}

TEST_CASE("neighbours darken each other, as far as the closed form says") {
  // A ball of radius 1 at the origin, and five in one place on top of it.
  Stage stage;
  stage.options = {
      .width = 200, .height = 200, .supersampling = 1, .box = false, .hip = false, .legend = false};
  stage.camera = {.azimuth_degrees = 0, .elevation_degrees = 0, .half_width = 2};
  stage.add(0, 0, 0, 1, {0.5F, 0.5F, 0.5F});
  const Image alone = stage.render();
  for (int i = 0; i < 5; ++i) stage.add(0, 0, 2, 1, {0.5F, 0.5F, 0.5F});
  const Image both = stage.render();
  // The pixel just below the others: 47.5 of 50 pixels above the middle.
  const double x = 0.01, z = 0.95, y = -std::sqrt(1 - x * x - z * z);
  const double away = std::hypot(x, y, 2 - z);
  const double above = 0.5 + 0.5 * (-x * x - y * y + z * (2 - z)) / away;
  const double sum = 5 * std::pow(above, 1.5) * (std::min(1.0, 1 / (away * away)) - 1 / 16.0);
  const double part = 1.45 * std::exp(-0.33 * sum) / 1.05;
  REQUIRE(part < 0.7);
  // exp() is replaced by a power that is off by 4 % here, of at most 131.
  CHECK(int{both.at(100, 52)[0]} == Approx(part * alone.at(100, 52)[0]).margin(5));
}

TEST_CASE("what lies deeper is paler, and a ball before another has a dark rim") {
  Stage stage;
  stage.scene.box = {{-1, -3, -1}, 1, {3, 7, 3}};
  stage.options = {.width = 200, .height = 200, .supersampling = 1, .hip = false, .legend = false};
  stage.camera = {.azimuth_degrees = 0, .elevation_degrees = 0, .half_width = 2};
  stage.add(0, -3, 0, 0.5F, {0.4F, 0.4F, 0.4F});
  stage.add(0, 3, 0, 0.9F, {0.4F, 0.4F, 0.4F});
  const Image image = stage.render();
  // At x = 0.7, 35 pixels from the middle, the farther one is seen: 35 % of white, of what is dark.
  CHECK(image.at(100 + 35, 100)[0] > image.at(100, 100)[0] + 20);
  CHECK(image.at(100 + 25, 100)[0] < 60);  // the rim: a quarter of the colour
}

TEST_CASE("the floor has the shadows of what is above it, seen from above") {
  Stage stage;
  stage.scene.box = {{-1, -1, -1}, 1, {3, 3, 3}};
  stage.options = {.width = 200, .height = 200, .supersampling = 1, .hip = false, .legend = false};
  stage.camera = {.azimuth_degrees = 0, .elevation_degrees = 60, .half_width = 2};
  const Image empty = stage.render();
  CHECK(empty.at(100, 100 + 25)[0] == 247);  // the middle of the floor is cos(60) below: 0.5 units
  stage.add(0, 0, 1, 0.2F, {1, 0, 0});
  CHECK(stage.render().at(100, 100 + 25)[0] == Approx(247 * 0.76).margin(2));
  // Two shadows are one, which is nowhere darker: between two balls there is no lighter lump. At u
  // radii from a middle, of which a shadow has two, a ball leaves 1 - (1 - u^2 / 4)^2 of the light.
  stage.scene.spheres.clear();
  stage.frame.centres.clear();
  for (const float x : {-0.1F, 0.1F}) stage.add(x, 0, 1, 0.2F, {1, 0, 0});
  const double left = std::pow(1 - std::pow(1 - 0.25 * 0.25, 2), 2);
  CHECK(stage.render().at(100, 100 + 25)[0] == Approx(247 * (1 - 0.24 * (1 - left))).margin(2));
  stage.camera.elevation_degrees = -60;
  CHECK(stage.render().at(100, 100 + 25) == kWhite);
}

TEST_CASE("a hand is a ring, and a thread to the HIP") {
  Stage stage;
  stage.scene.box = {{-1, -1, -1}, 1, {3, 3, 3}};
  stage.scene.hip_radius = 0.1;
  stage.options = {.width = 200, .height = 200, .box = false, .legend = false};
  stage.camera = {.azimuth_degrees = 0, .elevation_degrees = 0, .half_width = 2};
  stage.frame.position = {0, 0, 0};
  CHECK(stage.render().at(130, 100) == kWhite);
  stage.frame.hand = {1, 0, 0};
  const Image image = stage.render();
  CHECK(pinkish(image.at(130, 100)));      // the thread
  CHECK(pinkish(image.at(150, 100 - 9)));  // the ring
  CHECK(image.at(150, 100) == kWhite);     // its inside
}

TEST_CASE("balls and sticks") {
  Stage stage;
  stage.options.sticks = true;
  // 0.2 apart with radii of 0.2: 0.5 of the sum. The third is farther away than 0.6 of it.
  stage.add(-0.1F, 0, 0, 0.2F, {1, 0, 0});
  stage.add(0.1F, 0, 0, 0.2F, {0, 1, 0});
  stage.add(0.1F, 0, 0.26F, 0.2F, {0, 0, 1});
  const std::vector<std::array<std::uint32_t, 2>> bonds{{0, 1}};
  CHECK(find_bonds(stage.scene, stage.frame) == bonds);
  const Image image = stage.render();  // 100 pixels a unit
  CHECK(reddish(image.at(90, 50)));
  CHECK(image.at(90, 57) == kWhite);  // outside a ball of a quarter of the radius
  CHECK(reddish(image.at(97, 50)));   // the stick, in both colours
  CHECK(greenish(image.at(102, 50)));
  CHECK(image.at(100, 54) == kWhite);
  CHECK(image.at(110, 36) == kWhite);  // no stick upwards
  CHECK(image.at(110, 24)[2] > image.at(110, 24)[0] + 20);
  stage.frame.centres[0] = std::numeric_limits<float>::quiet_NaN();
  CHECK(find_bonds(stage.scene, stage.frame).empty());
}

TEST_CASE("atoms have the bonds of their elements, and sticks where their balls leave a gap") {
  Stage stage;
  stage.options.hip = false;
  stage.scene.length_unit = "angstrom";
  // Methanol's C and O, 1.43 apart, and two hydrogens of the methyl group, 1.78 apart; however
  // small the spheres are.
  const std::vector<std::pair<const char*, std::array<float, 3>>> atoms{
      {"C", {-0.7F, 0, 0}},
      {"O", {0.73F, 0, 0}},
      {"H", {-1.06F, 0.89F, 0.5F}},
      {"H", {-1.06F, -0.89F, 0.5F}}};
  for (const auto& [symbol, at] : atoms) {
    stage.add(at[0], at[1], at[2], 0.3F, {1, 0, 0});
    stage.scene.spheres.back().label = symbol;
  }
  const std::vector<std::array<std::uint32_t, 2>> bonds{{0, 1}, {0, 2}, {0, 3}};
  CHECK(find_bonds(stage.scene, stage.frame) == bonds);
  stage.camera = {.azimuth_degrees = 0, .elevation_degrees = 0, .half_width = 2};
  CHECK(reddish(stage.render().at(100, 50)));  // the middle of C and O
  for (Sphere& sphere : stage.scene.spheres) sphere.label.clear();
  CHECK(find_bonds(stage.scene, stage.frame).empty());
  CHECK(stage.render().at(100, 50) == kWhite);
}

TEST_CASE(
    "a torsion that has turned is named beside the model, with a line towards the dot at its "
    "bond") {
  Stage stage;
  stage.scene.box = {{-0.5, -0.5, -0.5}, 0.5, {3, 3, 3}};
  for (const float x : {-1.0F, 0.4F, 0.6F, 1.0F}) stage.add(x, 0, 0.5F, 0.4F, {0, 1, 0});
  stage.scene.torsions = {{{0, 1, 2, 3}, "phi"}, {{1, 2, 3, 0}, "psi"}, {{2, 0, 1, 3}, "omega"}};
  for (const auto& [width, height] : {std::pair{600, 200}, std::pair{390, 500}})
    for (const double azimuth : {0.0, 140.0}) {
      stage.options = {.width = width,
                       .height = height,
                       .azimuth_degrees = azimuth,
                       .elevation_degrees = 10,
                       .box = false,
                       .hip = false};
      stage.camera = fit_camera(stage.scene, stage.frame, stage.options);
      const auto drawn = [&] {
        return draw(stage.scene, stage.frame, stage.camera, stage.options);
      };
      stage.frame.turned = {9, 9, 9};
      for (const Label& label : drawn().labels) CHECK(label.text.find("°") == label.text.npos);
      stage.frame.turned = stage.frame.angles = {-11, 9, -180};
      const Drawing all = drawn();
      REQUIRE(all.labels.size() > 2);
      const std::size_t phi = all.labels[0].text == "phi −11°" ? 0 : 1;
      CHECK(all.labels[phi].text == "phi −11°");
      CHECK(all.labels[1 - phi].text == "omega −180°");
      const Vec3 middle = 0.5 * (all.balls[1].centre + all.balls[2].centre);
      const Line &line = all.overlay[3 * phi], &rim = all.overlay[3 * phi + 1],
                 &dot = all.overlay[3 * phi + 2];
      for (const Vec3& at : {rim.from, rim.to, dot.from, dot.to})
        CHECK(std::hypot(at[0] - middle[0], at[1] - middle[1]) < 1e-9);
      CHECK((rim.colour == kBackground && rim.half_width > dot.half_width && dot.colour == kInk));
      // The line goes towards the dot, and crosses no ball: both ends are to the right of them all.
      const Vec3 way = line.to - line.from, rest = middle - line.from;
      CHECK(std::abs(way[0] * rest[1] - way[1] * rest[0]) < 1e-6);
      CHECK((way[0] < -1 && way[0] > rest[0]));
      for (const Ball& ball : all.balls)
        CHECK(std::min(line.from[0], line.to[0]) > ball.centre[0] + ball.radius - 1e-6);
      for (const std::size_t i : {0, 1}) {
        const auto& [text, left] = all.labels[i];
        const double right = left[0] + letters_width(text);
        CHECK(right < width);
        for (const Ball& ball : all.balls) {  // in rays, three a pixel
          const double x = ball.centre[0] / 3, y = ball.centre[1] / 3;
          const double nearest = std::hypot(x - std::clamp(x, left[0], right), y - left[1]);
          CHECK(nearest > ball.radius / 3 + 5);
        }
      }
      CHECK(all.labels[1].left[1] >= all.labels[0].left[1] + 14);
    }
}

TEST_CASE("the box and the model fill the picture, wherever the HIP is") {
  Stage stage;
  stage.scene.box = {{-9, -9, -9}, 1, {19, 19, 19}};
  stage.scene.hip_radius = 0.5;
  stage.options = {.width = 200, .height = 100, .azimuth_degrees = 0, .elevation_degrees = 0};
  stage.add(2, 0, 0, 0.4F, {1, 0, 0});
  const auto fitted = [&] { return fit_camera(stage.scene, stage.frame, stage.options); };
  for (const Vec3& place : {Vec3{2, -0.5, 0}, Vec3{-9, 9, 9}}) {
    stage.frame.position = place;
    stage.frame.force = place;
    CHECK(fitted().centre[0] == Approx(0).margin(1e-12));
    CHECK(fitted().half_width == Approx(1.06 * 9.5));
  }
  // A sphere outside: from -9.5 to 49.5, on twice the width.
  stage.add(49, 0, 0, 0.5F, {1, 0, 0});
  CHECK(fitted().centre[0] == Approx(20));
  CHECK(fitted().half_width == Approx(1.06 * 59 / 4));
}

TEST_CASE("the whole of it is in the picture, from every side") {
  const Scene scene = testing::small_scene();
  Frame frame = testing::small_frame(0);
  frame.force = {-0.3, 0.3, -0.8};
  RenderOptions options{.width = 150, .height = 90, .supersampling = 1, .box = false};
  for (const double azimuth : {-200.0, -45.0, 0.0, 30.0, 90.0})
    for (const double elevation : {-90.0, -20.0, 0.0, 70.0, 90.0}) {
      options.azimuth_degrees = azimuth;
      options.elevation_degrees = elevation;
      const Image image = render(scene, frame, fit_camera(scene, frame, options), options);
      bool edge = false, any = false;
      for (int y = 0; y < 90; ++y)
        for (int x = 0; x < 150; ++x) {
          const bool drawn = image.at(x, y) != kWhite;
          any = any || drawn;
          edge = edge || (drawn && (x == 0 || y == 0 || x == 149 || y == 89));
        }
      CHECK(any);
      CHECK_FALSE(edge);
    }
}

TEST_CASE("values that are no places draw nothing and harm nothing") {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr float kHuge = std::numeric_limits<float>::max();
  const Scene scene = testing::small_scene();
  Frame frame = testing::small_frame(0);
  RenderOptions options{.width = 40,
                        .height = 30,
                        .azimuth_degrees = 10,
                        .elevation_degrees = 10,
                        .supersampling = 2};
  const auto draw = [&] {
    return render(scene, frame, fit_camera(scene, frame, options), options);
  };
  const std::vector<float> none(9, std::numeric_limits<float>::quiet_NaN());
  const std::vector<float> huge{kHuge, -kHuge, kHuge, HUGE_VALF, 0, 0, 0, 0, 0};
  for (const auto& centres : {none, huge})
    for (const Vec3& place : {frame.position, Vec3{nan, 0, 0}, Vec3{1e308, -1e308, 1e308}})
      for (const Vec3& force : {Vec3{nan, 0, 0}, Vec3{1e308, 1e308, 1e308}}) {
        frame.centres = centres, frame.position = place, frame.force = force;
        CHECK(draw().pixels.size() == 1200);
      }
}
