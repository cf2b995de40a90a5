// The bytes of IMD against literals, written by hand from the protocol's text. Any bytes, in
// pieces, are in tests/fuzz/streams.cpp.
#include "tools/view/imd_protocol.hpp"

#include "tests/unit/catch.hpp"
#include "tests/unit/scene/scenes.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

namespace {

using State = ImdListener::State;

/// "00 00 00 04": blanks are for people.
std::vector<std::byte> bytes(const std::string& hex) {
  std::vector<std::byte> result;
  int digits = 0;
  unsigned value = 0;
  for (const char c : hex) {
    if (c == ' ') continue;
    value = value << 4 | static_cast<unsigned>(c <= '9' ? c - '0' : c - 'a' + 10);
    if (++digits % 2 == 0) result.push_back(static_cast<std::byte>(value & 0xff));
  }
  return result;
}

std::vector<std::byte> copy(std::span<const std::byte> message) {
  return {message.begin(), message.end()};
}

/// One sphere, in kJ/mol and angstrom.
Scene one_sphere() {
  Scene scene = small_scene();
  scene.spheres.resize(1);
  return scene;
}

Frame one_frame() {
  Frame frame;
  frame.tick = 258;  // 0x102
  frame.time_s = 0.5;
  frame.position = {1, -2, 0.5};
  frame.hip = {9, 9, 9};
  frame.force = {0, -1 / 6.02214076e10, 2 / 6.02214076e10};
  frame.energy = -4.184;
  frame.centres = {1.5F, 0, -1};
  return frame;
}

const std::string kGo = "00000003 00000000";

State say(ImdListener& listener, const std::string& hex) { return listener.read(bytes(hex)); }

/// After GO.
State answer(const std::string& hex) {
  ImdListener listener(4);
  say(listener, kGo);
  return say(listener, hex);
}

}  // namespace

TEST_CASE("a step beyond 32 bits is the largest one") {
  Frame frame = one_frame();
  frame.tick = 0x123456789a;
  const auto message = imd_frame(frame, ImdUnits(one_sphere()));
  CHECK(copy(std::span(message).subspan(8, 4)) == bytes("ffffff7f"));
}

TEST_CASE("units of IMD") {
  const auto units = [](const char* length, const char* energy) {
    Scene scene = one_sphere();
    scene.length_unit = length;
    scene.energy_unit = energy;
    return ImdUnits(scene);
  };
  const std::pair<const char*, double> lengths[] = {
      {"m", 1e10}, {"mm", 1e7}, {"nm", 10}, {"angstrom", 1}, {"pm", 0.01}, {"bohr", 0.529177}};
  for (const auto& [unit, length] : lengths)
    CHECK(units(unit, "").length == Approx(length).epsilon(1e-6));
  // One of each is so many kJ/mol, in the tables of textbooks.
  const std::pair<const char*, double> energies[] = {
      {"kJ/mol", 1}, {"kcal/mol", 4.184}, {"eV", 96.485}, {"hartree", 2625.5}, {"J", 6.02214e20}};
  for (const auto& [unit, energy] : energies)
    CHECK(units("", unit).energy == Approx(energy / 4.184).epsilon(1e-5));
  const ImdUnits unknown = units("rope lengths", "N rope lengths");
  CHECK(unknown.length == 1);
  CHECK(unknown.energy == 1);
  CHECK_FALSE(unknown.length_known);
  CHECK_FALSE(unknown.energy_known);
  CHECK_FALSE(units("", "").length_known);
}

TEST_CASE("what an IMD client may say") {
  ImdListener listener(4);
  CHECK(listener.state() == State::kGreeted);
  CHECK(say(listener, "000000") == State::kGreeted);
  CHECK(say(listener, "03 12345678") == State::kRunning);  // any value will do
  CHECK(say(listener, "00000007 00000000") == State::kPaused);
  CHECK(say(listener, "00000007 00000000") == State::kRunning);  // a toggle
  CHECK(say(listener, "00000008 ffffffff") == State::kRunning);  // TRATE
  // MDCOMM of no, one and four atoms; what looks like KILL in their bodies is none.
  CHECK(say(listener, "00000006 00000000") == State::kRunning);
  CHECK(say(listener, "00000006 00000001 00000005 00000000 00000005 00000000") == State::kRunning);
  std::string body;
  for (int i = 0; i < 8; ++i) body += "00000005 00000000";
  CHECK(say(listener, "00000006 00000004" + body) == State::kRunning);
  CHECK((listener.sent_forces() && listener.sent_rate()));
  CHECK(say(listener, "00000005 00000000") == State::kClosed);
  CHECK(say(listener, kGo) == State::kClosed);
  CHECK(answer("00000000 00000000") == State::kClosed);
}

TEST_CASE("what closes an IMD client") {
  // Before GO all else, also HTTP.
  for (const std::string first : {"00000005 00000000", "00000000 00000000", "03000000 00000000",
                                  "47455420 2f204854", "ffffffff ffffffff"}) {
    ImdListener listener(4);
    CHECK(say(listener, first) == State::kClosed);
  }
  // After it: types of the server's, of version 3, unknown ones, forces on too many atoms or on -1.
  for (const std::string later :
       {"00000001 00000001", "00000002 00000001", "00000004 02000000", "00000009 00000000",
        "0000000b 00000000", "00000010 00000000", "00000011 00000000", "ffffffff 00000000",
        "80000000 00000000", "00000006 00000005", "00000006 7fffffff", "00000006 ffffffff",
        "00000006 80000000"})
    CHECK(answer(later) == State::kClosed);
}
