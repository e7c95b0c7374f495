// A value, or the diagnostics that say why there is none.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "libfield/base/check.h"
#include "libfield/base/diagnostics.h"

namespace cs2mesh {

/// Either a T (with notes and warnings, perhaps), or no T and at least one error.
template <class T>
class Result {
 public:
  Result(T value, std::vector<Diagnostic> remarks = {})  // NOLINT(google-explicit-constructor)
      : value_(std::move(value)), diagnostics_(std::move(remarks)) {}
  Result(Diagnostic error)  // NOLINT(google-explicit-constructor)
      : diagnostics_{std::move(error)} {}
  static Result failure(std::vector<Diagnostic> errors) {
    require(!errors.empty(), "Result::failure needs an error");
    Result result;
    result.diagnostics_ = std::move(errors);
    return result;
  }

  explicit operator bool() const { return value_.has_value(); }
  T& operator*() & {
    require(value_.has_value(), "Result has no value");
    return *value_;
  }
  const T& operator*() const& {
    require(value_.has_value(), "Result has no value");
    return *value_;
  }
  T&& operator*() && {
    require(value_.has_value(), "Result has no value");
    return std::move(*value_);
  }
  T* operator->() { return &**this; }
  const T* operator->() const { return &**this; }
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  Result() = default;
  std::optional<T> value_;
  std::vector<Diagnostic> diagnostics_;
};

/// Success without a value.
struct Done {};

inline Diagnostic error_at(SourceLocation where, std::string message,
                           Failure failure = Failure::bad_input) {
  return {Severity::error, failure, std::move(where), std::move(message)};
}

}  // namespace cs2mesh
