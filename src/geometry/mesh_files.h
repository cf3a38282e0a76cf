// Outlines from files: chains of points, and triangles in STL.

#ifndef DEFORMABLE_MESH_FILES_H
#define DEFORMABLE_MESH_FILES_H

#include "laws/vector3.h"

#include <string>
#include <vector>

namespace deformable {

// Functions return what is wrong with a file, or nothing.

// A chain of points, as rows of x and y: divided by blanks, tabs, commas or semicolons; a # begins a comment, and a row of words may
// come first.
std::string read_chain(const std::string &text, std::vector<Vector3> &points);
// Three corners of each triangle of STL, as text or binary. Its normals are not needed.
std::string read_stl(const std::string &bytes, std::vector<Vector3> &corners);

// Two corners of each segment of a chain. It is closed if it ends where it begins; a container is closed in any case.
std::vector<Vector3> segments_of(std::vector<Vector3> points, bool is_container);

}    // namespace deformable

#endif
