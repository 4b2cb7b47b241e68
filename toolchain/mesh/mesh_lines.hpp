// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

// Checks of mesh files in text form. Assimp is lenient: it drops lines that it does not understand, so that later
// indices name other vertices, and takes a number by its first characters. A map of such a mesh would be wrong.

namespace jink::mesh {

/// Checks every line of an OBJ file. `v` takes three finite numbers, with a fourth for the weight or three for a
/// colour; `f` takes three or more corners, each of which names a vertex of the file. Keywords that say nothing of the
/// surface's shape are accepted: vn, vt, vp, g, o, s, usemtl, mtllib, l, p and #. Their lines are not checked further.
/// Blanks before a keyword, lines continued by a backslash and control characters are refused.
/// @throws CannotBuild with line and column of the first error
void check_obj(std::string_view text);

/// Checks every line of an STL file in ASCII: solids of facets of three vertices, one keyword to a line.
/// @throws CannotBuild with line and column of the first error
void check_ascii_stl(std::string_view text);

/// True for the binary form: a header of 84 bytes, which names the number of facets, and 50 bytes for each.
[[nodiscard]] bool is_binary_stl(std::string_view bytes);

}  // namespace jink::mesh
