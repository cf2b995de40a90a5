# What play records of a session, tick by tick. A session is a sequence of zstd frames, each with its
# content checksum; each zstd frame holds one Cap'n Proto message with the root Message: first a header,
# then any number of chunks of ticks, ascending. A session ends where its file does. When play was killed,
# or the file is damaged, the session ends before the first zstd frame that is cut or damaged; a reader
# says so.
#
#   zstd -dc x.session | capnp decode schemas/session.capnp Message
#
# prints any of them. schemas/README.md says how this file may change.
@0xc72e1c11fdc4f4f9;

using Common = import "common.capnp";
$Common.namespace("hapgrid::session_schema");

struct Message {
  union {
    header @0 :Header;
    ticks @1 :Ticks;
  }
}

struct Header {
  # What stays the same in all ticks. Lengths and positions are in lengthUnit.

  magic @0 :UInt64;
  # 0x6861706772696473, "hapgrids" in ASCII.

  version @1 :UInt32;
  # 2; a reader refuses any other.

  model @2 :Text;
  # The plug-in's plain name, never a path.

  gridDigest @3 :Text;
  # Which grid was played, for comparison and for people; may be empty.

  lengthUnit @4 :Text;
  # For people: "angstrom"; may be empty.

  box @5 :Common.Box;

  rate @6 :Float64;
  # Ticks a second, above 0: the time of a tick is its number divided by this.

  flagNames @7 :List(Text);
  # What the bits of a tick's flags mean, bit 0 first; 32 at most. "clutch", "stalled", "reset" and
  # "next" are what the device said, "begins" is where a simulated hand began anew, "level_changed" is a switch of
  # levels, and "safety_..." is what the safety core did to the force. Other names are for people.

  settings @8 :Text;
  # How play was set up: JSON, for people and for play itself; may be empty.
}

struct Ticks {
  # A chunk: n ticks in columns, 1 <= n <= 4096.

  first @0 :UInt64;
  # The first tick's number.

  skipped @1 :List(UInt64);
  # n: how many numbers lie between the tick before and this one: ticks that were missed, or that
  # the recorder had to drop. The first entry is 0.

  flags @2 :List(UInt32);
  # n: bits, see Header.flagNames.

  lateness @3 :List(UInt32);
  # n: nanoseconds from when the tick was due to when it started; 2^32 - 1 for that and more.

  compute @4 :List(UInt32);
  # n: nanoseconds from the tick's start until its force was sent; 2^32 - 1 for that and more.

  levels @5 :Data;
  # 8 n: the levels in the corners i + 2j + 4k of the cell, corner by corner.

  hip @6 :Data;
  # 24 n: as the device gave it, in the box's axes. Three columns x, y, z, each coded like this: a
  # double is taken as a 64-bit number; d is its difference to the tick before (to 0 for the first),
  # modulo 2^64 and read as signed; u = 2 d for d >= 0, else -2 d - 1. The column is the lowest bytes
  # of all u, then their second-lowest bytes, and so on. So what hardly changes becomes zeros.

  rawForce @7 :Data;
  # 24 n, coded like hip: newtons, as the model gave it, before the safety core; NaN where the model
  # was not asked.

  force @8 :Data;
  # 24 n: newtons, as it was sent to the device. Coded like hip, but u is the 64-bit number of the
  # force exclusive-or that of rawForce: 0 where nothing was done to it.

  dropped @9 :UInt64;
  # Ticks of the play before the end of this chunk that are in no chunk, since the disk was too slow. The
  # last chunk counts those of the whole play.

  slewTime @10 :List(UInt32);
  # n: nanoseconds for which the slew limit let the force change, in a tick in real time in which the
  # safety core changed the force by it; else 0. A replay needs it. Empty: 0 in all ticks.
}
