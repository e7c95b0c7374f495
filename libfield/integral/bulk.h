// Fields of one primitive at many points, several points at a time with the widest instructions
// that the machine has. The result at a point is the same bits whatever the instructions and the
// points beside it.
//
// To add a pair that has a closed form for every number type: its line in BulkTable, its entry in
// bulk_pack.h.
#pragma once

#include <cstddef>
#include <tuple>
#include <type_traits>

#include "libfield/base/jet.h"
#include "libfield/integral/frames.h"
#include "libfield/kernel/cauchy.h"
#include "libfield/kernel/gaussian.h"
#include "libfield/primitive/point.h"
#include "libfield/simd/isa.h"

namespace cs2mesh {

/// Adds sign * integral(kernel, frame, points[i]) to sums[i] for i < count.
template <class K, class F>
using AddIntegrals = void (*)(const K& kernel, const F& frame, double sign, const Vec3d* points,
                              Jet* sums, std::size_t count);

using BulkTable =
    std::tuple<AddIntegrals<Cauchy, Point>, AddIntegrals<Cauchy, SegmentFrame<double>>,
               AddIntegrals<Cauchy, ArcFrame<double>>, AddIntegrals<Gaussian, Point>,
               AddIntegrals<Gaussian, SegmentFrame<double>>>;

/// From this many points on the table is faster than integral(), which gives the same bits.
inline constexpr std::size_t kBulkCount = 4;

/// The pairs as compiled for active_isa().
const BulkTable& bulk_table();

namespace detail {
template <class Entry, class Table>
inline constexpr bool kHolds = false;
template <class Entry, class... Entries>
inline constexpr bool kHolds<Entry, std::tuple<Entries...>> = (std::is_same_v<Entry, Entries> ||
                                                               ...);
}  // namespace detail

/// Whether the table has that pair.
template <class K, class F>
inline constexpr bool kHasBulk = detail::kHolds<AddIntegrals<K, F>, BulkTable>;

}  // namespace cs2mesh
