// The table of file formats. Help, messages, `hausbench list formats` and docs/formats.md follow from it.
#pragma once

#include "datasets/formats/readers.h"

#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

// A file format that is read.
struct Format {
    std::vector<std::string_view> endings;  // in lower case, without a dot; each is also a name of the format
    std::string_view title;                 // "Wavefront OBJ"
    readers::Read* read;
    std::string_view reads;    // the elements of the format that are read
    std::string_view refuses;  // the elements with a surface that are refused, or "nothing"
    std::string_view unit;     // where the unit of length is stated
    std::string_view axes;     // where the direction of the axes is stated
    std::string_view error;    // the distance of a coordinate from the number that the format defines
    bool columns = false;      // whether LoadOptions::columns may choose the columns of the coordinates
};

// A kind of file that is recognised, and refused with advice.
struct Unread {
    std::vector<std::string_view> endings;
    std::string_view begins;  // the first bytes of such a file; empty: it is recognised by its ending alone
    std::string_view title;   // "an IGES file"
    std::string_view advice;  // what to do
};

const std::vector<Format>& formats();
const std::vector<Unread>& unread_formats();

// Returns the row of the format with this ending, or null.
const Format* find_format(std::string_view ending);

// Returns the format that the first bytes of a file show, or null if they show none. For messages.
const Format* recognised_format(std::string_view bytes);

// Returns the endings of all formats: ".obj, .ply, ...".
std::string known_endings();

}  // namespace hausbench
