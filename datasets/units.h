// Units of length and directions of axes: names, and conversion of shapes.
#pragma once

#include "datasets/load.h"

#include <optional>
#include <string>
#include <string_view>

namespace hausbench {

struct Unit {
    std::string_view name;  // "mm"
    double micrometres;     // its length, exact
};

// Returns the unit with this name or one of its other names, in upper or lower case: "mm", "millimeter", "millimetres",
// "inch", ... Returns nothing if there is none.
std::optional<Unit> unit_named(std::string_view name);

// Returns the unit of this length in metres. Snaps to a known unit if `metres` is the double nearest to its length.
Stated stated_unit(double metres);
Stated stated_unit(const Unit& unit);

// Returns the unit that a file states by this name. If the name is not known, the length is 0, which means that no
// other file can be compared with this one, except one with the same name.
Stated unit_stated_as(std::string_view name);

// Returns whether both state a unit, and the units differ or one of them is not known.
bool units_differ(const Stated& a, const Stated& b);

// Returns the names of all units, for messages: "mm, cm, ...".
std::string unit_names();

// Multiplies all coordinates by (unit of the shape / `unit`), rounding each product once. A shape that states no unit
// counts as being in `unit` already; then a note says so. Afterwards the shape states `unit`. Throws InputError, which
// begins with `name`, if the shape states a unit that is not known, and if a coordinate overflows.
void convert_to_unit(LoadedShape& loaded, const Unit& unit, const std::string& name);

// Turns the shape so that axis `up` ('X', 'Y' or 'Z') points up, by the axes of Collada: Y_UP has x to the right and z
// towards the viewer, Z_UP x to the right and y away from the viewer, X_UP -y to the right and z towards the viewer.
// This only exchanges coordinates and changes signs. A shape that states no axes counts as having `up` already; then a
// note says so.
void convert_to_up(LoadedShape& loaded, char up);

}  // namespace hausbench
