// The bytes of IMD version 2, the protocol by which simulations show themselves to VMD. No sockets
// here.
//
// A message is a header, two big-endian int32: type and length; and a body in the byte order of the
// server, which the client learns from the handshake. The atoms are the scene's spheres in their
// order, and the HIP, held in the box, as the last one.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libcore/scene/scene.hpp"

namespace hapgrid {

/// Factors that take the model's lengths to angstroms, and its energies to kcal/mol. The factor of
/// an unknown unit is 1. Known are m, mm, nm, angstrom, pm, bohr; kJ/mol, kcal/mol, J, eV, hartree.
struct ImdUnits {
  double length = 1;
  double energy = 1;
  bool length_known = false;
  bool energy_known = false;
  explicit ImdUnits(const Scene& scene);
};

/// HANDSHAKE.
std::vector<std::byte> imd_greeting();
/// ENERGIES, if the frame has an energy, and FCOORDS. The step is the tick, at most 2^31 - 1. Total
/// and potential energy are the model's; all other energies and the temperature are 0.
std::vector<std::byte> imd_frame(const Frame& frame, const ImdUnits& units);

/// The messages of a client. Clients are hostile: forces and rates are read, counted and thrown
/// away, and only the position in the current message is kept. A message of a type that only
/// servers send, or forces on more atoms than there are, close the client.
class ImdListener {
 public:
  enum class State {
    kGreeted,  ///< the client has yet to say GO
    kRunning,
    kPaused,
    kClosed,  ///< the client asked for that (DISCONNECT, KILL), or broke the rules
  };

  /// @param atoms spheres and HIP.
  explicit ImdListener(std::size_t atoms) : atoms_(atoms) {}

  /// Reads the next bytes of the client, in pieces of any size.
  State read(std::span<const std::byte> bytes);
  State state() const { return state_; }
  /// Whether the client has sent forces on atoms, or asked for another rate of frames.
  bool sent_forces() const { return sent_forces_; }
  bool sent_rate() const { return sent_rate_; }

 private:
  void obey(std::int32_t type, std::int32_t length);

  std::size_t atoms_;
  State state_ = State::kGreeted;
  std::array<std::byte, 8> header_{};
  std::size_t filled_ = 0;  // bytes of the header
  std::uint64_t skip_ = 0;  // bytes of a body that are still to come
  bool sent_forces_ = false;
  bool sent_rate_ = false;
};

}  // namespace hapgrid
