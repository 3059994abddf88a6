// Splits lines of a table into fields; private to datasets/. point_lines.cpp has the rules.
#pragma once

#include <string_view>
#include <vector>

namespace hausbench::readers {

// Splits a line at its separators into fields, without the quotes around them. Returns false if a quoted field does not
// end. `by_blanks` tells whether white space was the separator.
bool split_fields(std::string_view line, std::vector<std::string_view>& fields, bool& by_blanks);

// Returns the line without a comment at its end.
std::string_view without_comment(std::string_view line);

// Returns whether a field is two numbers or more, as between the commas of "1,5 2,5 3,5".
bool several_numbers(std::string_view field);

}  // namespace hausbench::readers
