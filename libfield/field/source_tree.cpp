#include "libfield/field/source_tree.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "libfield/field/far_chords.h"
#include "libfield/integral/bulk.h"
#include "libfield/primitive/nearest_point.h"

namespace cs2mesh {
namespace {

/// A node this large has about as many elements as a series has time to gather: moments of its
/// halves would be twice the memory and the time to set up, and no evaluation would be faster.
constexpr std::uint32_t kFewestMoments = 128;
/// A triangle has as many nodes as so many of those elements.
constexpr std::uint32_t kTriangleNodes = 8;
/// Of triangles, longest edge over smallest height.
constexpr double kMostSlender = 1e4;
/// Elements that are sorted together.
constexpr std::uint32_t kLeafSize = 16;
/// The halves of larger nodes are measured side by side.
constexpr std::uint32_t kParallelSize = 2048;
/// Eight chords integrate all powers that count over a triangle exactly.
constexpr std::size_t kExactChords = 6;
static_assert(2 * kChordCounts[kExactChords] > kTaylorOrder);

/// The weight and tau of a unit of length, or of a point; within the distance `clamp` it is
/// another.
struct FarLaw {
  double two_nu, weight, tau, clamp;
};

std::optional<FarLaw> law_of(const Kernel& kernel) {
  if (const auto* cauchy = std::get_if<Cauchy>(&kernel)) {
    const double tau = 1 / (cauchy->s * cauchy->s);
    return FarLaw{4.0, cauchy->amplitude * tau * tau, tau, 0.0};
  }
  if (const auto* inverse = std::get_if<Inverse>(&kernel))
    return FarLaw{1.0, inverse->amplitude, 0, inverse->clamp};
  if (const auto* squared = std::get_if<Squared>(&kernel))
    return FarLaw{2.0, squared->amplitude, 0, squared->clamp};
  return std::nullopt;
}

/// Whether moments of the halves of a node are worth their memory.
bool has_many(const SourceNode& node) {
  return node.right != 0 && node.count + (kTriangleNodes - 1) * node.triangles > kFewestMoments;
}

/// The vertices so that the shortest edge comes first.
void place(const Triangle& triangle, FarElement& element) {
  const auto& v = triangle.vertex;
  const auto edge2 = [&](std::size_t i) { return squared_norm(v[(i + 1) % 3] - v[i]); };
  const std::array<double, 3> squared = {edge2(0), edge2(1), edge2(2)};
  const auto shortest = std::min_element(squared.begin(), squared.end()) - squared.begin();
  const auto i = static_cast<std::size_t>(shortest);
  element.a = v[i], element.b = v[(i + 1) % 3], element.apex = v[(i + 2) % 3];
  element.length = std::sqrt(*std::max_element(squared.begin(), squared.end()));
}

}  // namespace

std::optional<double> far_exponent(const Kernel& kernel) {
  const std::optional<FarLaw> law = law_of(kernel);
  if (!law) return std::nullopt;
  return law->two_nu;
}

std::optional<FarElement> far_element(const Term& term, std::uint32_t index) {
  const std::optional<FarLaw> law = law_of(term.kernel);
  if (!law || term.to_local || !term.profiles.empty()) return std::nullopt;
  FarElement element;
  if (const auto* point = std::get_if<Point>(&term.primitive)) {
    element.a = element.b = point->position;
  } else if (const auto* segment = std::get_if<Segment>(&term.primitive)) {
    element.a = segment->a, element.b = segment->b;
    element.length = std::get<SegmentFrame<double>>(term.frame).length;
    // Nodes stand for a segment from about its length on.
    if (!(element.length > 2 * law->clamp)) return std::nullopt;
  } else if (const auto* triangle = std::get_if<Triangle>(&term.primitive)) {
    const auto& frame = *std::get<std::shared_ptr<const TriangleFrame<double>>>(term.frame);
    place(*triangle, element);
    element.area = 0.5 * frame.edge[0].length * frame.height;
    // So that rounding of the area is far below any budget.
    if (!(element.length > 2 * law->clamp && element.length < kMostSlender * frame.height)) {
      return std::nullopt;
    }
  } else {
    return std::nullopt;
  }
  element.weight = term.sign * law->weight;
  element.tau = law->tau;
  element.term = index;
  // Products of powers of these stay finite.
  const auto moderate = [](double x) { return x < 1e30 && x > 1e-30; };
  const double reach = std::max({norm(element.a), norm(element.b), norm(element.apex), 1e-20});
  if (!moderate(element.mass()) || !moderate(reach) || !(law->tau < 1e30)) return std::nullopt;
  return element;
}

double squared_distance(const FarElement& element, const Vec3d& p) {
  if (element.is_triangle()) {
    return squared_norm(p - nearest_point(Triangle{{element.a, element.b, element.apex}}, p));
  }
  const Vec3d from_a = p - element.a;
  if (!(element.length > 0)) return squared_norm(from_a);
  const Vec3d axis = element.b - element.a;
  const double along = std::clamp(dot(from_a, axis) / squared_norm(axis), 0.0, 1.0);
  return squared_norm(from_a - along * axis);
}

SourceTree::SourceTree(std::vector<FarElement> elements) : elements_(std::move(elements)) {
  if (elements_.empty()) return;
  nodes_.reserve(elements_.size() / 4 + 4);
  build(0, static_cast<std::uint32_t>(elements_.size()));
  shapes_.reserve(elements_.size());
  for (const FarElement& element : elements_) shapes_.push_back(element.shape());
  first_moments_.resize(nodes_.size(), kNoMoments);
  const std::size_t sets = number_moments(0, 0);
  // Written once, by measure(): there may be a hundred megabytes.
  moments_ = std::make_unique_for_overwrite<Series[]>(sets);
  measure(0);
}

/// Returns the number of moments up to those of this node and of all below it.
std::size_t SourceTree::number_moments(std::uint32_t index, std::size_t first) {
  const SourceNode& node = nodes_[index];
  first_moments_[index] = first;
  first += node.tau_spread > 0 ? kTauOrders : 1;
  if (!has_many(node)) return first;
  return number_moments(node.right, number_moments(index + 1, first));
}

std::uint32_t SourceTree::build(std::uint32_t first, std::uint32_t count) {
  const auto self = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  SourceNode node;
  node.first = first, node.count = count;
  node.least_tau = std::numeric_limits<double>::infinity();
  Aabb middles;
  double largest_tau = 0.0;
  for (std::uint32_t i = first; i < first + count; ++i) {
    const FarElement& element = elements_[i];
    node.box.include(element.box());
    middles.include(element.middle());
    node.mass += element.mass();
    node.heaviest = std::max(node.heaviest, element.mass());
    node.longest = std::max(node.longest, element.length);
    if (element.weight < 0) node.negative_mass += element.mass();
    node.triangles += element.is_triangle() ? 1 : 0;
    node.least_tau = std::min(node.least_tau, element.tau);
    largest_tau = std::max(largest_tau, element.tau);
  }
  node.tau_spread = 0.5 * (largest_tau - node.least_tau);
  node.tau = node.least_tau + node.tau_spread;
  node.center = node.box.center();
  node.radius = std::max(0.5 * node.box.diagonal() * (1 + 1e-15), 1e-100);
  if (count > kLeafSize) {
    const std::size_t axis = longest_axis(middles.extent());
    const std::uint32_t half = count / 2;
    const auto begin = elements_.begin() + first;
    std::nth_element(begin, begin + half, begin + count,
                     [&](const FarElement& a, const FarElement& b) {
                       const double ka = a.middle()[axis], kb = b.middle()[axis];
                       return ka != kb ? ka < kb : a.term < b.term;
                     });
    build(first, half);
    node.right = build(first + half, count - half);
  }
  nodes_[self] = node;
  return self;
}

void SourceTree::measure(std::uint32_t index) {
  const SourceNode& node = nodes_[index];
  const std::span<Series> moments(moments_.get() + first_moments_[index],
                                  node.tau_spread > 0 ? kTauOrders : 1);
  for (Series& series : moments) series.fill(0.0);
  if (!has_many(node)) {
    measure_leaf(node, moments);
  } else {
    if (node.count > kParallelSize) {
      tbb::parallel_invoke([&] { measure(index + 1); }, [&] { measure(node.right); });
    } else {
      measure(index + 1);
      measure(node.right);
    }
    take_over(node, index + 1, moments);
    take_over(node, node.right, moments);
  }
}

void SourceTree::measure_leaf(const SourceNode& node, std::span<Series> moments) const {
  const double inverse = 1 / node.radius;
  const double per_spread = node.tau_spread > 0 ? 1 / node.tau_spread : 0.0;
  std::vector<MomentSource> points, segments;
  for (const FarElement& element : std::span(elements_).subspan(node.first, node.count)) {
    const double t = (element.tau - node.tau) * per_spread;
    const auto add = [&](const Vec3d& a, const Vec3d& b, double weight) {
      (element.length > 0 ? segments : points)
          .push_back({inverse * (a - node.center), inverse * (b - node.center), weight, t});
    };
    if (!element.is_triangle()) {
      add(element.a, element.b, element.weight * element.measure());
      continue;
    }
    for (const Chord& chord : chord_rule(kExactChords)) {
      const SegmentSource source = chord_source(element, chord);
      add(source.middle - source.half, source.middle + source.half, source.weight);
    }
  }
  const AddMoments add = bulk_table().add_moments;
  if (!points.empty()) add(points.data(), points.size(), false, moments.size(), moments.data());
  if (!segments.empty()) {
    add(segments.data(), segments.size(), true, moments.size(), moments.data());
  }
}

/// Adds the moments of a child about the centre and the tau of its parent.
void SourceTree::take_over(const SourceNode& node, std::uint32_t child,
                           std::span<Series> moments) const {
  const SourceNode& part = nodes_[child];
  // t = scale t' + move.
  const double unit = node.tau_spread > 0 ? 1 / node.tau_spread : 0.0;
  const double scale = part.tau_spread * unit, move = (part.tau - node.tau) * unit;
  const std::array<std::array<double, kTauOrders>, kTauOrders> by = {
      {{1, 0, 0}, {move, scale, 0}, {move * move, 2 * move * scale, scale * scale}}};
  const std::size_t sets = part.tau_spread > 0 ? kTauOrders : 1;
  const Vec3d offset = (part.center - node.center) / node.radius;
  for (std::size_t i = 0; i < sets; ++i) {
    const Series moved =
        moved_moments(moments_[first_moments_[child] + i], offset, part.radius / node.radius);
    for (std::size_t j = i; j < moments.size(); ++j) {
      for (std::size_t k = 0; k < kSeriesSize; ++k) moments[j][k] += by[j][i] * moved[k];
    }
  }
}

}  // namespace cs2mesh
