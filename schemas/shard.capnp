# The stream format of hapgrid's shards. A shard is one section, or several concatenated ones. A section
# is a sequence of zstd frames, each with its content checksum; each zstd frame holds one Cap'n Proto
# message with the root Message: a header, any number of chunks, and a footer, which is their index.
# Behind the footer stands a skippable zstd frame (magic 0x184D2A5E, 8 bytes): a little-endian UInt64,
# the size of the footer's zstd frame. So a reader goes straight from the end of a file to the index
# and to what it needs. A section without this end is truncated. A grid is one section; requests come in any number of them.
#
#   zstd -dc x.grid | capnp decode schemas/shard.capnp Message
#
# prints any of them. schemas/README.md says how this file may change.
@0xc1d5f0a96e3b7d42;

using Common = import "common.capnp";
using Box = Common.Box;
using Sphere = Common.Sphere;
$Common.namespace("hapgrid::schema");

struct Message {
  union {
    header @0 :Header;
    records @1 :RecordChunk;
    requests @2 :RequestChunk;
    footer @3 :Footer;
  }
}

struct Header {
  magic @0 :UInt64;
  # 0x6861706772696431, "hapgrid1" in ASCII.

  version @1 :UInt32;
  # Format version, 1. A reader refuses any other.

  content @2 :Content;

  generation @3 :UInt32;
  # The youngest generation. In a grid, the records of this generation are the frontier; requests
  # start from these records.

  box @4 :Box;
  model @5 :Text;
  # The plug-in's plain name, never a path; of a model that is a process (equality says so), the
  # name that its user gave it. What to run never stands in a shard.

  parameters @6 :List(Parameter);
  # The model's parameters in full, ascending by key.

  stateSize @7 :UInt32;
  # n, the number of components of a state.

  tolerance @8 :Float64;
  # The bound that the model's tolerance function applies, in toleranceUnit.

  toleranceUnit @9 :Text;

  maxLevels @10 :UInt32;
  # Level limit: how many levels a point may have, 1 to 254.

  stored @11 :Stored;
  # What each record of a grid, and each request, carries beside its state.

  spheres @12 :List(Sphere);
  # The spheres whose centres are stored; empty where the shape is not.

  equality @13 :Equality;
  # The tolerance function, so that merge and verify need no model process.

  lengthUnit @14 :Text;
  energyUnit @15 :Text;
  hipRadius @16 :Float64;
  # For people and pictures; empty or 0 where the model does not say. hipRadius: of the ball that
  # the HIP moves.

  forceScale @17 :Float64;
  # Newtons that one unit of energy per unit of length is; 0 where the model does not say.

  modelVersion @18 :Text;
  # The version of the model, in its own words. A model of another version does not go on with this
  # grid. Empty where the model does not say.

  enum Content {
    grid @0;
    # Record chunks: all records that are known.
    requests @1;
    # Request chunks: what some of the frontier's conversions reached.
  }
}

struct Equality {
  norm @0 :Norm;
  weights @1 :List(Float64);
  # Each component of the state has one, finite and not negative. Empty: all are 1.

  periods @2 :List(Float64);
  # Each component has one: 0 of a plain number, the period of an angle, or -1 of six components in a
  # row that are the first two columns of a rotation matrix. Empty: all are plain numbers.

  enum Norm {
    plugin @0;
    # The model is a plug-in, and its own function decides.
    max @1;
    # The model is a process; states a and b are equal when max_c w_c |a_c - b_c| <= tolerance.
    rms @2;
    # The same, with sqrt((1/n) sum_c (w_c (a_c - b_c))^2) <= tolerance.
  }
}

struct Stored {
  force @0 :Bool;
  energy @1 :Bool;
  shape @2 :Bool;
}

struct Parameter {
  key @0 :Text;
  # Tables are flattened: "probe.radius".

  value :union {
    boolean @1 :Bool;
    number @2 :Float64;
    text @3 :Text;
    numbers @4 :List(Float64);
    texts @5 :List(Text);
  }
}

# Chunks are columnar: entry r of each column belongs to row r. A chunk is near 64 KiB before it is
# compressed. A chunk of a grid never crosses a multiple of the points that one chunk holds at one level
# a point (the power of two that fits), so that a change of one record leaves the other chunks' bytes
# alone. The chunks of a finished grid may also be near 1 MiB (merge --small).

struct RecordChunk {
  # Records ascend by (point, level) through a section.

  point @0 :List(UInt32);
  # p = i + nx (j + ny k).

  level @1 :Data;
  # Each record has one byte here.

  generation @2 :List(UInt32);
  # The round in which the record was stored; 0 are the seed records.

  state @3 :List(Float64);
  # Component by component: component c of row r is state[c * rows + r].

  links @4 :Data;
  # 26 bytes a record, q ascending: the destination level in direction
  # q = (d1+1) + 3 (d2+1) + 9 (d3+1), the centre left out; 255 where the direction leaves the box,
  # 254 where it is not settled yet (the record is in the frontier).

  force @5 :List(Float64);
  energy @6 :List(Float64);
  shape @7 :List(Float32);
  # Where the header says that they are stored; else empty. Force on the HIP in newtons (3
  # components), energy (1), centres of the spheres (x y z by sphere), each component by component
  # like the states.
}

struct RequestChunk {
  # The requests of source records, which ascend by (point, level) through a section. A request's
  # target is point + offset(q), where offset = d1 + nx (d2 + ny d3).

  point @0 :List(UInt32);
  level @1 :Data;
  # Of the source record. Each record has one byte here.

  directions @2 :List(UInt32);
  # Bit q: the request in direction q is here. All these bits, record by record and q ascending, are
  # the requests of the chunk.

  state @3 :List(Float64);
  # The state reached; component by component: component c of request i is state[c * requests + i].

  force @4 :List(Float64);
  energy @5 :List(Float64);
  shape @6 :List(Float32);
  # What is stored with the state reached, as in RecordChunk.
}

struct Footer {
  headerSize @0 :UInt32;
  # Bytes of the header's zstd frame. The chunks stand between header and footer without a gap.

  chunks @1 :List(ChunkInfo);
  # In order.

  digestLow @2 :UInt64;
  digestHigh @3 :UInt64;
  # XXH3-128 (seed 0) of the digests, each as its low and its high word, little-endian, of the
  # header's message and of each chunk's.
}

struct ChunkInfo {
  size @0 :UInt32;
  # Bytes of the chunk's zstd frame.

  rows @1 :UInt32;

  frontier @2 :UInt32;
  # How many of its records are in the frontier: their generation is the header's.

  conversions @3 :UInt32;
  # Those that its frontier asks for; of a request chunk, its requests.

  firstPoint @4 :UInt32;
  lastPoint @5 :UInt32;
  # Of requests: of their source records.

  digestLow @6 :UInt64;
  digestHigh @7 :UInt64;
  # XXH3-128 of the chunk's message.
}
