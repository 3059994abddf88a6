// Text tables that fit the terminal; in files they are as wide as needed.
#pragma once

#include "algorithms/printable.h"

#include <cstddef>
#include <string>
#include <vector>

namespace hausbench {

// The settings for writing to standard output.
struct Paper {
    std::size_t width = 0;  // in characters; 0: without limit
    bool colour = false;
};

// Returns the settings for standard output: the width is COLUMNS or the width of the terminal. Colour is used only on a
// terminal, unless NO_COLOR is set.
Paper paper_of_output();

enum class Colour { none, red, yellow, grey };
std::string coloured(const std::string& text, Colour colour, const Paper& paper);

// Returns the text wrapped at `width` characters (0: one line), with each line indented by `indent` blanks.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t width);

// A table that fits the width of the paper. If it is too wide, it first omits columns, the highest `rank` first and
// never rank 0, then shortens texts in columns that allow it. If that is not enough, it prints each row as running
// text.
class TextTable {
public:
    struct Column {
        std::string title;
        bool right = false;    // right-aligned, for numbers
        int rank = 0;          // columns of the highest rank are left out first
        bool shorten = false;  // may be shortened with an ellipsis, to eight characters at least
    };
    struct Row {
        std::vector<std::string> cells;
        std::string below = {};  // text under the row, such as a reason
        Colour colour = Colour::none;
    };

    explicit TextTable(std::vector<Column> columns) : columns_(std::move(columns)) {}
    void add(Row row) {
        for (std::string& cell : row.cells) cell = printable(cell);
        rows_.push_back(std::move(row));
    }
    // Returns the table as text. If `left_out` is given, it receives the titles of the omitted columns.
    std::string text(const Paper& paper, std::vector<std::string>* left_out = nullptr) const;

private:
    struct Layout {
        std::vector<std::size_t> columns, widths;  // index and width of each column that stays
        bool fits = true;
    };
    Layout layout(const Paper& paper) const;
    std::string as_running_text(const Paper& paper) const;

    std::vector<Column> columns_;
    std::vector<Row> rows_;
};

}  // namespace hausbench
