// A bisection that stops as early as bounds allow. A piece [a, b] of the ray is settled by the
// first of
//   1. the enclosure of F over its box does not contain 0: no root
//   2. value and slope at both ends and |F''| <= M prove F monotone: 0 or 1 root, by the signs
//   3. they prove F to be of one sign throughout: no root
//   4. it is shorter than the accuracy, or F is lost in rounding: uncertain
// and divided otherwise. Where F has no bounded second derivative (a crease), the slopes' enclosure
// takes the place of M. The certificates are those of certificate.h.
#include "libfield/ray/ray_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "libfield/base/check.h"
#include "libfield/ray/certificate.h"

namespace cs2mesh {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A division takes at least an eighth off, so that the stack is never higher than
/// log(length / shortest) / log(8/7), which is less than 280 for doubles.
constexpr std::size_t kDeepest = 288;

/// A place on the ray, evaluated or not.
struct Node {
  double t = 0.0;
  EndJet f;
  bool known = false;
};

bool is_inside(const Node& node) {
  return node.f.value >= 0.0;
}

/// What bounds the slope on a piece: the second derivative, or else the slope itself.
struct SlopeBound {
  double M = kInfinity;
  Interval slope = Interval::everything();
  double h = kInfinity;  ///< length of the piece that it was made for

  bool second_order() const { return std::isfinite(M); }
};

class Search {
 public:
  /// `tree` is that of the surface, or null.
  Search(const ImplicitSurface& surface, const BoundTree* tree, const Ray& ray,
         const RaySolverOptions& options, RayCost& cost)
      : surface_(surface), tree_(tree), ray_(ray), options_(options), cost_(cost) {}

  /// Appends what is found on [t0, t1]; stops after the first if `first_only`.
  void run(double t0, double t1, bool first_only, std::vector<RayHit>& hits);

 private:
  struct Piece {
    Node a, b;
    SlopeBound bound;       ///< that of a longer piece holds as well
    bool enclosed = false;  ///< an enclosure has been tried already
    double h() const { return b.t - a.t; }
  };

  bool prepare(double t0, double t1);
  void stack_pieces();
  void settle(Piece piece);
  void settle_unknown(Piece& piece);
  bool settle_from_ends(const Piece& piece);
  void add_hit(const Piece& bracket);
  void add_undecided(Piece piece);
  void flush_undecided();
  void divide(const Piece& piece, double t);
  double place_to_divide(const Piece& piece) const;

  /// Takes in a lower bound of F along the ray, if it is the first.
  void set_scale(double lower) {
    if (scaled_ || !std::isfinite(lower) || lower == 0.0) return;
    scale_ = std::abs(lower);
    scaled_ = true;
  }
  void evaluate(Node& node);
  void evaluate_ends(Piece& piece);
  Interval enclose(const Aabb& box);
  void bound_slope(Piece& piece, const Aabb& box);
  Aabb box_of(const Piece& piece) const;
  RayHit polish(Piece bracket);

  /// A value there this near to 0 has no certain sign. What F is elsewhere does not matter: deep
  /// inside a stiff field it may be 1e300.
  double noise(const Node& node) const {
    const double own = std::isfinite(node.f.value) ? std::abs(node.f.value) : 0.0;
    return 64.0 * kEpsilon * (scale_ + own) + options_.value_error;
  }
  double noise(const Piece& piece) const { return std::max(noise(piece.a), noise(piece.b)); }
  /// How far the rounded position may be from the exact one.
  double position_error(double t) const {
    const Vec3d& o = ray_.origin;
    return 4.0 * kEpsilon * (std::max({std::abs(o.x), std::abs(o.y), std::abs(o.z)}) + std::abs(t));
  }
  double shortest(double t) const { return std::max(accuracy_, 4.0 * position_error(t)); }
  bool is_undecided(const Node& node) const { return std::abs(node.f.value) <= noise(node); }
  bool spent() const {
    return cost_.jets + cost_.bounds - start_ >
           static_cast<std::uint64_t>(options_.max_evaluations);
  }

  const ImplicitSurface& surface_;
  const BoundTree* tree_;
  const Ray& ray_;
  const RaySolverOptions& options_;
  RayCost& cost_;
  std::uint64_t start_ = 0;
  double t0_ = 0.0, t1_ = 0.0;  // the range after clipping
  double accuracy_ = 0.0;
  double scale_ = 0.0;  // of what F is summed from where it is 0: |lower bound of F|, else |F| met
  bool scaled_ = false;

  std::vector<Piece> stack_;  // still to be settled, the nearest on top
  std::size_t tallest_ = kDeepest;

  std::optional<Piece> undecided_;
  std::vector<RayHit>* hits_ = nullptr;
};

void Search::evaluate(Node& node) {
  if (node.known) return;
  ++cost_.jets;
  const Jet jet = surface_.jet(ray_.at(node.t));
  node.f = {jet.value, dot(jet.gradient, ray_.direction)};
  node.known = true;
  if (!scaled_ && std::isfinite(jet.value)) scale_ = std::max(scale_, std::abs(jet.value));
}

void Search::evaluate_ends(Piece& piece) {
  evaluate(piece.a);
  evaluate(piece.b);
  // The next piece, unless empty space lies between, starts where this one ends.
  if (stack_.empty() || stack_.back().a.t != piece.b.t) return;
  if (is_undecided(piece.b)) {
    // A division fell on a root: step back to where F has a sign, if that is near.
    const double step =
        std::max(8.0 * noise(piece.b) / std::abs(piece.b.f.slope), shortest(piece.b.t) / 16.0);
    if (step < piece.h() / 16.0) {
      piece.b = {piece.b.t - step, {}, false};
      evaluate(piece.b);
    }
  }
  stack_.back().a = piece.b;
}

Aabb Search::box_of(const Piece& piece) const {
  Aabb box;
  box.include(ray_.at(piece.a.t));
  box.include(ray_.at(piece.b.t));
  return box.grown(position_error(std::max(std::abs(piece.a.t), std::abs(piece.b.t))));
}

Interval Search::enclose(const Aabb& box) {
  ++cost_.bounds;
  Interval range;  // whose sign matters
  surface_.enclose_each({&box, 1}, {&range, 1});
  return range;
}

void Search::bound_slope(Piece& piece, const Aabb& box) {
  // A bound costs several jets; that of a piece not three times as long will do.
  SlopeBound& bound = piece.bound;
  if (bound.second_order() && 3.0 * piece.h() > bound.h) return;
  ++cost_.bounds;
  bound = {};
  bound.h = piece.h();
  bound.M = surface_.derivative_bound(2, box);
  if (bound.second_order()) return;
  bound.M = kInfinity;

  ++cost_.bounds;
  const std::array<Interval, 3> gradient = surface_.enclose_gradient(box);
  bound.slope = Interval(ray_.direction.x) * gradient[0] +
                Interval(ray_.direction.y) * gradient[1] + Interval(ray_.direction.z) * gradient[2];
  if (!std::isfinite(bound.slope.lo) || !std::isfinite(bound.slope.hi)) {
    ++cost_.bounds;
    const double lipschitz = surface_.derivative_bound(1, box);
    bound.slope = {std::max(bound.slope.lo, -lipschitz), std::min(bound.slope.hi, lipschitz)};
  }
  if (!(bound.slope.lo <= bound.slope.hi)) bound.slope = Interval::everything();
}

/// True if jets at the ends could prove nothing, whatever they are, |F| being at most `most`: then
/// a division without them is cheaper. With |F''| <= M, a proof of one sign needs |F| > M h^2 / 16
/// at an end, and so does a proof of monotony.
bool jets_are_useless(const SlopeBound& bound, double h, double most) {
  if (bound.second_order()) return bound.M * h * h / 16.0 >= most;
  const Interval& s = bound.slope;
  if (s.lo >= 0.0 || s.hi <= 0.0) return false;
  if (!std::isfinite(s.lo) || !std::isfinite(s.hi)) return true;
  return -s.lo * s.hi / (s.hi - s.lo) * h >= most;
}

void Search::settle(Piece piece) {
  const double middle = 0.5 * (piece.a.t + piece.b.t);
  if (spent() || stack_.size() >= tallest_) return add_undecided(piece);
  if (!piece.enclosed && !(piece.a.known && piece.b.known)) return settle_unknown(piece);
  evaluate_ends(piece);

  // Jets at both ends: they may do with the bound at hand, or else with a tighter one.
  if (piece.bound.second_order() && settle_from_ends(piece)) return;
  if (piece.h() <= shortest(middle)) return add_undecided(piece);
  const double M = piece.bound.M;
  bound_slope(piece, box_of(piece));
  if ((piece.bound.M < M || !piece.bound.second_order()) && settle_from_ends(piece)) return;
  divide(piece, place_to_divide(piece));
}

/// For a piece that has not been evaluated at both ends.
void Search::settle_unknown(Piece& piece) {
  const Aabb box = box_of(piece);
  const Interval range = enclose(box);
  set_scale(range.lo);
  if (range.lo > options_.value_error || range.hi < -options_.value_error) {
    return flush_undecided();
  }
  const double middle = 0.5 * (piece.a.t + piece.b.t);
  if (piece.h() <= shortest(middle)) return add_undecided(piece);
  bound_slope(piece, box);
  if (jets_are_useless(piece.bound, piece.h(), std::max(std::abs(range.lo), std::abs(range.hi)))) {
    return divide(piece, middle);
  }
  evaluate_ends(piece);
  if (!settle_from_ends(piece)) divide(piece, place_to_divide(piece));
}

/// What the jets at both ends prove. True if the piece needs no more work.
bool Search::settle_from_ends(const Piece& piece) {
  const SlopeBound& bound = piece.bound;
  const double h = piece.h();
  const EndJet& a = piece.a.f;
  const EndJet& b = piece.b.f;
  const bool undecided_a = piece.a.t > t0_ && is_undecided(piece.a);
  const bool undecided_b = piece.b.t < t1_ && is_undecided(piece.b);
  const double sag = bound.second_order() ? bound.M * h * h / 8.0 : bound.slope.magnitude() * h;
  if (undecided_a && undecided_b && sag <= noise(piece)) {
    // All of F here is rounding; smaller pieces would tell no more.
    add_undecided(piece);
    return true;
  }
  const bool monotone = bound.second_order() ? is_monotone(a.slope, b.slope, h, bound.M)
                                             : bound.slope.lo > 0.0 || bound.slope.hi < 0.0;
  if (monotone) {
    // Near an end without a sign there is doubt still.
    if (undecided_a || undecided_b) return false;
    flush_undecided();
    if (is_inside(piece.a) != is_inside(piece.b)) add_hit(piece);
    return true;
  }
  if (is_inside(piece.a) != is_inside(piece.b)) return false;
  const double sign = is_inside(piece.a) ? 1.0 : -1.0;
  const EndJet ua{sign * a.value, sign * a.slope};
  const EndJet ub{sign * b.value, sign * b.slope};
  const Interval slope = sign > 0.0 ? bound.slope : -bound.slope;
  const double least =
      bound.second_order() ? least_value(ua, ub, h, bound.M) : least_value(ua, ub, h, slope);
  if (!(least > noise(piece))) return false;
  flush_undecided();
  return true;
}

/// Where the cubic through both jets has its minimum, as a distance from a; NaN if nowhere inside.
double cubic_minimum(const EndJet& a, const EndJet& b, double h) {
  // p'(x h) / 3 = c0 + c1 x + c2 x^2, from the Bernstein coefficients of p'.
  const double middle = 3.0 * (b.value - a.value) / h - (a.slope + b.slope);
  const double c0 = a.slope;
  const double c1 = 2.0 * (middle - a.slope);
  const double c2 = a.slope - 2.0 * middle + b.slope;
  const double discriminant = c1 * c1 - 4.0 * c0 * c2;
  if (!(discriminant >= 0.0)) return std::numeric_limits<double>::quiet_NaN();
  // The root where p' rises, in the form that does not cancel.
  const double s = std::sqrt(discriminant);
  const double x = c1 >= 0.0 ? -2.0 * c0 / (c1 + s) : (s - c1) / (2.0 * c2);
  return x > 0.0 && x < 1.0 ? x * h : std::numeric_limits<double>::quiet_NaN();
}

double Search::place_to_divide(const Piece& piece) const {
  const double h = piece.h();
  const SlopeBound& bound = piece.bound;
  // Next to a root the doubt is about that end alone.
  if (is_undecided(piece.a) != is_undecided(piece.b)) {
    return piece.a.t + (is_undecided(piece.b) ? 0.875 : 0.125) * h;
  }
  const double sign_a = is_inside(piece.a) ? 1.0 : -1.0;
  const double sign_b = is_inside(piece.b) ? 1.0 : -1.0;
  const EndJet ua{sign_a * piece.a.f.value, sign_a * piece.a.f.slope};
  const EndJet ub{sign_b * piece.b.f.value, sign_b * piece.b.f.slope};
  double lo = 0.0;
  double hi = h;
  // Leave out what each end alone excludes.
  if (bound.second_order()) {
    lo = certain_reach(ua, noise(piece.a), bound.M);
    hi = h - certain_reach({ub.value, -ub.slope}, noise(piece.b), bound.M);
  }
  double x = lo < hi ? 0.5 * (lo + hi) : 0.5 * h;
  if (sign_a == sign_b) {
    // A dip towards 0 is decided at its bottom.
    const double bottom = cubic_minimum(ua, ub, h);
    if (bottom > lo && bottom < hi) x = bottom;
  }
  if (!std::isfinite(x)) x = 0.5 * h;
  return piece.a.t + std::clamp(x, h / 8.0, 7.0 * h / 8.0);
}

void Search::divide(const Piece& piece, double t) {
  Node middle;
  middle.t = t;
  Piece first{piece.a, middle, piece.bound, false};
  stack_.push_back({middle, piece.b, piece.bound, false});
  if (piece.a.known && piece.b.known) evaluate_ends(first);
  stack_.push_back(first);
}

/// The argument at which the function with jets at x and y takes the value 0, by inverse cubic
/// interpolation; NaN where that has no meaning.
double inverse_cubic_root(const Node& x, const Node& y) {
  const double d = y.f.value - x.f.value;
  const double s = -x.f.value / d;  // where 0 lies between the values
  const double r = 1.0 - s;
  return r * r * (1.0 + 2.0 * s) * x.t + s * s * (1.0 + 2.0 * r) * y.t +
         s * r * d * (r / x.f.slope - s / y.f.slope);
}

RayHit Search::polish(Piece bracket) {
  const SlopeBound& bound = bracket.bound;
  RayHit hit{0.5 * (bracket.a.t + bracket.b.t), 0.5 * bracket.h(), RayStatus::hit,
             is_inside(bracket.b)};
  Node last = bracket.a;
  Node best = bracket.b;
  if (std::abs(last.f.value) < std::abs(best.f.value)) std::swap(last, best);
  const auto slope_floor = [&] {
    return bound.second_order()
               ? least_slope(bracket.a.f.slope, bracket.b.f.slope, bracket.h(), bound.M)
               : std::max(bound.slope.lo, -bound.slope.hi);
  };
  for (int step = 0; step < 200 && !spent(); ++step) {
    // How far the root can be from the best node: |t - t*| <= (|F| + noise) / least |F'|.
    const double goal = shortest(best.t);
    const double residual = std::abs(best.f.value) + noise(best);
    double sigma = slope_floor();
    double error = std::min(bracket.h(), residual / sigma);
    if (bound.second_order()) {
      sigma = std::max(sigma, std::abs(best.f.slope) - bound.M * error);
      error = std::min(error, residual / sigma);
    }
    if (error < hit.t_error) hit = {best.t, error, RayStatus::hit, hit.entering};
    // A Newton step without another evaluation is off by M error^2 / 2 |F'| at most.
    if (bound.second_order() && best.f.slope != 0.0) {
      const double after =
          (0.5 * bound.M * error * error + noise(best) + 1e-12 * residual) / std::abs(best.f.slope);
      if (after < hit.t_error) {
        const double t = best.t - best.f.value / best.f.slope;
        hit = {std::clamp(t, bracket.a.t, bracket.b.t), after, RayStatus::hit, hit.entering};
      }
    }
    if (hit.t_error <= goal || is_undecided(best) || bracket.h() <= goal) break;

    // The next place: inverse interpolation, else Newton, else the middle; and the middle in every
    // other step once convergence is slow, so that 200 steps are always enough.
    const auto strictly_inside = [&](double t) { return t > bracket.a.t && t < bracket.b.t; };
    Node next;
    next.t = inverse_cubic_root(last, best);
    if (!strictly_inside(next.t)) next.t = best.t - best.f.value / best.f.slope;
    if (!strictly_inside(next.t) || (step >= 6 && step % 2 == 0)) {
      next.t = 0.5 * (bracket.a.t + bracket.b.t);
    }
    if (!strictly_inside(next.t)) break;
    evaluate(next);
    (is_inside(next) == is_inside(bracket.a) ? bracket.a : bracket.b) = next;
    last = best;
    best = next;
    if (std::abs(last.f.value) < std::abs(best.f.value)) std::swap(last, best);
  }
  return hit;
}

void Search::add_hit(const Piece& bracket) {
  RayHit hit = polish(bracket);
  hit.t_error += position_error(hit.t);
  hits_->push_back(hit);
}

void Search::add_undecided(Piece piece) {
  if (undecided_ && undecided_->b.t == piece.a.t) {
    undecided_->b = piece.b;
  } else {
    flush_undecided();
    undecided_ = piece;
  }
}

/// Reports the undecided stretch so far: as a hit if F has opposite certain signs at its ends and
/// it is as short as the accuracy, else as uncertain.
void Search::flush_undecided() {
  if (!undecided_) return;
  Piece piece = *undecided_;
  undecided_.reset();
  evaluate(piece.a);
  evaluate(piece.b);
  const double t = 0.5 * (piece.a.t + piece.b.t);
  const bool crosses =
      is_inside(piece.a) != is_inside(piece.b) && !is_undecided(piece.a) && !is_undecided(piece.b);
  RayHit hit{t, 0.5 * piece.h() + position_error(t), RayStatus::uncertain, false};
  if (crosses && !spent()) {
    hit.status = RayStatus::hit;
    hit.entering = is_inside(piece.b);
  }
  hits_->push_back(hit);
}

/// Clips the range to the surface's bounds and sets accuracy and scale. False if nothing is left.
bool Search::prepare(double t0, double t1) {
  const Aabb bounds = surface_.bounds();
  if (bounds.empty()) return false;
  // The surface may touch its bounds: the ray must start and end clearly outside.
  const double margin = bounds.finite() ? 1e-6 * bounds.diagonal() : 0.0;
  const RayRange range = clip(ray_, bounds.grown(margin), {t0, t1});
  if (range.empty()) return false;
  t0_ = range.t0;
  t1_ = range.t1;
  const double length = bounds.finite() ? bounds.diagonal() : t1_ - t0_;
  accuracy_ = options_.accuracy > 0.0 ? options_.accuracy : 1e-10 * length;
  return true;
}

/// The ray as one piece, or the pieces that the tree leaves of it.
void Search::stack_pieces() {
  stack_.reserve(32);
  if (!tree_ || !tree_->serves(ray_, t1_)) {
    Piece whole;
    whole.a.t = t0_;
    whole.b.t = t1_;
    stack_.push_back(whole);
    return;
  }
  set_scale(-tree_->scale());
  std::vector<BoundTree::Stretch> stretches;
  tree_->walk(ray_, {t0_, t1_}, stretches);
  for (std::size_t i = stretches.size(); i-- > 0;) {
    const BoundTree::Stretch& stretch = stretches[i];
    Piece piece;
    piece.a.t = stretch.t0;
    piece.b.t = stretch.t1;
    if (std::isfinite(stretch.hessian)) {
      piece.bound.M = stretch.hessian;
      piece.bound.h = stretch.cell_edge;
      piece.enclosed = true;
    }
    stack_.push_back(piece);
  }
  tallest_ += stack_.size();
}

void Search::run(double t0, double t1, bool first_only, std::vector<RayHit>& hits) {
  hits_ = &hits;
  start_ = cost_.jets + cost_.bounds;
  if (!prepare(t0, t1)) return;
  if (!std::isfinite(t0_) || !std::isfinite(t1_)) {
    hits.push_back({std::isfinite(t0_) ? t0_ : 0.0, kInfinity, RayStatus::uncertain, false});
    return;
  }
  stack_pieces();
  while (!stack_.empty() && !(first_only && !hits.empty())) {
    const Piece next = stack_.back();
    stack_.pop_back();
    settle(next);
  }
  if (!(first_only && !hits.empty())) flush_undecided();
}

void check_arguments(const Ray& ray, double t0, double t1) {
  require(std::abs(squared_norm(ray.direction) - 1.0) < 1e-9, "a ray's direction has length 1");
  require(is_finite(ray.origin), "a ray's origin is finite");
  require(!std::isnan(t0) && !std::isnan(t1), "a ray's range is no NaN");
}

RayHit first(const ImplicitSurface& surface, const BoundTree* tree, const Ray& ray, double t0,
             double t1, const RaySolverOptions& options, RayCost* cost) {
  check_arguments(ray, t0, t1);
  RayCost own;
  std::vector<RayHit> hits;
  Search(surface, tree, ray, options, cost ? *cost : own).run(t0, t1, true, hits);
  return hits.empty() ? RayHit{t1, 0.0, RayStatus::miss, false} : hits.front();
}

void all(const ImplicitSurface& surface, const BoundTree* tree, const Ray& ray, double t0,
         double t1, const RaySolverOptions& options, std::vector<RayHit>& hits, RayCost* cost) {
  check_arguments(ray, t0, t1);
  RayCost own;
  hits.clear();
  Search(surface, tree, ray, options, cost ? *cost : own).run(t0, t1, false, hits);
}

}  // namespace

RayHit first_hit(const ImplicitSurface& surface, const Ray& ray, double t0, double t1,
                 const RaySolverOptions& options, RayCost* cost) {
  return first(surface, nullptr, ray, t0, t1, options, cost);
}
RayHit first_hit(const BoundTree& tree, const Ray& ray, double t0, double t1,
                 const RaySolverOptions& options, RayCost* cost) {
  return first(tree.surface(), &tree, ray, t0, t1, options, cost);
}

void all_hits(const ImplicitSurface& surface, const Ray& ray, double t0, double t1,
              const RaySolverOptions& options, std::vector<RayHit>& hits, RayCost* cost) {
  all(surface, nullptr, ray, t0, t1, options, hits, cost);
}
void all_hits(const BoundTree& tree, const Ray& ray, double t0, double t1,
              const RaySolverOptions& options, std::vector<RayHit>& hits, RayCost* cost) {
  all(tree.surface(), &tree, ray, t0, t1, options, hits, cost);
}

}  // namespace cs2mesh
