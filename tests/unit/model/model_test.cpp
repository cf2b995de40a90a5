#include <future>

#include "libcore/model/plugin_model.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/refusal.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

namespace {

const std::vector<std::filesystem::path> kBad{HAPGRID_BUILD_DIR "/tests/plugins"};
const std::vector<std::filesystem::path> kGood{HAPGRID_BUILD_DIR "/models"};

std::string create_refusal(const std::vector<Parameter>& parameters) {
  return refusal([&] { Plugin("puppet", kBad).create(parameters); });
}

std::unique_ptr<Model> puppet(const std::vector<Parameter>& parameters) {
  return Plugin("puppet", kBad).create(parameters);
}

}  // namespace

TEST_CASE("a plug-in in plain C works, and says what it cannot do") {
  const Plugin plugin("puppet", kBad);
  CHECK(plugin.name() == "puppet");
  CHECK(plugin.summary() == "does as it is told");
  auto model = plugin.create({{"state_size", 3.0}, {"component", 0.5}, {"tolerance", 0.25}});
  CHECK(model->state_size() == 3);
  CHECK(model->info().d_max == 1);
  CHECK(model->info().tolerance == 0.25);
  // It fills all 16 bytes of the unit.
  CHECK(std::string(model->info().tolerance_unit) == std::string(15, 'u'));
  CHECK_FALSE(model->has_force());
  CHECK_FALSE(model->has_shape());
  const double s[3] = {1, 2, 3};
  double reached[3] = {0, 0, 0};
  REQUIRE(model->convert(s, {0, 0, 0}, {1, 0, 0}, reached));
  for (const double component : reached) CHECK(component == 0.5);
  CHECK(model->equal(s, s));
  CHECK_FALSE(model->equal(s, reached));
}

// Open Babel breaks the heap when two threads read a molecule.
TEST_CASE("a plug-in creates one model at a time, whatever the threads") {
  std::vector<std::future<std::unique_ptr<Model>>> models;
  models.reserve(8);
  for (int i = 0; i < 8; ++i)
    models.push_back(std::async(std::launch::async, [] { return puppet({{"alone", true}}); }));
  for (auto& model : models) CHECK(model.get()->state_size() == 1);
}

TEST_CASE("known states: none, one, more than were asked for") {
  CHECK(puppet({{"known", 0.0}})->known_states({0, 0, 0}).empty());
  CHECK(puppet({{"known", 1.0}, {"state_size", 2.0}})->known_states({0, 0, 0}) ==
        std::vector<double>{0, 0});
  CHECK(puppet({{"known", 3.0}, {"state_size", 2.0}})->known_states({0, 0, 0}) ==
        std::vector<double>{0, 0, 1, 1, 2, 2});
  CHECK(puppet({{"known", double{kMaxLevels}}})->known_states({0, 0, 0}).size() == kMaxLevels);
}

TEST_CASE("parameters of every type arrive in C") {
  using Numbers = std::vector<double>;
  using Texts = std::vector<std::string>;
  CHECK(create_refusal({{"a.flag", true},
                        {"b", false},
                        {"c", 0.1},
                        {"d", std::string("one two")},
                        {"e", Numbers{1, -2.5}},
                        {"echo", Numbers{}},
                        {"f", Texts{"x", "", "z"}},
                        {"g", Texts{}},
                        {"h", true}}) ==
        "model puppet: a.flag type 0 count 1: 1;b type 0 count 1: 0;"
        "c type 1 count 1: 0.10000000000000001;d type 2 count 1: 'one two';"
        "e type 3 count 2: 1 -2.5;echo type 3 count 0:;f type 4 count 3: 'x' '' 'z';"
        "g type 4 count 0:;h type 0 count 1: 1;");
}

TEST_CASE("an exception of a C++ model does not leave the plug-in") {
  auto model = Plugin("hung-ball", kGood).create({});
  const double s = 0;
  double reached = 1;
  CHECK_FALSE(model->convert(&s, {0, 0, 0}, {1, 0, 0}, &reached));
  CHECK(model->error() == "a shift of 1, d_max is 0.463325");
  CHECK_FALSE(model->convert(&s, {0, 0, 0}, {std::nan(""), 0, 0}, &reached));
  CHECK(model->error() == "a shift of nan, d_max is 0.463325");
}

TEST_CASE("two models of one plug-in are independent and outlive it") {
  std::optional<Plugin> plugin(std::in_place, "hung-ball", kGood);
  auto small = plugin->create({{"radius", 0.1}});
  auto large = plugin->create({{"radius", 0.2}, {"tolerance", 0.5}});
  plugin.reset();
  CHECK(small->info().tolerance == 1e-6);
  CHECK(large->info().tolerance == 0.5);
  // Rest is known where the balls do not overlap: |p| >= 2r.
  CHECK(small->known_states({0.3, 0, 0}) == std::vector<double>{0});
  CHECK(large->known_states({0.3, 0, 0}).empty());
  const double rest = 0, near = 0.25;
  CHECK_FALSE(small->equal(&rest, &near));
  CHECK(large->equal(&rest, &near));

  double of_small = -1, of_large = -1;
  REQUIRE(small->convert(&rest, {-0.5, 0, 0}, {0.2, 0, 0}, &of_small));
  REQUIRE(large->convert(&rest, {-0.5, 0, 0}, {0.2, 0, 0}, &of_large));
  CHECK(of_small == 0);
  CHECK(of_large > 0.05);
}
