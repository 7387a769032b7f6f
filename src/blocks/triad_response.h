#pragma once

#include <cstddef>

namespace vdb_offset {

/// The energy of a triad (see TriadEnergy) in each cell of a stack, as it follows from T = tr(A'A)
/// and D = det A, and its derivatives:
///
///     f = shape T / chi^(2/3) + volume (D^2 + 1) / chi,   chi = (D + sqrt(epsilon^2 + D^2)) / 2
struct TriadResponse {
  double shape = 0, volume = 0, epsilon = 0;
  const double *trace = nullptr, *det = nullptr;
  double* energy = nullptr;
  double* by_trace = nullptr;  ///< 2 df/dT
  double* by_det = nullptr;    ///< df/dD
  double* mixed = nullptr;     ///< 2 d2f/dTdD
  double* by_det2 = nullptr;   ///< d2f/dD2, with D = sqrt(epsilon^2 + D^2) in it: never less
};

/// The energy alone.
void respond(const TriadResponse& of, std::size_t cells);
/// The same energy, and the derivatives.
void respond_and_derive(const TriadResponse& of, std::size_t cells);

}  // namespace vdb_offset
