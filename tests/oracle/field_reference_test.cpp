// Every kernel over every primitive against references of 25 digits: value and gradient must be
// exact for inputs moved by a few units in their last place (backward error).

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "libfield/integral/integral.h"
#include "libfield/kernel/kernel.h"
#include "libfield/primitive/primitive.h"
#include "tests/oracle/reference.h"
#include "tests/unit/simd/every_isa.h"

namespace cs2mesh {
namespace {

constexpr double kLimit = 64.0;
// Cones make the gradient of a metaball jump in slope at R / 3.
constexpr double kMetaballGradientLimit = 256.0;

struct Row {
  std::string id, tag, kernel, primitive;
  double parameter = 0.0;
  std::array<double, 12> g{};
  Vec3d point;
  reference::Exact exact;

  Vec3d vector(std::size_t i) const { return {g[i], g[i + 1], g[i + 2]}; }
};

double number(const std::string& text) {
  return std::strtod(text.c_str(), nullptr);
}

Row parse(const std::vector<std::string>& cell) {
  Row row;
  row.id = cell[0];
  row.kernel = name_of(*kernel_of(cell[1]));
  row.primitive = cell[2];
  row.parameter = number(cell[3]);
  for (std::size_t i = 0; i < 12; ++i) row.g[i] = number(cell[4 + i]);
  row.point = {number(cell[16]), number(cell[17]), number(cell[18])};
  row.exact.value = std::strtold(cell[19].c_str(), nullptr);
  for (std::size_t i = 0; i < 3; ++i) {
    row.exact.gradient[i] = std::strtold(cell[20 + i].c_str(), nullptr);
  }
  row.exact.hessian_norm = number(cell[23]);
  row.exact.scale = number(cell[24]);
  row.tag = cell[25];
  return row;
}

/// Longest edge over smallest height.
double slenderness(const Triangle& triangle) {
  double longest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    longest = std::max(longest, norm(triangle.vertex[(i + 1) % 3] - triangle.vertex[i]));
  }
  const double doubled_area =
      norm(cross(triangle.vertex[1] - triangle.vertex[0], triangle.vertex[2] - triangle.vertex[0]));
  return longest * longest / doubled_area;
}

Primitive primitive_of(const Row& row) {
  if (row.primitive == "point") return Point{row.vector(0)};
  if (row.primitive == "line") return Segment{row.vector(0), row.vector(3)};
  if (row.primitive == "triangle") return Triangle{{row.vector(0), row.vector(3), row.vector(6)}};
  if (row.primitive == "plane") return Plane{row.vector(0), normalized(row.vector(3))};
  return make_arc(row.vector(0), row.g[3], row.vector(4), row.vector(7), row.g[10], row.g[11]);
}

Kernel kernel_of(const Row& row) {
  switch (*cs2mesh::kernel_of(row.kernel)) {
    case KernelKind::cauchy:
      return Cauchy{row.parameter};
    case KernelKind::gaussian:
      return Gaussian{row.parameter};
    case KernelKind::inverse:
      return Inverse{};
    case KernelKind::squared:
      return Squared{};
    case KernelKind::metaball:
      return Metaball{row.parameter};
    case KernelKind::soft:
      return Soft{row.parameter};
    case KernelKind::quartic:
      break;
  }
  return Quartic{row.parameter};
}

/// The field of one primitive alone; not a number where it is infinite, of which there is no row.
template <class K, class P>
Jet evaluate(const K& kernel, const P& primitive, const Vec3d& point) {
  if constexpr (!kHasField<K, P>) {
    return {std::numeric_limits<double>::quiet_NaN(), {}};
  } else {
    return integral(kernel, primitive, point);
  }
}

struct Worst {
  double error = -1.0;
  std::string id, tag;
  void include(double candidate, const Row& row) {
    if (candidate > error) error = candidate, id = row.id, tag = row.tag;
  }
};

struct Cell {
  int rows = 0;
  Worst value, gradient;
};

/// evaluate_row(kernel, primitive, point) against every row.
template <class Evaluate>
void expect_exact_rows(const Evaluate& evaluate_row) {
  const std::string path = reference::shared_folder() + "/reference/field_public.csv";
  const auto table = reference::read_csv(path);
  ASSERT_FALSE(table.empty()) << "no references in " << path;
  std::map<std::pair<std::string, std::string>, Cell> cells;
  for (const auto& line : table) {
    Row row = parse(line);
    const Primitive primitive = primitive_of(row);
    if (const auto* triangle = std::get_if<Triangle>(&primitive)) {
      row.exact.condition = slenderness(*triangle);
    }
    const Jet jet = evaluate_row(kernel_of(row), primitive, row.point);
    const reference::BackwardError error = reference::backward_error(jet, row.exact);
    Cell& cell = cells[{row.kernel, row.primitive}];
    ++cell.rows;
    cell.value.include(error.value, row);
    cell.gradient.include(error.gradient, row);
    EXPECT_LE(error.value, kLimit) << "value of row " << row.id << ": " << row.kernel << " x "
                                   << row.primitive << ", " << row.tag;
    EXPECT_LE(error.gradient, row.kernel == "metaball" ? kMetaballGradientLimit : kLimit)
        << "gradient of row " << row.id << ": " << row.kernel << " x " << row.primitive << ", "
        << row.tag;
  }
  std::printf("%-9s %-9s %4s  %s\n", "kernel", "primitive", "rows",
              "worst value and gradient in ulp (row, tag)");
  for (const auto& [name, cell] : cells) {
    std::printf("%-9s %-9s %4d  %8.2f (%s, %s)  %8.2f (%s, %s)\n", name.first.c_str(),
                name.second.c_str(), cell.rows, cell.value.error, cell.value.id.c_str(),
                cell.value.tag.c_str(), cell.gradient.error, cell.gradient.id.c_str(),
                cell.gradient.tag.c_str());
  }
}

TEST(FieldReference, EveryRowIsExactForInputsMovedByAFewUlp) {
  expect_exact_rows([](const Kernel& kernel, const Primitive& primitive, const Vec3d& point) {
    return std::visit([&](const auto& k, const auto& p) { return evaluate(k, p, point); }, kernel,
                      primitive);
  });
}

TEST(FieldReference, EveryRowIsExactAsATermWithEveryInstructionSet) {
  testing::with_every_isa([](Isa isa) {
    std::printf("%s\n", std::string(name_of(isa)).c_str());
    expect_exact_rows([](const Kernel& kernel, const Primitive& primitive, const Vec3d& point) {
      return testing::accumulated(testing::plain_term(kernel, primitive), point);
    });
  });
}

}  // namespace
}  // namespace cs2mesh
