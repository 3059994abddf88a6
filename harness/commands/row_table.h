// Prints the rows of a result, one line each.
#pragma once

#include "harness/commands/text_table.h"
#include "harness/result/result_file.h"

#include <cstddef>
#include <string>
#include <vector>

namespace hausbench {

enum class Form { text, csv, json, markdown };
std::string show_rows(const ResultFile& result, const std::vector<std::size_t>& rows, Form form, const Paper& paper);

}  // namespace hausbench
