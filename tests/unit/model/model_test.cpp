#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>

#include "libcore/base/error.hpp"
#include "libcore/model/plugin_model.hpp"
#include "tests/unit/refusal.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;
namespace fs = std::filesystem;

namespace {

const std::vector<fs::path> kBad{HAPGRID_BUILD_DIR "/tests/plugins"};
const std::vector<fs::path> kGood{HAPGRID_BUILD_DIR "/models"};

std::string load_refusal(const std::string& name, const std::vector<fs::path>& where = kBad) {
  return refusal([&] { Plugin(name, where); });
}

std::string create_refusal(const std::vector<Parameter>& parameters) {
  return refusal([&] { Plugin("puppet", kBad).create(parameters); });
}

std::unique_ptr<Model> puppet(const std::vector<Parameter>& parameters) {
  return Plugin("puppet", kBad).create(parameters);
}

/// A directory that is gone at the end of the test.
class Directory {
 public:
  Directory() {
    std::string name = (fs::temp_directory_path() / "hapgrid-test.XXXXXX").string();
    REQUIRE(mkdtemp(name.data()));
    path_ = name;
  }
  ~Directory() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

const double kNaN = std::numeric_limits<double>::quiet_NaN();
const double kInf = std::numeric_limits<double>::infinity();

}  // namespace

TEST_CASE("a plug-in's name is never a path") {
  // A real plug-in that each of these names would reach if it were taken as a path.
  const Directory home;
  fs::create_directories(home.path() / "a");
  fs::copy_file(kBad[0] / "puppet.so", home.path() / "x.so");
  fs::copy_file(kBad[0] / "puppet.so", home.path() / "a" / "b.so");
  REQUIRE_NOTHROW(Plugin("x", {home.path()}));
  const std::string rule = ": a plug-in's name has only letters, digits, '-' and '_'";
  CHECK(load_refusal("../x", {home.path() / "a"}) == "model '../x'" + rule);
  CHECK(load_refusal("a/b", {home.path()}) == "model 'a/b'" + rule);
  CHECK(load_refusal("./x", {home.path()}) == "model './x'" + rule);
  CHECK(load_refusal((home.path() / "x").string(), {""}).find(rule) != std::string::npos);
  CHECK(load_refusal("", {home.path()}) == "model ''" + rule);
  CHECK(load_refusal(".", {home.path()}) == "model '.'" + rule);
  CHECK(load_refusal("x.so", {home.path()}) == "model 'x.so'" + rule);
  CHECK(load_refusal(std::string("x\0y", 3), {home.path()}) == "model 'x y'" + rule);
  CHECK(load_refusal("x\ny", {home.path()}) == "model 'x y'" + rule);
  CHECK(load_refusal("x y", {home.path()}) == "model 'x y'" + rule);
  CHECK(load_refusal("ä", {home.path()}) == "model 'ä'" + rule);
  CHECK(load_refusal(std::string(10000, 'x'), {home.path()}).size() < 1000);

  fs::copy_file(kBad[0] / "puppet.so", home.path() / "-x.so");
  CHECK(load_refusal("-x", {home.path()}).find("model '-x'") == 0);
}

TEST_CASE("the first directory that has the plug-in wins") {
  const Directory first;
  fs::copy_file(kBad[0] / "wrong_version.so", first.path() / "puppet.so");
  CHECK(load_refusal("puppet", {"/nowhere", first.path(), kBad[0]}).find("interface version 999") !=
        std::string::npos);
  CHECK_NOTHROW(Plugin("puppet", {"/nowhere", kBad[0], first.path()}));
}

TEST_CASE("the search path: the command line, the environment, beside the program") {
  const char* before = std::getenv("HAPGRID_MODEL_PATH");
  const std::optional<std::string> saved =
      before ? std::optional<std::string>(before) : std::nullopt;
  const fs::path beside = fs::read_symlink("/proc/self/exe").parent_path().parent_path() / "models";

  REQUIRE(setenv("HAPGRID_MODEL_PATH", "/e1::/e2:", 1) == 0);
  CHECK(model_path({"/g1", "g2"}) == std::vector<fs::path>{"/g1", "g2", "/e1", "/e2", beside});
  REQUIRE(unsetenv("HAPGRID_MODEL_PATH") == 0);
  CHECK(model_path({}) == std::vector<fs::path>{beside});

  if (saved) setenv("HAPGRID_MODEL_PATH", saved->c_str(), 1);
}

TEST_CASE("a file that is no plug-in") {
  const Directory home;
  std::ofstream(home.path() / "text.so") << "not a shared object, only a text\n";
  std::ofstream(home.path() / "empty.so").flush();
  fs::create_directory(home.path() / "folder.so");
  for (const char* name : {"text", "empty", "folder"}) {
    const std::string message = load_refusal(name, {home.path()});
    CHECK(message.find("model " + std::string(name) + ": ") == 0);
    CHECK(message.find(home.path() / (std::string(name) + ".so")) != std::string::npos);
    CHECK(message.find('\n') == std::string::npos);
  }
}

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

TEST_CASE("a conversion that fails or is not finite is an answer, not an exception") {
  const double s[2] = {0, 0};
  double reached[2];
  for (const double component : {kNaN, kInf, -kInf}) {
    auto model = puppet({{"component", component}, {"state_size", 2.0}});
    CHECK_FALSE(model->convert(s, {0, 0, 0}, {1, 0, 0}, reached));
    CHECK(model->error() == "component 0 of the state reached is not finite");
  }
  auto model = puppet({{"lose", std::string("lost\nit")}});
  CHECK_FALSE(model->convert(s, {0, 0, 0}, {1, 0, 0}, reached));
  CHECK(model->error() == "lost it");
}

TEST_CASE("known states: none, one, more than were asked for, too many, failure") {
  CHECK(puppet({{"known", 0.0}})->known_states({0, 0, 0}).empty());
  CHECK(puppet({{"known", 1.0}, {"state_size", 2.0}})->known_states({0, 0, 0}) ==
        std::vector<double>{0, 0});
  CHECK(puppet({{"known", 3.0}, {"state_size", 2.0}})->known_states({0, 0, 0}) ==
        std::vector<double>{0, 0, 1, 1, 2, 2});
  CHECK(puppet({{"known", double{kMaxLevels}}})->known_states({0, 0, 0}).size() == kMaxLevels);
  CHECK(refusal([] {
          puppet({{"known", 1e15}})->known_states({0, 0, 0});
        }) == "known states: 1000000000000000 states at one point, the limit is 254");
  CHECK(refusal([] {
          puppet({{"lose", std::string("lost\nit")}})->known_states({0, 0, 0});
        }) == "known states: lost it");
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

TEST_CASE("a C++ model refuses parameters by name") {
  const Plugin plugin("hung-ball", kGood);
  const auto create_refusal = [&](const std::string& key, ParameterValue value) {
    return refusal([&] { plugin.create({{key, std::move(value)}}); });
  };
  CHECK(create_refusal("raduis", 0.1) ==
        "model hung-ball: unknown parameter raduis (known: max_force, radius, stored, tolerance, "
        "weight)");
  CHECK(create_refusal("radius", std::string("big")) ==
        "model hung-ball: parameter radius must be a number");
  CHECK(create_refusal("weight", true) == "model hung-ball: parameter weight must be a number");
  CHECK(create_refusal("radius", std::vector<double>{0.1}) ==
        "model hung-ball: parameter radius must be a number");
  CHECK(create_refusal("radius", 0.5) ==
        "model hung-ball: parameter radius is 0.5, it must be above 0 and below 0.5");
  CHECK(create_refusal("radius", 0.0) ==
        "model hung-ball: parameter radius is 0, it must be above 0 and below 0.5");
  CHECK(create_refusal("weight", -1.0) ==
        "model hung-ball: parameter weight is -1, it must be positive");
  CHECK(create_refusal("max_force", kInf) ==
        "model hung-ball: parameter max_force is inf, it must be finite");
  CHECK(create_refusal("max_force", 0.0) ==
        "model hung-ball: parameter max_force is 0, it must be positive");
  CHECK(create_refusal("tolerance", -1e-9) ==
        "model hung-ball: parameter tolerance is -1e-09, it must be 0 or more");
  CHECK(create_refusal("tolerance", kNaN).find("it must be finite") != std::string::npos);
}

TEST_CASE("an exception of a C++ model does not leave the plug-in") {
  auto model = Plugin("hung-ball", kGood).create({});
  const double s = 0;
  double reached = 1;
  CHECK_FALSE(model->convert(&s, {0, 0, 0}, {1, 0, 0}, &reached));
  CHECK(model->error() == "a shift of 1, d_max is 0.463325");
  CHECK_FALSE(model->convert(&s, {0, 0, 0}, {kNaN, 0, 0}, &reached));
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
  const double rest = 0;
  const double near = 0.25;
  CHECK_FALSE(small->equal(&rest, &near));
  CHECK(large->equal(&rest, &near));

  double of_small = -1;
  double of_large = -1;
  REQUIRE(small->convert(&rest, {-0.5, 0, 0}, {0.2, 0, 0}, &of_small));
  REQUIRE(large->convert(&rest, {-0.5, 0, 0}, {0.2, 0, 0}, &of_large));
  CHECK(of_small == 0);
  CHECK(of_large > 0.05);

  auto moved = std::move(small);
  REQUIRE(moved->convert(&rest, {-0.5, 0, 0}, {0.2, 0, 0}, &of_small));
  CHECK(of_small == 0);
}
