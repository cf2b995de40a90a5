// The player of a page that plays a grid by itself: the traversal, the force, the safety core and
// the hand's spring, as play has them, compiled to WebAssembly. view/page/player.js calls it.
//
// It is play's arithmetic to the bit: the HIP's path of a page gives the same forces in
// `play --device path: --beside off`. What it lacks is the model beside the grid.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "libcore/follow/branch_traversal.hpp"
#include "libcore/follow/node_force.hpp"
#include "libcore/loop/responder.hpp"
#include "libcore/scene/drawing.hpp"
#include "libcore/scene/scene.hpp"
#include "tools/page/coupled_hip.hpp"
#include "tools/page/packed_grid.hpp"

using namespace hapgrid;

namespace {

constexpr std::uint32_t kMostTicks = 128;  // of a call of play()

std::shared_ptr<NodeEnergies> energies_of(const UnpackedGrid& unpacked, const BranchNodes& map) {
  return std::make_shared<NodeEnergies>(node_energies(unpacked.grid, unpacked.fields, &map));
}

struct Player {
  Player(UnpackedGrid&& from, const Vec3& start)
      : unpacked(std::move(from)),
        map(std::make_shared<BranchNodes>(unpacked.grid)),
        traversal(unpacked.grid, map),
        force(energies_of(unpacked, *map), unpacked.grid.box(),
              unpacked.by_energy ? hermite_force : mean_force),
        mapping({}, {.name = "hand"}, unpacked.grid.box()),
        safety(SafetyLimits{}),
        responder(mapping, traversal, safety, force),
        hip(unpacked.grid.box(), start) {
    unpacked.fields = {};  // the nodes have them
    frame.centres = unpacked.centres;
  }
  void tick(const DeviceInput& input);
  void show();

  UnpackedGrid unpacked;
  std::shared_ptr<BranchNodes> map;
  BranchTraversal traversal;
  NodeForce force;
  Mapping mapping;
  SafetyCore safety;
  Responder<NodeForce> responder;
  CoupledHip hip;
  std::uint64_t ticks = 0;
  Frame frame;
};

/// What the page reads of the last tick, and of the last picture; doubles, so that JavaScript sees
/// one array.
struct Shown {
  Vec3 position{}, sent{}, raw{};
  double jumps = 0, ticks = 0, snapped = 0;
  std::array<double, 8> levels{};
  double energy = 0;  ///< above the lowest of the grid, in newtons times the unit of length
  std::array<double, 4> arrow{};
  double bonds = 0;                                       ///< how many
  double own = std::numeric_limits<double>::quiet_NaN();  ///< energy, of the model by itself
} shown;

std::optional<Player> player;
unsigned char* room = nullptr;
std::array<Vec3, kMostTicks> way;  // of the HIP in the last call of play()
std::vector<std::array<std::uint32_t, 2>> bonds;

void Player::tick(const DeviceInput& input) {
  const Tick tick = responder.respond(ticks++, input, 1 / kUnpacedHz, 0, 0);
  shown.position = traversal.position();
  shown.sent = tick.force.force;
  shown.raw = tick.raw_force;
  shown.jumps = static_cast<double>(traversal.jumps());
  shown.ticks = static_cast<double>(ticks);
  shown.snapped = tick.step.snapped;
  std::copy_n(traversal.levels().begin(), 8, shown.levels.begin());
}

/// What pictures draw (scene/drawing.hpp).
void Player::show() {
  const Scene& scene = unpacked.scene;
  frame.position = shown.position;
  frame.force = shown.sent;
  // A model's own energy is where else the state is.
  const std::size_t first = unpacked.grid.state_size();
  if (first > 0) shown.own = traversal.row()[0];
  for (std::size_t i = 0; i < unpacked.moved.size(); ++i)
    frame.centres[unpacked.moved[i]] = static_cast<float>(traversal.row()[first + i]);
  shown.energy =
      unpacked.by_energy ? force.energy(traversal) : std::numeric_limits<double>::quiet_NaN();
  shown.arrow = arrow_sizes(scene, frame);
  bonds = find_bonds(scene, frame);
  shown.bonds = static_cast<double>(bonds.size());
  frame.angles.clear();
  for (const Torsion& torsion : scene.torsions)
    frame.angles.push_back(torsion_degrees(torsion, frame.centres));
}

}  // namespace

#define EXPORT(name) __attribute__((export_name(#name))) extern "C"

/// Room for the bytes of a packed grid.
EXPORT(room_for) unsigned char* room_for(std::uint32_t bytes) {
  return room = static_cast<unsigned char*>(std::malloc(bytes));
}
/// Begins to play the grid in that room, with the HIP at a place.
EXPORT(begin) void begin(double x, double y, double z) {
  player.emplace(unpack_grid(room), Vec3{x, y, z});
  std::free(std::exchange(room, nullptr));
}
/// The hand is at a place for some ticks, and the HIP follows it by its spring. @returns how many
EXPORT(play)
std::uint32_t play(double x, double y, double z, std::uint32_t most, bool next) {
  const Vec3 hand{x, y, z};
  const std::uint32_t ticks = std::min(most, kMostTicks);
  for (std::uint32_t i = 0; i < ticks; ++i, next = false) {
    way[i] = player->hip.next(hand, shown.sent, 1 / kUnpacedHz);
    player->tick({.position = way[i], .next = next});
  }
  return ticks;
}
/// The HIP is at a place for a tick, as on a path.
EXPORT(put) void put(double x, double y, double z, bool next) {
  player->tick({.position = {x, y, z}, .next = next});
}
/// Computes what a picture shows of the last tick.
EXPORT(show) void show() { player->show(); }
EXPORT(shown_at) const Shown* shown_at() { return &shown; }
EXPORT(way_at) const Vec3* way_at() { return way.data(); }
EXPORT(centres_at) const float* centres_at() { return player->frame.centres.data(); }
EXPORT(angles_at) const double* angles_at() { return player->frame.angles.data(); }
EXPORT(bonds_at) const std::array<std::uint32_t, 2>* bonds_at() { return bonds.data(); }
