// Contract checks: for errors of the calling code, never for errors in a user's input.
#pragma once

#include <stdexcept>
#include <string>

namespace cs2mesh {

/// Thrown when a caller breaks a documented precondition.
class ContractViolation : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// Throws ContractViolation with `what` unless `condition` holds.
inline void require(bool condition, const char* what) {
  if (!condition) throw ContractViolation(what);
}

}  // namespace cs2mesh
