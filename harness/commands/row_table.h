// Prints the rows of a result, one line each.
#pragma once

#include "harness/commands/text_table.h"
#include "harness/result/result_file.h"

#include <cstddef>
#include <string>
#include <vector>

namespace hausbench {

enum class TableForm { text, csv, json, markdown };

// Returns the part of a result that show_rows() uses.
const ResultPart& shown_part();
std::string show_rows(const ResultFile& result, const std::vector<std::size_t>& rows, TableForm form,
                      const Paper& paper);

}  // namespace hausbench
