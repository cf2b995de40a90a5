# What play records of a session, tick by tick. A session is a sequence of zstd frames, each with its
# content checksum; each zstd frame holds one Cap'n Proto message with the root Message: a header, any
# number of chunks of ticks, ascending, and a footer. Behind the footer stands a skippable zstd frame
# (magic 0x184D2A5E, 16 bytes): two little-endian UInt64, the size of the footer's zstd frame and the
# XXH3-64 (seed 0) of its bytes. A session without this end was interrupted.
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
    footer @2 :Footer;
  }
}

struct Header {
  # What stays the same in all ticks. Lengths and positions are in lengthUnit.

  magic @0 :UInt64;
  # 0x6861706772696473, "hapgrids" in ASCII.

  version @1 :UInt32;
  # 1; a reader refuses any other.

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
  # What the bits of a tick's flags mean, bit 0 first; 32 at most. "clutch" and "stalled" are what
  # the device said, "begins" is where a simulated hand began anew, "level_changed" is a switch of
  # levels, and "safety_..." is what the safety core did to the force. Other names are for people.

  settings @8 :Text;
  # How play was set up: JSON, for people and for play itself; may be empty.
}

struct Ticks {
  # A chunk: n ticks in columns, 1 <= n <= 4096.

  first @0 :UInt64;
  # The first tick's number.

  skipped @1 :List(UInt64);
  # n: how many numbers lie between the tick before and this one; ticks that were missed, or that
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
}

struct Footer {
  ticks @0 :UInt64;
  # In all chunks.

  dropped @1 :UInt64;
  # Ticks of play that are not in the chunks, since the disk was too slow.

  chunks @2 :List(Chunk);
  # One after the other, the first right behind the header, the last right before the footer.

  digestLow @3 :UInt64;
  digestHigh @4 :UInt64;
  # XXH3-128, seed 0, of the digests (low, high) of the header's message and of each chunk's.
}

struct Chunk {
  offset @0 :UInt64;
  size @1 :UInt64;
  # Of its zstd frame, in bytes.

  first @2 :UInt64;
  last @3 :UInt64;
  # Numbers of its first and last tick.

  ticks @4 :UInt32;

  digestLow @5 :UInt64;
  digestHigh @6 :UInt64;
  # XXH3-128, seed 0, of its message.
}
