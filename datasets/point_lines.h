// Lines of decimal numbers, shared by .xyz, .pts, .csv and text PCD files; private to datasets/.
#pragma once

#include "datasets/readers.h"

#include <limits>
#include <string_view>

namespace hausbench::readers {

class PointLines {
public:
    // .csv files have no count lines and may have any header.
    PointLines(std::string name, bool csv) : name_(std::move(name)), any_header_(csv), counts_(!csv) {}
    // For lines after a header that announces a number of points.
    PointLines(std::string name, std::array<std::size_t, 3> columns, std::uint64_t announced);

    // `first` is the number of the first line. Throws InputError with file, line and column.
    void add_lines(std::string_view bytes, std::uint32_t first);
    Soup finish();

private:
    void add(std::string_view line, std::uint32_t number);
    bool take_header(std::uint32_t number);  // true if the line names x, y and z
    void add_point(std::uint32_t number);
    std::string announcer() const;

    std::string name_;
    std::array<std::size_t, 3> columns_{0, 1, 2};
    std::uint64_t announced_ = 0;  // number of points, by all count lines so far
    std::uint32_t count_line_ = 0;
    // Number of columns in the header of a .csv file.
    std::size_t named_ = std::numeric_limits<std::size_t>::max();
    bool counted_ = false, any_header_ = false, counts_ = false;
    bool begun_ = false;  // a header, a count or a point was read
    std::vector<std::string_view> fields_;
    Soup soup_;
};

}  // namespace hausbench::readers
