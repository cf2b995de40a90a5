// The morph where bonds break and form: positions in space, see morph.hpp.
#include <Eigen/LU>
#include <Eigen/SVD>

#include "tools/apps/molecule/morph.hpp"

namespace hapgrid::molecule {

namespace {

/// How far apart the ends of a path may lie that closes, when its nodes have been aligned one by
/// one, Å: otherwise the turn has left the molecule another way round.
constexpr double kMeets = 1e-3;

/// The shape, shifted and turned to the least weighted distance from the reference (Kabsch).
Positions superposed(const Positions& shape, const Positions& reference,
                     const std::vector<double>& weight) {
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = from;
  double total = 0;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    from += weight[i] * shape[i];
    to += weight[i] * reference[i];
    total += weight[i];
  }
  from /= total, to /= total;
  Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < shape.size(); ++i)
    h += weight[i] * (shape[i] - from) * (reference[i] - to).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(h, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d v = svd.matrixV();
  if ((v * svd.matrixU().transpose()).determinant() < 0) v.col(2) *= -1;
  const Eigen::Matrix3d rotation = v * svd.matrixU().transpose();
  Positions out;
  for (const Eigen::Vector3d& x : shape) out.emplace_back(rotation * (x - from) + to);
  return out;
}

}  // namespace

void Morph::find_splines_in_space(const Molecule& molecule) {
  const auto flat = [this](const Positions& shape) {
    std::vector<double> q(3 * stride_);
    for (std::size_t i = 0; i < shape.size(); ++i)
      for (int a = 0; a < 3; ++a)
        q[static_cast<std::size_t>(a) * stride_ + i] = shape[i][a] - centre_[a];
    return q;
  };
  q0_ = flat(molecule.conformation);
  for (const Path& path : molecule.paths) {
    std::vector<Positions> chain = path.nodes;
    chain[path.start] = molecule.conformation;
    for (std::size_t m = path.start + 1; m < chain.size(); ++m)
      chain[m] = superposed(chain[m], chain[m - 1], weight_);
    for (std::size_t m = path.start; m-- > 0;)
      chain[m] = superposed(chain[m], chain[m + 1], weight_);
    double apart = 0;
    for (std::size_t i = 0; i < tree_.size(); ++i)
      apart = std::max(apart, (chain.front()[i] - chain.back()[i]).norm());
    std::vector<std::vector<double>> nodes;
    nodes.reserve(chain.size());
    for (const Positions& shape : chain) nodes.push_back(flat(shape));
    paths_.push_back(through(path, nodes, path.closes && apart < kMeets));
  }
}

}  // namespace hapgrid::molecule
