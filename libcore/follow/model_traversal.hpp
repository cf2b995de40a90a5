// The reference for the rules of traversal: it asks the model itself along the way of the hand, in
// steps that are small against the spacing. It is as slow as the model, so it is for virtual time.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libcore/follow/traversal.hpp"
#include "libcore/model/model.hpp"

namespace hapgrid {

class ModelTraversal final : public Traversal {
 public:
  /// @param steps_a_cell the model is asked at least so often on the way along one spacing; > 0
  /// @throw Error as CellWalk does
  ModelTraversal(const Grid& grid, std::unique_ptr<Model> model, double steps_a_cell = 32,
                 std::uint16_t most_parts = CellWalk::kDefaultMaxParts);
  using Traversal::start;
  using Traversal::step;
  const StepResult& start(const Vec3& hip, Level level) noexcept override;
  /// `blocked` when a conversion fails: the state is held.
  const StepResult& step(const Vec3& hip, bool next) noexcept override;
  /// The state that the model will have when the hand has gone straight on to x, in the box; this
  /// stays where it is. Real-time safe as far as the model.
  /// @param row spec().row_size() values. @returns false when a conversion fails
  bool look_ahead(const Vec3& x, std::span<double> row) noexcept;
  /// Why the last conversion that failed did.
  const std::string& model_error() const { return model_->error(); }
  /// Model::abandon(), which any thread may call.
  void abandon() noexcept { model_->abandon(); }

 private:
  bool take(int nearest, Level level) noexcept;
  Level level_at(int corner) const noexcept;
  bool follow(Vec3 from, const Vec3& to) noexcept;

  std::unique_ptr<Model> model_;
  double longest_;  // step, in the model's unit
  std::vector<double> next_;
  std::vector<double> before_row_;
};

}  // namespace hapgrid
