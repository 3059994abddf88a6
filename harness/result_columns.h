// The columns of /models: what writing and reading a result file share.
#pragma once

#include "result_file.h"

#include <utility>

namespace hausbench {

inline constexpr std::pair<const char*, std::string ModelRecord::*> model_texts[] = {
    {"name", &ModelRecord::name},           {"sha256", &ModelRecord::sha256},        {"kind", &ModelRecord::kind},
    {"precision", &ModelRecord::precision}, {"source", &ModelRecord::source},        {"licence", &ModelRecord::licence},
    {"note", &ModelRecord::note},           {"polynomial", &ModelRecord::polynomial}};
inline constexpr std::pair<const char*, std::int64_t ModelRecord::*> model_integers[] = {
    {"elements", &ModelRecord::elements},
    {"vertices", &ModelRecord::vertices},
    {"unreferenced", &ModelRecord::unreferenced}};

}  // namespace hausbench
