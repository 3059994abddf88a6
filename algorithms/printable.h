// Makes foreign text safe to print: names, reasons and messages from files must not steer a terminal or forge a line.
#pragma once

#include <string>
#include <string_view>

namespace hausbench {

// Returns the text as one line of valid UTF-8. Control characters (including U+0080 to U+009F) and line separators become
// spaces; direction marks, zero-width characters and invalid bytes become question marks.
std::string printable(std::string_view text);

// The same, but keeps line breaks, and with `colours` those that this program writes. Everything printed goes through it; a foreign
// text inside has been through printable(), so that a line break in it starts no line.
std::string printable_lines(std::string_view text, bool colours);

}  // namespace hausbench
