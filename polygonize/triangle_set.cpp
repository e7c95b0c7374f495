#include "polygonize/triangle_set.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>

namespace cs2mesh {
namespace {

/// A bijection of the numbers that leaves no bit as it was (the finaliser of SplitMix64).
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31);
}

std::uint64_t place_key(const Vec3d& p) {
  std::uint64_t key = 0;
  for (const double x : {p.x, p.y, p.z}) key = mixed(key + std::bit_cast<std::uint64_t>(x));
  return key;
}

std::vector<std::uint64_t> keys_of(const TriangleMesh& mesh) {
  std::vector<std::uint64_t> keys(mesh.triangles.size());
  tbb::parallel_for(std::size_t{0}, keys.size(),
                    [&](std::size_t t) { keys[t] = triangle_key(mesh, t); });
  return keys;
}

}  // namespace

std::uint64_t triangle_key(const TriangleMesh& mesh, std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  const std::uint64_t ka = place_key(mesh.positions[a]), kb = place_key(mesh.positions[b]),
                      kc = place_key(mesh.positions[c]);
  // The corner of the least key first.
  const auto in_turn = [](std::uint64_t x, std::uint64_t y, std::uint64_t z) {
    return mixed(mixed(mixed(x) + y) + z);
  };
  if (ka <= kb && ka <= kc) return in_turn(ka, kb, kc);
  return kb <= kc ? in_turn(kb, kc, ka) : in_turn(kc, ka, kb);
}

TriangleSet::TriangleSet(const TriangleMesh& mesh) : keys_(keys_of(mesh)) {
  tbb::parallel_sort(keys_.begin(), keys_.end());
}

bool TriangleSet::contains(std::uint64_t key) const {
  return std::binary_search(keys_.begin(), keys_.end(), key);
}

std::vector<std::uint32_t> TriangleSet::others(const TriangleMesh& mesh) const {
  std::vector<char> other(mesh.triangles.size());
  tbb::parallel_for(std::size_t{0}, other.size(), [&](std::size_t t) {
    other[t] = contains(triangle_key(mesh, t)) ? 0 : 1;
  });
  std::vector<std::uint32_t> found;
  for (std::size_t t = 0; t < other.size(); ++t) {
    if (other[t] != 0) found.push_back(static_cast<std::uint32_t>(t));
  }
  return found;
}

void TriangleSet::add(std::vector<std::uint64_t> keys) {
  std::sort(keys.begin(), keys.end());
  const auto old = static_cast<std::ptrdiff_t>(keys_.size());
  keys_.insert(keys_.end(), keys.begin(), keys.end());
  std::inplace_merge(keys_.begin(), keys_.begin() + old, keys_.end());
  keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
}

void TriangleSet::remove(std::vector<std::uint64_t> keys) {
  std::sort(keys.begin(), keys.end());
  std::erase_if(keys_, [next = keys.begin(), end = keys.end()](std::uint64_t key) mutable {
    while (next != end && *next < key) ++next;
    return next != end && *next == key;
  });
}

}  // namespace cs2mesh
