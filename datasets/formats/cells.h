// The cells of finite-element meshes (Medit, Gmsh): which of them are the surface. Private to datasets/.
//
// The shape of a file is the union of its surface cells and segments, or of its points if it has neither. Volume cells
// are counted and left out. Such files repeat the curves and points of the geometry as cells of their own: a segment
// that is a side of a polygon, and a point that is a corner of a polygon or segment, add nothing to the union. Other
// points are left out with a note, because Gmsh writes the centres of arcs as such.
#pragma once

#include "datasets/formats/readers.h"

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench::readers {

// The corners of all tetrahedra, pyramids, prisms and hexahedra, one cell after the other. The key is the number of
// corners of a cell: 4, 5, 6 or 8. The order of corners is that of VTK, which Medit and Gmsh have too: the base, then
// the opposite face or the apex.
using VolumeCells = std::map<std::size_t, std::vector<std::size_t>>;

// Removes from soup.faces what is not a part of the shape. Adds notes that say how many volume cells are left out, and
// whether the surface cells are their whole outside and nothing else. Throws InputError if the file has volume cells and no surface cells; the message ends with `remedy`.
void keep_surface(const std::string& name, const VolumeCells& volumes, std::string_view remedy, Soup& soup);

}  // namespace hausbench::readers
