// Makes foreign text safe to print: names, reasons and messages from files must not steer a terminal or forge a line.
#pragma once

#include <string>
#include <string_view>

namespace hausbench {

// Returns the text as one line of valid UTF-8. Control characters (including U+0080 to U+009F) and line separators become
// spaces; direction marks, zero-width characters and invalid bytes become question marks.
std::string printable(std::string_view text);

// The same, but keeps line breaks and, with `colours`, the colour codes that this program writes. Everything
// printed goes through it. Foreign text inside must have been through printable() before, so that a line break in
// it cannot start a line.
std::string printable_lines(std::string_view text, bool colours);

}  // namespace hausbench
