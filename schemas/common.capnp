# What several schemas share. It is imported by its plain name, so the schemas must lie in one folder.
@0xd10f0a2c5e8b4a37;

# The annotation of capnp/c++.capnp, repeated so that the schemas can be decoded with without it.
annotation namespace @0xb9c6f99ebf805f2c (file) :Text;
$namespace("hapgrid::schema");

struct Box {
  originX @0 :Float64;
  originY @1 :Float64;
  originZ @2 :Float64;
  # Position of the grid's point (0, 0, 0), in the model's unit of length.

  spacing @3 :Float64;
  countX @4 :UInt32;
  countY @5 :UInt32;
  countZ @6 :UInt32;
}

struct Sphere {
  # What stays the same of a sphere that shows the model, whatever the state.

  radius @0 :Float32;
  # In the model's unit of length.

  red @1 :Float32;
  green @2 :Float32;
  blue @3 :Float32;
  # 0 to 1.

  label @4 :Text;
  # Of an atom its element's symbol; at most 7 bytes, may be empty.
}
