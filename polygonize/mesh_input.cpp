#include "polygonize/mesh_input.h"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numeric>
#include <system_error>
#include <utility>

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;
constexpr Index kNone = std::numeric_limits<Index>::max();

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

std::size_t root_of(std::vector<std::size_t>& parent, std::size_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/// For each part the first part of the surface it belongs to.
std::vector<std::size_t> join_parts_that_touch(const SharedVertexMesh& input) {
  std::vector<std::size_t> parent(input.names.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  std::vector<std::uint32_t> owner(input.mesh.positions.size(), kNone);
  for (std::size_t t = 0; t < input.mesh.triangles.size(); ++t) {
    const std::uint32_t part = input.part_of[t];
    for (const Index vertex : input.mesh.triangles[t]) {
      if (owner[vertex] == kNone) owner[vertex] = part;
      const std::size_t a = root_of(parent, owner[vertex]);
      const std::size_t b = root_of(parent, part);
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
  for (std::size_t i = 0; i < parent.size(); ++i) parent[i] = root_of(parent, i);
  return parent;
}

TriangleMesh extract(const TriangleMesh& mesh, const std::vector<std::size_t>& triangles,
                     std::vector<Index>& new_index) {
  std::vector<Index> used;
  used.reserve(3 * triangles.size());
  for (const std::size_t t : triangles) {
    used.insert(used.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
  }
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());

  TriangleMesh part;
  for (const Index vertex : used) {
    new_index[vertex] = static_cast<Index>(part.positions.size());
    part.positions.push_back(mesh.positions[vertex]);
    if (!mesh.normals.empty()) part.normals.push_back(mesh.normals[vertex]);
    if (!mesh.colors.empty()) part.colors.push_back(mesh.colors[vertex]);
  }
  part.triangles.reserve(triangles.size());
  for (const std::size_t t : triangles) {
    const auto& [a, b, c] = mesh.triangles[t];
    part.triangles.push_back({new_index[a], new_index[b], new_index[c]});
  }
  return part;
}

template <class T>
void keep_if_consistent(std::vector<T>& attribute, const std::vector<Index>& to,
                        std::size_t count) {
  if (attribute.empty()) return;
  std::vector<T> merged(count);
  std::vector<bool> seen(count, false);
  for (std::size_t i = 0; i < to.size(); ++i) {
    if (seen[to[i]] && !(merged[to[i]] == attribute[i])) {
      attribute.clear();
      return;
    }
    seen[to[i]] = true;
    merged[to[i]] = attribute[i];
  }
  attribute = std::move(merged);
}

}  // namespace

Result<std::string> read_file_bytes(const std::string& path) {
  const auto error = [&](int number) {
    return error_at({path},
                    "cannot read: " + (number == ENOENT ? std::string("no such file")
                                                        : std::generic_category().message(number)));
  };
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return error(errno);
  if (S_ISDIR(status.st_mode)) return error(EISDIR);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             &std::fclose);
  if (!file) return error(errno);
  std::string bytes;
  if (S_ISREG(status.st_mode)) bytes.reserve(static_cast<std::size_t>(status.st_size));
  std::vector<char> block(std::size_t{1} << 18);
  while (const std::size_t count = std::fread(block.data(), 1, block.size(), file.get())) {
    bytes.append(block.data(), count);
  }
  if (std::ferror(file.get())) return error(errno);
  return bytes;
}

bool TextCursor::next_line() {
  if (rest_.empty()) {
    current_ = {};
    return false;
  }
  const std::size_t end = rest_.find_first_of("\r\n");
  current_ = rest_.substr(0, end);
  if (end == std::string_view::npos) {
    rest_ = {};
  } else {
    const bool pair = rest_[end] == '\r' && end + 1 < rest_.size() && rest_[end + 1] == '\n';
    rest_.remove_prefix(end + (pair ? 2 : 1));
  }
  ++line_;
  return true;
}

std::string_view TextCursor::word() {
  std::size_t begin = 0;
  while (begin < current_.size() && is_blank(current_[begin])) ++begin;
  std::size_t end = begin;
  while (end < current_.size() && !is_blank(current_[end])) ++end;
  const std::string_view word = current_.substr(begin, end - begin);
  current_.remove_prefix(end);
  return word;
}

std::string_view TextCursor::rest_of_line() {
  while (!current_.empty() && is_blank(current_.front())) current_.remove_prefix(1);
  while (!current_.empty() && is_blank(current_.back())) current_.remove_suffix(1);
  return std::exchange(current_, {});
}

std::string_view TextCursor::word_of_any_line() {
  while (true) {
    const std::string_view found = word();
    if (!found.empty() || !next_line()) return found;
  }
}

std::optional<double> read_decimal(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  double value = 0;
  const char* end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (stop != end) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    // from_chars leaves the value alone, and does not say which end of the range was left.
    const std::size_t exponent = word.find_first_of("eE");
    const bool small = exponent != std::string_view::npos && exponent + 1 < word.size() &&
                       word[exponent + 1] == '-';
    return small ? std::optional<double>(0.0) : std::nullopt;
  }
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<std::int64_t> parse_integer(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  std::int64_t value = 0;
  const char* end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (stop != end || error != std::errc()) return std::nullopt;
  return value;
}

Model split_into_parts(SharedVertexMesh input, const std::string& fallback_name) {
  if (input.part_of.empty()) input.part_of.assign(input.mesh.triangles.size(), 0);
  const std::vector<std::size_t> surface_of = join_parts_that_touch(input);
  std::vector<std::vector<std::size_t>> triangles(input.names.size());
  for (std::size_t t = 0; t < input.mesh.triangles.size(); ++t) {
    triangles[surface_of[input.part_of[t]]].push_back(t);
  }

  Model model;
  const auto add = [&](std::size_t part, TriangleMesh mesh) {
    const std::string& name = input.names[part];
    model.parts.push_back({name.empty() ? fallback_name : name, std::move(mesh)});
  };
  const auto has_triangles = [](const auto& list) { return !list.empty(); };
  if (std::count_if(triangles.begin(), triangles.end(), has_triangles) <= 1) {
    const auto only = std::find_if(triangles.begin(), triangles.end(), has_triangles);
    if (only == triangles.end() && input.mesh.positions.empty()) return model;
    add(only == triangles.end() ? 0 : static_cast<std::size_t>(only - triangles.begin()),
        std::move(input.mesh));
    return model;
  }
  std::vector<Index> new_index(input.mesh.positions.size());
  for (std::size_t part = 0; part < triangles.size(); ++part) {
    if (!triangles[part].empty()) add(part, extract(input.mesh, triangles[part], new_index));
  }
  return model;
}

void merge_equal_vertices(TriangleMesh& mesh) {
  const std::vector<Vec3d>& p = mesh.positions;
  std::vector<Index> order(p.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(), [&](Index a, Index b) {
    if (p[a].x != p[b].x) return p[a].x < p[b].x;
    if (p[a].y != p[b].y) return p[a].y < p[b].y;
    if (p[a].z != p[b].z) return p[a].z < p[b].z;
    return a < b;
  });
  std::vector<Index> first(p.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && p[order[i]] == p[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }

  std::vector<Index> to(p.size());
  std::vector<Vec3d> kept;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (first[i] == i) {
      to[i] = static_cast<Index>(kept.size());
      kept.push_back(p[i]);
    } else {
      to[i] = to[first[i]];
    }
  }
  if (kept.size() == p.size()) return;
  keep_if_consistent(mesh.normals, to, kept.size());
  keep_if_consistent(mesh.colors, to, kept.size());
  mesh.positions = std::move(kept);
  for (auto& triangle : mesh.triangles) {
    for (Index& vertex : triangle) vertex = to[vertex];
  }
}

void append_fan(TriangleMesh& mesh, const std::vector<TriangleMesh::Index>& corners) {
  for (std::size_t i = 2; i < corners.size(); ++i) {
    mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
  }
}

std::string stem_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  std::string name = slash == std::string::npos ? path : path.substr(slash + 1);
  const std::size_t dot = name.rfind('.');
  if (dot != std::string::npos && dot > 0) name.resize(dot);
  return name.empty() ? "mesh" : name;
}

}  // namespace cs2mesh
