// The bytes of IMD, the protocol by which simulations show themselves to VMD (version 2) and to
// MDAnalysis (version 3: https://imdclient.readthedocs.io, "IMDv3 Protocol"). No sockets here.
//
// A message is a header, two big-endian int32: type and length; and a body in the byte order of the
// server, which the client learns from the handshake. The atoms are the scene's spheres in their
// order, and the HIP, held in the box, as the last one.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libcore/scene/scene.hpp"

namespace hapgrid {

enum class ImdType : std::int32_t {
  kDisconnect = 0,
  kEnergies = 1,
  kCoordinates = 2,
  kGo = 3,
  kHandshake = 4,
  kKill = 5,
  kForcesOnAtoms = 6,  ///< MDCOMM: forces that the client wants to act on atoms
  kPause = 7,
  kRate = 8,  ///< TRATE
  // Version 3.
  kSessionInfo = 10,
  kResume = 11,
  kTime = 12,
  kBox = 13,
  kForces = 15,
  kWait = 16,
};

/// Factors that take the model's lengths to angstroms, and its energies to kcal/mol (version 2) or
/// kJ/mol (version 3). The factor of an unknown unit is 1.
struct ImdUnits {
  double length = 1;
  double energy = 1;
  bool length_known = false;
  bool energy_known = false;
  /// Known are m, mm, nm, angstrom, pm, bohr; kJ/mol, kcal/mol, J, eV, hartree.
  ImdUnits(int version, const std::string& length_unit, const std::string& energy_unit);
  static const char* energy_name(int version) { return version == 2 ? "kcal/mol" : "kJ/mol"; }
};

/// The messages of a server: a greeting to each client, then frames.
///
/// A frame of version 2 has the messages ENERGIES (if the model has an energy) and FCOORDS. A frame
/// of version 3 has TIME, ENERGIES (likewise), BOX, FCOORDS and FORCES. TIME has the time and the
/// length of a tick in ps. BOX has the edges of the grid's box, which is not periodic, and whose
/// corner need not be at 0. FORCES has the force on the HIP as it was sent to the device, a newton
/// as one kJ/(mol angstrom), and zero for the spheres. The step is the tick; ENERGIES has 32 bits
/// for it, so it is at most 2^31 - 1 there. Total and potential energy are the model's; all other
/// energies and the temperature are 0.
class ImdEncoder {
 public:
  /// @param version 2 or 3. @param tick_s seconds.
  ImdEncoder(int version, const Scene& scene, bool has_energy, double tick_s);

  /// HANDSHAKE, and SESSIONINFO with version 3.
  std::vector<std::byte> greeting() const;
  /// All messages of one frame; valid until the next call. The frame has the scene's spheres.
  std::span<const std::byte> encode(const Frame& frame);

 private:
  int version_;
  bool has_energy_;
  ImdUnits units_;
  double tick_ps_;
  std::array<float, 9> box_{};
  std::size_t spheres_;
  std::vector<std::byte> bytes_;
};

/// The messages of a client. Clients are hostile: forces and rates are read, counted and thrown
/// away, and only the position in the current message is kept. A message of a type that only
/// servers send, a negative length, or forces on more atoms than there are, close the client.
class ImdListener {
 public:
  enum class State {
    kGreeted,  ///< the client has yet to say GO
    kRunning,
    kPaused,
    kClosed,  ///< the client asked for that (DISCONNECT, KILL), or broke the rules
  };

  /// @param atoms spheres and HIP.
  ImdListener(int version, std::size_t atoms) : version_(version), atoms_(atoms) {}

  /// Reads the next bytes of the client, in pieces of any size.
  State read(std::span<const std::byte> bytes);
  State state() const { return state_; }
  /// How many messages so far asked for what no client gets.
  struct Ignored {
    std::uint64_t forces = 0;  ///< forces on atoms
    std::uint64_t rates = 0;   ///< another rate of frames
  };
  const Ignored& ignored() const { return ignored_; }

 private:
  void obey(std::int32_t type, std::int32_t length);

  int version_;
  std::size_t atoms_;
  State state_ = State::kGreeted;
  std::array<std::byte, 8> header_{};
  std::size_t filled_ = 0;  // bytes of the header
  std::uint64_t skip_ = 0;  // bytes of a body that are still to come
  Ignored ignored_;
};

}  // namespace hapgrid
