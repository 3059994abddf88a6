// Lines of decimal numbers, shared by .xyz, .pts, .csv and text PCD files; private to datasets/.
#pragma once

#include "datasets/formats/readers.h"

#include <limits>
#include <string_view>

namespace hausbench::readers {

// Reads such lines. A line may also be a *count line*, a single integer that gives the number of points to come, and
// the first line may be a header with the names of the columns. point_file.cpp has the rules.
class PointLines {
public:
    // For a whole file. A .csv file has no count lines, and its header may have any names.
    PointLines(std::string name, bool csv) : name_(std::move(name)), any_header_(csv), counts_(!csv) {}
    // For the lines after the header of a PCD file, which gives the columns of x, y and z and the number of points.
    PointLines(std::string name, std::array<std::size_t, 3> columns, std::uint64_t announced);

    // Reads lines, the first of which has the number `first` in the file. Throws InputError with file, line and column.
    void add_lines(std::string_view bytes, std::uint32_t first);
    // Returns the points. Throws InputError if there are fewer than announced.
    Soup finish();

private:
    void add(std::string_view line, std::uint32_t number);
    // If the current line names the columns x, y and z, stores their indices and returns true.
    bool take_header(std::uint32_t number);
    void add_point(std::uint32_t number);
    std::string announcer() const;  // "line 3" or "the header", which announced the number of points; for messages

    std::string name_;
    std::array<std::size_t, 3> columns_{0, 1, 2};
    std::uint64_t announced_ = 0;   // number of points, by the header or by all count lines so far
    std::uint32_t count_line_ = 0;  // the last count line; 0: none
    // Number of columns in the header of a .csv file; no line may have more.
    std::size_t named_ = std::numeric_limits<std::size_t>::max();
    // Whether a number of points was announced, the header may have any names, and count lines may occur.
    bool counted_ = false, any_header_ = false, counts_ = false;
    bool begun_ = false;                    // a header, a count line or a point was read
    std::vector<std::string_view> fields_;  // of the current line
    Soup soup_;
};

}  // namespace hausbench::readers
