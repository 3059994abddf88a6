// Makes text from outside this program safe to print. A name or message that was read from a file could contain control
// characters that change the terminal, or a line break that makes a part of it look like output of this program.
#pragma once

#include <string>
#include <string_view>

namespace hausbench {

// Returns the text as one line of valid UTF-8. Control characters (including U+0080 to U+009F) and line separators
// become spaces; direction marks, zero-width characters and invalid bytes become question marks.
std::string printable(std::string_view text);

// Like printable(), but keeps line breaks and, if `colours` is set, the colour codes that this program writes. All
// standard output of the program passes through this function. Pass text from outside through printable() before
// inserting it into the output, because this function cannot tell whose line breaks they are.
std::string printable_lines(std::string_view text, bool colours);

}  // namespace hausbench
