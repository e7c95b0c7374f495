// The field of an infinite line at the distance x, for kernels of width and amplitude 1; that of a
// kernel of width w (support radius w, or s = a = 1 / w) is w I(x / w):
//   cauchy (pi / 2) (1 + x^2)^(-3/2), gaussian sqrt(pi) e^(-x^2), squared pi / x;
//   finite supports: that of a segment longer than the support.
// The inverse kernel has none: it diverges.
#pragma once

#include "libfield/kernel/kind.h"

namespace cs2mesh {

/// I with its derivatives by x.
struct LineField {
  double value, slope, curvature;
};

/// A few ulp of the value, more near the edge of a finite support; 0 beyond it. x >= 0, and > 0 for
/// the squared kernel. ContractViolation for the inverse kernel.
LineField line_field(KernelKind kind, double x);

/// log I(x), also where I underflows.
double log_line_field(KernelKind kind, double x);

}  // namespace cs2mesh
