// Comments above a table of points, which may name its columns; private to datasets/.
//
// A comment counts as a list of names if it has exactly as many words as the table has columns, each a short name, and
// - it names x, y and z, as in "# id X Y Z"; or
// - it numbers its words, as in "# 1:y 2:x 3:z", or separates them by commas, semicolons, tabs or bars; or
// - it begins with a word such as "columns:"; or
// - its words have up to three letters each or differ in one or two letters, or two of them have a digit or '_', or are
//   usual names of columns.
// A list that does not name x, y and z in full is refused, and so are lists that contradict. Any other comment is
// prose, and ignored, except if it begins with x, y and z in another order, or is about latitude and longitude.
#pragma once

#include "datasets/formats/column_names.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench::readers {

enum class Lead { none, names, other };  // the words before a colon: "columns:" or any other

class ColumnComments {
public:
    // Takes a comment, with its mark.
    void add(std::string_view text, std::uint32_t line);

    // Whether a comment may name coordinates, whatever the number of columns.
    bool name_coordinates() const;
    // The unit of a comment such as "Length unit: m" or "units = mm"; empty: none.
    std::string_view length_unit() const { return length_unit_; }

    // Returns the names of the columns of a table of this width, or a header without a line if no comment lists them.
    // Throws InputError, which begins with `name`, for comments that contradict or name x, y and z in an unclear way.
    Header names(const std::string& name, std::size_t width) const;
    // Returns the last comment of as many words, in which the user may have found the names of columns.
    Header words(std::size_t width) const;

private:
    struct Comment {
        std::vector<std::string_view> fields, words;  // as a table would be split; whatever separates them
        std::vector<std::size_t> numbers;             // of the fields, as written before them; empty: not all have one
        std::uint32_t line = 0;
        Lead lead = Lead::none;
        bool separated = false;  // by more than blanks
        bool single = false;     // one numbered name and perhaps an explanation, as in "2: y  the second coordinate"
    };

    void take_length_unit(std::string_view text);
    bool is_list(const Comment& comment, std::size_t width) const;
    Header header_of(const std::string& name, const Comment& comment, std::size_t width) const;
    Comment joined_singles(std::size_t width) const;
    void refuse_unclear(const std::string& name, const Comment& comment, std::size_t width) const;

    std::deque<Comment> comments_;
    std::string_view length_unit_;
};

}  // namespace hausbench::readers
