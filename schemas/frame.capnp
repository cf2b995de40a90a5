# The stream of play for viewers: what the hand feels, 25 times a second, or 60
# times in real time. It is a sequence of
# Cap'n Proto messages with the root Message in standard stream framing, uncompressed: one scene,
# then any number of frames, ascending by tick.
#
#   capnp decode schemas/frame.capnp Message < x.frames
#
# prints it. It may end behind any message: play was stopped then, or is over. schemas/README.md says
# how this file may change.
@0xfaee0b0fb5fb4886;

using Common = import "common.capnp";
$Common.namespace("hapgrid::scene_schema");

struct Message {
  union {
    scene @0 :Scene;
    frame @1 :Frame;
  }
}

struct Scene {
  # What stays the same in all frames. Lengths and positions are in lengthUnit.

  magic @0 :UInt64;
  # 0x6861706772696466, "hapgridf" in ASCII.

  version @1 :UInt32;
  # 1; a reader refuses any other.

  model @2 :Text;
  # The plug-in's plain name, never a path.

  lengthUnit @3 :Text;
  # For people: "angstrom"; may be empty.

  energyUnit @4 :Text;
  # For people: "kJ/mol"; may be empty.

  box @5 :Common.Box;

  stateSize @6 :UInt32;
  # n, the number of components of a state.

  hipRadius @7 :Float64;
  # Of the ball that the HIP moves; 0 is unknown.

  spheres @8 :List(Common.Sphere);
  # What shows a state; empty where the model has no shape.

  keys @9 :Text;
  # For people: what the keys do that play reads; empty where it reads none.

  torsions @10 :List(Torsion);
  # Angles that viewers follow and name; empty where there are none.

  largestForce @11 :Float64;
  # Newtons that play sends at most in this grid; 0 is unknown.
}

struct Torsion {
  # The angle between two planes, through the spheres a b c and through b c d.

  name @0 :Text;
  a @1 :UInt32;
  b @2 :UInt32;
  c @3 :UInt32;
  d @4 :UInt32;
}

struct Vector {
  x @0 :Float64;
  y @1 :Float64;
  z @2 :Float64;
}

struct Frame {
  # One tick of the haptic loop.

  time @0 :Float64;
  # Seconds of play: the tick's number divided by the rate of play.

  tick @1 :UInt64;
  # The tick's number; missed ticks count.

  hip @2 :Vector;
  # As the device gave it; it can be outside the box, or no number.

  position @3 :Vector;
  # Held in the box: where state, energy and force belong to.

  force @4 :Vector;
  # Newtons, as it was sent to the device.

  energy @5 :Float64;
  # In energyUnit; NaN where the model has none.

  state @6 :List(Float64);
  # The interpolated state, stateSize components.

  centres @7 :List(Float32);
  # Of the scene's spheres, x y z by sphere.

  jumps @8 :UInt64;
  # In how many ticks the state has jumped, because the play began or the model snaps there.

  ownEnergy @9 :Float64 = nan;
  # In energyUnit, of the model by itself, without the HIP; NaN where the model does not tell it.

  hand @10 :Vector;
  # Where the hand is that pulls the HIP by a spring (a mouse, a finger); left out where the HIP is the hand itself.
}
