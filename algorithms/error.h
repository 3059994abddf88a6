// Errors that a user can fix. The message is one line: the file or key, the line or value that is wrong, and how to
// correct it.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

// An error that ends the program with exit code 2 and its message on standard error.
class InputError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// Returns a hint to append to an error about an unknown name: " (did you mean 'x'?)" if a candidate differs from
// `wrong` in few letters, else " (known: a, b, c)" with the first 20 of them, or "" if `candidates` is empty.
std::string nearest_hint(std::string_view wrong, const std::vector<std::string>& candidates);

// Returns text from outside this program as one line that is safe to print (see printable()), cut to 1000 bytes.
std::string one_line(std::string text);

}  // namespace hausbench
