#include "libfield/field/term_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libfield/field/box_view.h"
#include "libfield/field/kink_remainder.h"
#include "libfield/field/quadratic_range.h"
#include "libfield/field/weight_bounds.h"

namespace cs2mesh {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
/// The side of difference quotients, in units of half the diagonal: what they are off by stays
/// under a fortieth of the remainder of second order, and the rounding far below that.
constexpr double kStep = 1.0 / 64;

/// A remainder up to this, in units of T, is small beside what a box of use leaves open.
constexpr double kSmallRemainder = 1e-3;
/// Boxes whose integrals are computed together.
constexpr std::size_t kBatch = 64;

/// Adds weight * I as Taylor polynomials about the centres of boxes whose hull is `hull`, over
/// which `turn` bounds |D^2 I|.
template <class K, class P>
class TaylorSum {
 public:
  TaylorSum(const Term& term, const K& kernel, const P& primitive, const LocalBox& hull,
            const Reach& reach, const Interval& integral, double turn, const BoxBatch& batch)
      : term_(term),
        kernel_(kernel),
        primitive_(primitive),
        stretch_(hull.stretch),
        reach_(reach),
        integral_(integral),
        turn_(turn),
        batch_(batch),
        condition_(condition_number(primitive)),
        least_(rounding_size(kernel, primitive, reach)),
        second_(kernel, primitive, 2, reach.near, span_of(hull, batch)),
        third_(kernel, primitive, 3, reach.near, span_of(hull, batch)) {}

  /// `weight`: what is known of the product of the profiles over all boxes.
  void add(const Interval& weight, double negligible, std::span<SumBound> sums) {
    const bool constant = weight.width() * integral_.magnitude() <= negligible;
    const double radius = batch_.radius * stretch_;
    const double small = std::max(negligible, kSmallRemainder);
    const bool near = 0.5 * turn_ * radius * radius > small;
    const std::size_t stride = near ? batch_.stride() : 1;
    const std::size_t run = kBatch / stride;
    std::array<Jet, kBatch> jets;
    std::vector<Vec3d> local;
    for (std::size_t first = 0; first < sums.size(); first += run) {
      const std::size_t n = std::min(run, sums.size() - first);
      find_jets(first, n, stride, local, jets);
      for (std::size_t i = 0; i < n; ++i) {
        const std::span own(jets.data() + stride * i, stride);
        const Place at{batch_.boxes[first + i], local[stride * i],
                       std::max(norm(own[0].gradient), least_.slope)};
        if (term_.to_local) {
          for (Jet& jet : own) jet.gradient = to_world_gradient(term_, jet.gradient);
        }
        const Interval w = constant ? weight : weight_at(at.box.box);
        if (near) {
          add_near(own, w, at, sums[first + i]);
        } else {
          add_one(own, w, at, 0.5 * turn_ * square(at.box.radius * stretch_), turn_,
                  sums[first + i]);
        }
      }
    }
  }

 private:
  /// One box.
  struct Place {
    const BatchBox& box;
    Vec3d center;  ///< in local coordinates
    double slope;  ///< the norm of the gradient of I there
  };

  static double square(double x) { return x * x; }
  static double span_of(const LocalBox& hull, const BoxBatch& batch) {
    return batch.boxes.size() > 1 ? 2 * hull.radius : 0.0;
  }

  Interval weight_at(const Aabb& box) const {
    return weight_range(term_, primitive_, local_box(term_, box).box);
  }

  /// The integral at `stride` points of each box.
  void find_jets(std::size_t first, std::size_t n, std::size_t stride, std::vector<Vec3d>& local,
                 std::array<Jet, kBatch>& jets) const {
    local.clear();
    if (stride == 1) {
      for (std::size_t i = 0; i < n; ++i) local.push_back(batch_.boxes[first + i].center);
    } else {
      batch_.append_points(first, n, local);
    }
    local_jets(term_, kernel_, primitive_, local, jets);
  }

  /// With bounds of the derivatives in that box alone, of the order that leaves less open.
  void add_near(std::span<const Jet> jets, const Interval& weight, const Place& at, SumBound& sum) {
    const double radius = at.box.radius * stretch_;
    const Gap g = gap(term_, primitive_, at.center, at.box.half, radius);
    // Both pieces of the remainder of box_view.h.
    const double inner_turn = second_.at(g.near(0.5));
    const double outer_turn = batch_.boxes.size() == 1 ? turn_ : second_.at(g.near(1.0));
    const double first = square(radius) * (0.375 * inner_turn + 0.125 * outer_turn);
    if (jets.size() > 1) {
      const double cubed = stretch_ * stretch_ * stretch_;
      const double error =
          gradient_error(condition_, at.slope, inner_turn, reach_.scale) * stretch_;
      double second = second_remainder(at.box, cubed * third_.at(g.near(0.5)),
                                       cubed * third_.at(g.near(1.0)), error);
      if constexpr (kHasKinks<K> && !std::is_same_v<P, Plane>) {
        if (second < first) {
          second += kink_remainder(kernel_, primitive_, at.center, radius, 2 * kStep * radius);
        }
      }
      if (second < first) return add_one(jets, weight, at, second, inner_turn, sum);
    }
    add_one(jets.first(1), weight, at, first, outer_turn, sum);
  }

  void add_one(std::span<const Jet> jets, const Interval& weight, const Place& at, double remainder,
               double turn, SumBound& sum) const {
    const double middle = 0.5 * (weight.lo + weight.hi);
    const double factor = std::abs(middle);
    const double radius = at.box.radius * stretch_;
    sum.add_polynomial(term_.sign * middle, jets, at.box);
    sum.remainder += factor * remainder;
    sum.deviation += (0.5 * weight.width() + 4 * kEpsilon * factor) * integral_.magnitude();
    sum.rounding +=
        factor * kBackwardError *
        (condition_ * (std::max(std::abs(jets[0].value), least_.value) + at.slope * radius) +
         (at.slope + turn * radius) * reach_.scale);
  }

  const Term& term_;
  const K& kernel_;
  const P& primitive_;
  double stretch_;
  const Reach& reach_;
  const Interval& integral_;
  double turn_;
  const BoxBatch& batch_;
  double condition_;
  RoundingSize least_;
  BoundSteps<K, P> second_, third_;
};

/// add_bounds() for one pair.
template <class K, class P>
void add_pair(const Term& term, const K& kernel, const P& primitive, const BoxBatch& batch,
              double negligible, std::span<SumBound> sums) {
  const LocalBox hull = local_box(term, batch.hull);
  const Reach r = reach(term, primitive, hull);
  const Interval integral = integral_range(kernel, primitive, r);
  Interval weight(1.0);
  if (!term.profiles.empty()) weight = weight_range(term, primitive, hull.box);
  const Interval range = Interval(term.sign) * weight * integral;
  if (range.width() <= negligible) {
    for (SumBound& sum : sums) sum.range = sum.range + range;
    return;
  }
  const double radius = batch.radius * hull.stretch;
  const double turn = near_bound(kernel, primitive, 2, r.near);
  const auto third = [&] { return near_bound(kernel, primitive, 3, r.near); };
  if (turn * radius * radius < integral.width() ||
      (batch.order == TaylorOrder::second &&
       3 * integral.width() > third() * radius * radius * radius)) {
    TaylorSum<K, P>(term, kernel, primitive, hull, r, integral, turn, batch)
        .add(weight, negligible, sums);
  } else if (sums.size() == 1) {
    sums[0].range = sums[0].range + range;
  } else {
    for (std::size_t i = 0; i < sums.size(); ++i) {
      add_pair(term, kernel, primitive, BoxBatch(batch.boxes.subspan(i, 1), batch.order),
               negligible, sums.subspan(i, 1));
    }
  }
}

}  // namespace

BatchBox::BatchBox(const Aabb& box_) : box(box_), center(box_.center()), half(half_edges(box_)) {
  radius = norm(half) * (1 + 4 * kEpsilon);
  for (std::size_t i = 0; i < 3; ++i) {
    // Within the half box; as long as the rounding of coordinates lets it be.
    const double nominal = std::min(kStep * radius, 0.25 * half[i]);
    const double taken = (center[i] + nominal) - center[i];
    step[i] = 0.5 * nominal < taken && taken < 2 * nominal ? taken : 0.0;
  }
}

std::array<Vec3d, 4> BatchBox::points() const {
  return {center, center + Vec3d{step.x, 0, 0}, center + Vec3d{0, step.y, 0},
          center + Vec3d{0, 0, step.z}};
}

BoxBatch::BoxBatch(std::span<const BatchBox> boxes_, TaylorOrder order_)
    : boxes(boxes_), order(order_) {
  for (const BatchBox& box : boxes) {
    radius = std::max(radius, box.radius);
    hull.include(box.box);
  }
}

void BoxBatch::append_points(std::size_t first, std::size_t count,
                             std::vector<Vec3d>& points) const {
  for (const BatchBox& box : boxes.subspan(first, count)) {
    const std::array<Vec3d, 4> all = box.points();
    points.insert(points.end(), all.begin(), all.begin() + static_cast<std::ptrdiff_t>(stride()));
  }
}

Symmetric3 difference_quotient(std::span<const Jet> jets, const BatchBox& box) {
  const Vec3d& g = jets[0].gradient;
  const Vec3d x = (jets[1].gradient - g) / box.step.x;
  const Vec3d y = (jets[2].gradient - g) / box.step.y;
  const Vec3d z = (jets[3].gradient - g) / box.step.z;
  return {x.x, y.y, z.z, 0.5 * (x.y + y.x), 0.5 * (x.z + z.x), 0.5 * (y.z + z.y)};
}

double quotient_error(const BatchBox& box, double inner, double gradient_error) {
  const Vec3d& step = box.step;
  const double least = std::min({step.x, step.y, step.z});
  const double most = std::max({step.x, step.y, step.z});
  if (!(least > 0)) return std::numeric_limits<double>::infinity();
  // A column is off by step / 2 |D^3 f| and by the errors of both gradients; the matrix by at most
  // sqrt(3) times as much.
  return std::numbers::sqrt3 * (0.5 * most * inner + 2 * gradient_error / least);
}

void SumBound::add_polynomial(double factor, std::span<const Jet> jets, const BatchBox& box) {
  center.value += factor * jets[0].value;
  center.gradient += factor * jets[0].gradient;
  if (jets.size() > 1) center.hessian += factor * difference_quotient(jets, box);
}

void SumBound::add_polynomial(std::span<const Jet> jets, double first, double second,
                              const BatchBox& box) {
  const bool better = jets.size() > 1 && second < first;
  add_polynomial(1.0, better ? jets : jets.first(1), box);
  remainder += better ? second : first;
}

// The remainders in the two pieces of box_view.h.

double second_remainder(const BatchBox& box, double inner, double outer, double gradient_error) {
  const double cubic = box.radius * (7.0 / 48 * inner + 1.0 / 48 * outer);
  const double quotient = quotient_error(box, inner, gradient_error);
  return box.radius * box.radius * (cubic + 0.5 * quotient);
}

double second_gradient_remainder(const BatchBox& box, double inner, double outer,
                                 double gradient_error) {
  const double square = box.radius * (0.375 * inner + 0.125 * outer);
  return box.radius * (square + quotient_error(box, inner, gradient_error));
}

void add_bounds(const Term& term, const BoxBatch& batch, double negligible,
                std::span<SumBound> sums) {
  visit_pair(term, [&](const auto& kernel, const auto& primitive) {
    add_pair(term, kernel, primitive, batch, negligible, sums);
  });
}

Interval range_of(const SumBound& sum, std::size_t terms, const BatchBox& box) {
  const Interval polynomial = quadratic_range(sum.center.gradient, sum.center.hessian, box.half);
  // n terms add up to within n / 2 ulp of their magnitudes, in either order.
  const double rounding = sum.rounding * (1 + static_cast<double>(terms) / 32);
  const double deviation = (sum.remainder + sum.deviation + rounding) * (1 + 1e-12);
  return widened(sum.range + Interval(sum.center.value) + polynomial, deviation);
}

}  // namespace cs2mesh
