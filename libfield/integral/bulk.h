// Fields of one primitive at many points, several points at a time with the widest instructions
// that the machine has. The result at a point is the same bits whatever the points beside it, and,
// but for the fields of points, whatever the instructions.
//
// To add a pair that has a closed form for every number type: its line in BulkRow, its entry in
// bulk_pack.h.
#pragma once

#include <cstddef>
#include <tuple>
#include <type_traits>

#include "libfield/base/jet.h"
#include "libfield/integral/far_reach.h"
#include "libfield/integral/far_sum.h"
#include "libfield/integral/frames.h"
#include "libfield/integral/line_sum.h"
#include "libfield/integral/point_sum.h"
#include "libfield/integral/segment_sum.h"
#include "libfield/integral/triangle_sum.h"
#include "libfield/primitive/plane.h"
#include "libfield/profile/profile.h"
#include "libfield/simd/isa.h"

namespace cs2mesh {

/// Adds sign * integral(kernel, frame, points[i]) to sums[i] for i < count; where `Out` is double,
/// the value alone.
template <class K, class F, class Out>
using AddIntegrals = void (*)(const K& kernel, const F& frame, double sign, const Vec3d* points,
                              Out* sums, std::size_t count);

/// Adds sign * integral(kernel, frame, points[i]) where the closed form keeps its digits; counts
/// where it does not in left[i], which is as long as the points, and kMostLanes longer.
template <class K, class Out>
using TryTriangle = void (*)(const K& kernel, const TriangleFrame<double>& frame, double sign,
                             const Vec3d* points, Out* sums, double* left, std::size_t count);
template <class Out>
using TriangleRow =
    std::tuple<TryTriangle<Cauchy, Out>, TryTriangle<Inverse, Out>, TryTriangle<Metaball, Out>,
               TryTriangle<Soft, Out>, TryTriangle<Quartic, Out>, TryTriangle<Gaussian, Out>,
               TryTriangle<Squared, Out>>;
inline constexpr std::size_t kMostLanes = 16;

template <class Out>
using BulkRow = std::tuple<
    AddIntegrals<Cauchy, SegmentFrame<double>, Out>, AddIntegrals<Cauchy, ArcFrame<double>, Out>,
    AddIntegrals<Gaussian, SegmentFrame<double>, Out>,
    AddIntegrals<Inverse, SegmentFrame<double>, Out>,
    AddIntegrals<Squared, SegmentFrame<double>, Out>,
    AddIntegrals<Metaball, SegmentFrame<double>, Out>,
    AddIntegrals<Soft, SegmentFrame<double>, Out>, AddIntegrals<Quartic, SegmentFrame<double>, Out>,
    AddIntegrals<Gaussian, ArcFrame<double>, Out>, AddIntegrals<Metaball, ArcFrame<double>, Out>,
    AddIntegrals<Inverse, ArcFrame<double>, Out>, AddIntegrals<Squared, ArcFrame<double>, Out>,
    AddIntegrals<Soft, ArcFrame<double>, Out>, AddIntegrals<Quartic, ArcFrame<double>, Out>,
    AddIntegrals<Cauchy, Plane, Out>, AddIntegrals<Gaussian, Plane, Out>,
    AddIntegrals<Metaball, Plane, Out>, AddIntegrals<Soft, Plane, Out>,
    AddIntegrals<Quartic, Plane, Out>, AddIntegrals<Cauchy, TaperedFrame<double>, Out>,
    AddIntegrals<Gaussian, TaperedFrame<double>, Out>>;

/// weights[i] = weight(profile, frame, points[i]) for i < count; where `Out` is double, w alone.
template <class F, class Out>
using FindWeights = void (*)(const StrengthProfile& profile, const F& frame, const Vec3d* points,
                             Out* weights, std::size_t count);
template <class Out>
using BulkWeights =
    std::tuple<FindWeights<SegmentFrame<double>, Out>, FindWeights<ArcFrame<double>, Out>>;

/// Values alone cost less; they are the same bits.
struct BulkTable {
  BulkRow<Jet> jets;
  BulkRow<double> values;
  BulkWeights<Jet> weight_jets;
  BulkWeights<double> weights;
  PointRow<Jet> point_jets;
  PointRow<double> point_values;
  TriangleRow<Jet> triangle_jets;
  TriangleRow<double> triangle_values;
  AddSegments<Jet> segment_jets;
  AddSegments<double> segment_values;
  AddLines<Jet> line_jets;
  AddLines<double> line_values;
  AddTriangles<Jet> sum_triangle_jets;
  AddTriangles<double> sum_triangle_values;
  ChooseFar choose_far;
  ChooseNodes choose_nodes;
  AddNodes add_nodes;
  AddSources add_sources;
  AddMoments add_moments;
  AddSeries<Jet> series_jets;
  AddSeries<double> series_values;

  template <class Out>
  const BulkRow<Out>& row() const {
    if constexpr (std::is_same_v<Out, double>) {
      return values;
    } else {
      return jets;
    }
  }
  template <class Out>
  AddSegments<Out> add_segments() const {
    if constexpr (std::is_same_v<Out, double>) {
      return segment_values;
    } else {
      return segment_jets;
    }
  }
  template <class Out>
  AddLines<Out> add_lines() const {
    if constexpr (std::is_same_v<Out, double>) {
      return line_values;
    } else {
      return line_jets;
    }
  }
  template <class Out>
  AddTriangles<Out> add_triangles() const {
    if constexpr (std::is_same_v<Out, double>) {
      return sum_triangle_values;
    } else {
      return sum_triangle_jets;
    }
  }
  template <class Out>
  AddSeries<Out> add_series() const {
    if constexpr (std::is_same_v<Out, double>) {
      return series_values;
    } else {
      return series_jets;
    }
  }
  template <class Out>
  const TriangleRow<Out>& triangle_row() const {
    if constexpr (std::is_same_v<Out, double>) {
      return triangle_values;
    } else {
      return triangle_jets;
    }
  }
  template <class Out>
  const PointRow<Out>& point_row() const {
    if constexpr (std::is_same_v<Out, double>) {
      return point_values;
    } else {
      return point_jets;
    }
  }
  template <class Out>
  const BulkWeights<Out>& weight_row() const {
    if constexpr (std::is_same_v<Out, double>) {
      return weights;
    } else {
      return weight_jets;
    }
  }
};

/// From this many points on the table is faster than integral(), which gives the same bits.
inline constexpr std::size_t kBulkCount = 4;

/// The pairs as compiled for active_isa().
const BulkTable& bulk_table();

namespace detail {
template <class Entry, class Row>
inline constexpr bool kHolds = false;
template <class Entry, class... Entries>
inline constexpr bool kHolds<Entry, std::tuple<Entries...>> = (std::is_same_v<Entry, Entries> ||
                                                               ...);
}  // namespace detail

/// Whether the table has that pair.
template <class F>
inline constexpr bool kHasBulkWeights = detail::kHolds<FindWeights<F, Jet>, BulkWeights<Jet>>;
template <class K>
inline constexpr bool kTriesTriangle = detail::kHolds<TryTriangle<K, Jet>, TriangleRow<Jet>>;
template <class K, class F>
inline constexpr bool kHasBulk = detail::kHolds<AddIntegrals<K, F, Jet>, BulkRow<Jet>>;

}  // namespace cs2mesh
