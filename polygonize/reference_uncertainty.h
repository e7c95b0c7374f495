// How exactly the exact surface is known: what distances to it may be off by themselves.
#pragma once

#include <cstddef>

#include "libfield/base/progress.h"
#include "libfield/field/compile.h"

namespace cs2mesh {

/// Scene units: the largest, over points of the surface as measure() samples it (some `samples` of
/// them over all parts), of the Newton step |F| / |grad F| that leads from there to where F is 0,
/// and, for parts with a field, of what the error budget of F shifts the surface by, `error_budget`
/// over |grad F| (see CompileOptions); and the rounding of coordinates. Distances below it tell
/// nothing. To first order, over samples, not proven in between; infinite where a sample has no
/// gradient. Once cancelled, over the samples so far. Two values and a few jets a sample.
double reference_uncertainty(const CompiledScene& compiled, double error_budget,
                             std::size_t samples, const Progress* progress = nullptr);

}  // namespace cs2mesh
