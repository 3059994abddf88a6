// Makes foreign text safe to print: names, reasons and messages from files must not steer a terminal or forge a line.
#pragma once

#include <string>
#include <string_view>

namespace hausbench {

// Returns the text as one line of valid UTF-8. Control characters (also U+0080 to U+009F) and separators of lines become spaces;
// marks of direction, characters that take no room, and bytes that are not UTF-8 become question marks.
std::string printable(std::string_view text);

// The same, but keeps line breaks, and with `colours` those that this program writes. Everything printed goes through it; a foreign
// text inside has been through printable(), so that a line break in it starts no line.
std::string printable_lines(std::string_view text, bool colours);

}  // namespace hausbench
