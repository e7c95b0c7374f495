// PLY, the Stanford polygon format.
#pragma once

#include <string>
#include <string_view>

#include "libfield/base/result.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

struct PlyOptions {
  bool normals = true;  ///< float nx ny nz, where all parts have normals
  bool colors = true;   ///< uchar sRGB red green blue, where all parts have colours
};

/// Writes binary little-endian PLY with double coordinates, all parts in one list of vertices and
/// one of faces; a header line `comment part NAME FIRST_FACE COUNT` for each part lets read_ply
/// restore them. Deterministic. Errors: as AtomicFile::commit.
Result<Done> write_ply(const Model& model, const std::string& path, const PlyOptions& options = {});

/// Reads ASCII and binary PLY of either byte order with any scalar types: vertices with x y z and
/// perhaps nx ny nz and sRGB red green blue; faces as a list vertex_indices or vertex_index,
/// polygons becoming fans. Other elements and properties are skipped. Errors are located at the
/// line in `file` for the header and for ASCII. Never fails but by a Result, whatever the bytes;
/// memory O(bytes).
Result<Model> read_ply(std::string_view bytes, const std::string& file);

}  // namespace cs2mesh
