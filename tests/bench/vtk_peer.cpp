#include "tests/bench/vtk_peer.h"

#include <vtkCellArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

#include <algorithm>

#include "tests/bench/sample_grid.h"

namespace cs2mesh::bench {
namespace {

/// The block's part of the image; x is fastest there.
void copy_block(const SampleBlock& block, const std::array<int, 3>& nodes, float* image) {
  const float sign = block.inside ? 1.0F : -1.0F;
  for (int i = 0; i < kBlockNodes; ++i) {
    const auto x = static_cast<std::size_t>(block.first[0] + i / (kBlock * kBlock));
    const auto y = static_cast<std::size_t>(block.first[1] + i / kBlock % kBlock);
    const auto z = static_cast<std::size_t>(block.first[2] + i % kBlock);
    const std::size_t at =
        x + static_cast<std::size_t>(nodes[0]) * (y + static_cast<std::size_t>(nodes[1]) * z);
    image[at] = block.empty ? sign : block.values[static_cast<std::size_t>(i)];
  }
}

}  // namespace

TriangleMesh vtk_flying_edges_mesh(const ImplicitSurface& surface, double cell) {
  vtkNew<vtkImageData> image;
  Vec3d origin;
  {
    const SampleGrid samples = sample_grid(surface, cell, true);
    const std::array<int, 3> nodes{kBlock * samples.blocks[0], kBlock * samples.blocks[1],
                                   kBlock * samples.blocks[2]};
    origin = samples.origin;
    image->SetDimensions(nodes[0], nodes[1], nodes[2]);
    image->AllocateScalars(VTK_FLOAT, 1);
    auto* const scalars = static_cast<float*>(image->GetScalarPointer());
    for (const SampleBlock& block : samples.all) copy_block(block, nodes, scalars);
  }
  vtkNew<vtkFlyingEdges3D> edges;
  edges->SetInputData(image);
  edges->SetValue(0, 0.0);
  edges->ComputeNormalsOff();
  edges->ComputeGradientsOff();
  edges->ComputeScalarsOff();
  edges->Update();
  vtkPolyData* const made = edges->GetOutput();
  TriangleMesh mesh;
  for (vtkIdType i = 0; i < made->GetNumberOfPoints(); ++i) {
    double p[3];
    made->GetPoint(i, p);
    mesh.positions.push_back(origin + cell * Vec3d{p[0], p[1], p[2]});
  }
  vtkCellArray* const polygons = made->GetPolys();
  vtkIdType size = 0;
  const vtkIdType* corners = nullptr;
  for (polygons->InitTraversal(); polygons->GetNextCell(size, corners) != 0;) {
    std::array<TriangleMesh::Index, 3> triangle{};
    std::copy_n(corners, 3, triangle.begin());
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

}  // namespace cs2mesh::bench
