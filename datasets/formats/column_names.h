// The columns of x, y and z in a table of points, by the names in its header; private to datasets/.
#pragma once

#include "datasets/load.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench::readers {

// The fields of a line that names columns.
struct Header {
    std::vector<std::string_view> fields;
    std::uint32_t line = 0;                    // in the file, from 1; 0: the file has no header
    std::vector<std::string_view> units = {};  // of the columns, in a line below the header; empty: no such line
    // Words between blanks, or a comment: a unit after the last of x, y and z counts for all, as in "x y z [mm]".
    bool loose = false;
};

// The columns of x, y and z, counted from 0, and what their names say.
struct ColumnChoice {
    std::array<std::size_t, 3> columns{0, 1, 2};
    Stated stated = {};
    std::vector<std::string> notes = {};
};

// Returns whether a line may be a header: it has a name, and no field is a number or begins like one.
bool may_be_header(const std::vector<std::string_view>& fields);

// Returns whether a field says that a value is missing: "NA", "#N/A", "-1.#IND", nothing, ...
bool is_missing(std::string_view field);

// Returns the largest number of coordinates (0 to 3) that the names of one family give, such as 3 for "x", "y" and "z".
// Latitude and longitude count as coordinates.
int coordinates_named(const std::vector<std::string_view>& fields);

// Returns whether two names or more are angles, such as latitude and longitude.
bool names_angles(const std::vector<std::string_view>& fields);

// Returns whether the first columns that are named x, y and z, in any family, are in another order than x, y, z.
bool names_another_order(const std::vector<std::string_view>& fields);

// Returns the number of fields that are units, as in "mm,mm,mm" or "[-] [px] [px] [px]"; 0 if a field is a number.
std::size_t count_units(const std::vector<std::string_view>& fields);

// Returns a unit without brackets around it; empty for "-".
std::string_view bare_unit(std::string_view field);

// Says that a unit is stated and not known.
std::string unknown_unit(std::string_view unit);

// Returns the columns of x, y and z by their names. Throws InputError if no family of names is complete, if several
// are, and if the units of the columns differ. `name` is the file's.
ColumnChoice columns_by_name(const std::string& name, const Header& header);

// Returns the columns that the user chose, such as "2,3,4" or "E,N,H". Throws InputError for an unknown or ambiguous
// name. `width` is the number of columns of the file.
ColumnChoice columns_by_choice(const std::string& name, const std::string& choice, const Header& header,
                               std::size_t width);

}  // namespace hausbench::readers
