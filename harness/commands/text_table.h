// Text tables that fit the terminal; elsewhere they are as wide as needed.
#pragma once

#include "algorithms/printable.h"

#include <cstddef>
#include <string>
#include <vector>

namespace hausbench {

// How to write on standard output.
struct Paper {
    std::size_t width = 0;  // in characters; 0: without limit
    bool colour = false;
};

// Of standard output: the width of the terminal (or COLUMNS, if set), and colour only on a terminal without NO_COLOR.
Paper paper_of_output();

enum class Colour { none, red, yellow, grey };
std::string coloured(const std::string& text, Colour colour, const Paper& paper);

// Words on lines of at most `width` characters (0: one line), each after `indent` blanks.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t width);

// A narrow paper leaves out columns, those of the highest `rank` first, and none of rank 0; it then shortens texts that may
// be; and where that is not enough, each row becomes running text.
class TextTable {
public:
    struct Column {
        std::string title;
        bool right = false;    // numbers
        int rank = 0;          // which to leave out first
        bool shorten = false;  // to eight characters at least, with an ellipsis
    };
    struct Row {
        std::vector<std::string> cells;
        std::string below = {};  // words under the row, such as a reason
        Colour colour = Colour::none;
    };

    explicit TextTable(std::vector<Column> columns) : columns_(std::move(columns)) {}
    void add(Row row) {
        for (std::string& cell : row.cells) cell = printable(cell);
        rows_.push_back(std::move(row));
    }
    // `left_out`, if given, gets the titles of the columns that have no room.
    std::string text(const Paper& paper, std::vector<std::string>* left_out = nullptr) const;

private:
    struct Layout {
        std::vector<std::size_t> columns, widths;  // of those that stay
        bool fits = true;
    };
    Layout layout(const Paper& paper) const;
    std::string as_running_text(const Paper& paper) const;

    std::vector<Column> columns_;
    std::vector<Row> rows_;
};

}  // namespace hausbench
