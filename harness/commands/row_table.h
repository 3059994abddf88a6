// Prints the rows of a result, one line each.
#pragma once

#include "harness/commands/text_table.h"
#include "harness/result/result_file.h"

#include <cstddef>
#include <string>
#include <vector>

namespace hausbench {

enum class TableForm { text, csv, json, markdown };

// What show_rows() shows, in any form.
const ResultPart& shown_part();
std::string show_rows(const ResultFile& result, const std::vector<std::size_t>& rows, TableForm form,
                      const Paper& paper);

}  // namespace hausbench
