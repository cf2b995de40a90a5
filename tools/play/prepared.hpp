// A grid and all that plays it but a device.
#pragma once

#include <future>
#include <memory>
#include <string>

#include "libcore/follow/beside.hpp"
#include "libcore/follow/traversal.hpp"
#include "libcore/grid/vec3.hpp"
#include "libcore/model/fields.hpp"
#include "libcore/shard/reader.hpp"
#include "tools/common/models.hpp"
#include "tools/common/traversals.hpp"
#include "tools/play/played_force.hpp"

namespace hapgrid {

/// A complete grid, and its model.
struct PlayedGrid {
  /// @param name "-": standard input @throw Error, ModelError, std::system_error
  PlayedGrid(const std::string& name, const ModelOptions& options)
      : PlayedGrid(open_grid(name), options) {}
  PlayedGrid(const PlayedGrid&) = delete;
  PlayedGrid& operator=(const PlayedGrid&) = delete;

  const GridSpec& spec() const { return grid.spec(); }

  const std::string digest;  ///< Section::name()
  const Grid grid;
  const MakeModel create;        ///< the plug-in's
  const MakeModel create_exact;  ///< one that answers as the grid's did, also a process
  const Fields fields;

 private:
  PlayedGrid(const Section& section, const ModelOptions& options);
};

/// What follows the hand through a grid.
struct Follower {
  /// @param wanted, must, live as make_beside() has them. @param grid outlives this.
  Follower(const PlayedGrid& grid, TraversalRule rule, const std::string& wanted, bool must,
           bool live);

 private:
  std::future<NodeForces> records_;  // asked by all threads, while one prepares the traversal

 public:
  const std::unique_ptr<Traversal> traversal;
  const std::unique_ptr<Beside> beside;  ///< null: the grid alone decides
  PlayForce force;
};

}  // namespace hapgrid
