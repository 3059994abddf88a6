// Lines of decimal numbers, shared by .xyz, .pts, .csv and text PCD files; private to datasets/.
#pragma once

#include "datasets/formats/column_comments.h"
#include "datasets/formats/readers.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench::readers {

// Reads such lines. A line may also be a *count line*, a single integer that gives the number of points to come, and
// the first line may be a header with the names of the columns. point_lines.cpp has the rules.
class PointLines {
public:
    // For a whole file: by its ending, and with the columns that the user chose.
    explicit PointLines(const Input& input);
    // For the lines after the header of a PCD file, which gives the columns of x, y and z, whether each is stored as
    // float32, and the number of columns and of points.
    PointLines(std::string name, std::array<std::size_t, 3> columns, std::array<bool, 3> float32, std::size_t width,
               std::uint64_t announced);

    // Reads lines, the first of which has the number `first` in the file. Throws InputError with file, line and column.
    void add_lines(std::string_view bytes, std::uint32_t first);
    // Returns the points. Throws InputError if there are fewer than announced.
    Soup finish();

private:
    void add(std::string_view line, std::uint32_t number);
    bool take_count(std::string_view line, std::uint32_t number);  // if the line is a count line
    bool take_header(std::uint32_t number);                        // if the current line is a header
    bool take_units();                                             // if it has the units below a header
    // Throws InputError if the first line, which counts as a point, seems to be a header of numbers. The current line
    // is the second.
    void check_first() const;
    // Decides on the columns of x, y and z. The current line is the first point.
    void choose_columns();
    std::optional<std::array<std::size_t, 3>> columns_if_named() const;  // by the header, if that is clear
    void choose_unnamed_columns();
    void take_length_unit();                                                            // from a comment
    [[noreturn]] void refuse_prose(std::uint32_t number, std::string_view text) const;  // a line without a point
    void check_width(std::uint32_t number);
    void add_point(std::uint32_t number);
    double coordinate(std::size_t k, std::uint32_t number) const;
    [[noreturn]] void refuse_unnamed(std::uint32_t number) const;  // more columns than x, y and z
    std::string announcer() const;  // "line 3" or "the header", which announced the number of points; for messages

    std::string name_, format_, choice_;  // of the file; its ending; LoadOptions::columns
    bool molecule_ = false;               // a molecule's .xyz file, whose second line is a comment
    std::array<std::size_t, 3> columns_{0, 1, 2};
    std::array<bool, 3> float32_{};
    bool chosen_ = false;  // columns_ is final
    Header header_;
    std::string_view header_text_;
    ColumnComments comments_;
    Header first_;  // the first point, if it may be a header of numbers
    // The largest number of fields in a line. Fewer fields, separated by blanks, are an error too if `exact_`.
    std::size_t width_ = std::numeric_limits<std::size_t>::max();
    bool exact_ = false;
    std::uint64_t announced_ = 0;           // number of points, by the header or by all count lines so far
    std::uint32_t count_line_ = 0;          // the last count line; 0: none
    bool counted_ = false;                  // a number of points was announced
    std::string_view line_;                 // the current line
    std::vector<std::string_view> fields_;  // of the current line
    bool blanks_ = false;                   // separate its fields
    Soup soup_;
};

}  // namespace hausbench::readers
