#include "libfield/base/principal_axes.h"

#include <gtest/gtest.h>

#include "libfield/base/random.h"

namespace cs2mesh {
namespace {

TEST(PrincipalAxes, MakeTheMatrixAgain) {
  Random random(5);
  for (int i = 0; i < 500; ++i) {
    const auto entry = [&] { return random.uniform(-1, 1) * std::pow(10, random.uniform(-6, 6)); };
    const Symmetric3 m{entry(), entry(), entry(), entry(), entry(), entry()};
    const PrincipalAxes axes = principal_axes(m);
    Symmetric3 again;
    for (std::size_t k = 0; k < 3; ++k) {
      again += axes.value[k] * squared(axes.axis.row[k]);
      for (std::size_t l = 0; l < 3; ++l) {
        EXPECT_NEAR(dot(axes.axis.row[k], axes.axis.row[l]), k == l ? 1 : 0, 1e-14);
      }
    }
    EXPECT_LE(norm(again - m), 1e-14 * norm(m));
  }
}

TEST(PrincipalAxes, OfDiagonalMatricesAreThoseOfSpace) {
  const PrincipalAxes axes = principal_axes({3, 0, -2, 0, 0, 0});
  EXPECT_EQ(axes.axis, Mat3{});
  EXPECT_EQ(axes.value, (Vec3d{3, 0, -2}));
}

}  // namespace
}  // namespace cs2mesh
